"""The zoom of Koch's Figure 5.2: from the whole scene to single atoms, level after level."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip
from scuro.scene.geometry import Body, Frames, Geometry, rotation_matrices, turned
from scuro.scene.scene import Scene

ATOMS_HIGH = 15.0
"""At the end the picture is so many atoms high."""
_SMALLEST = 1.0
"""Ångström: radius about the corners of triangles, which have none, in the search for a surface."""


@dataclass(frozen=True)
class Zoom:
    """A camera that comes closer by equal factors in equal times, straight to a point."""

    start: Camera
    landing: tuple[float, float, float]
    nearest: float
    """Distance from the landing point at the end."""

    def camera(self, share: float) -> Camera:
        """The camera after a share, 0 to 1, of the way.

        What it looks at moves from the start's target to the landing point as the distance shrinks,
        so that every point of the first picture goes straight to its place in the last one.
        """
        far = self.start.distance
        near = min(self.nearest, far)
        distance = far * (near / far) ** share
        rest = (distance - near) / (far - near) if far > near else 0.0
        target = np.asarray(self.landing) + rest * np.subtract(self.start.target, self.landing)
        back = np.subtract(self.start.position, self.start.target) / far
        height = self.start.height
        return replace(
            self.start,
            position=tuple((target + distance * back).tolist()),
            target=tuple(target.tolist()),
            height=None if height is None else height * distance / far,
        )


def zoom_of(scene: Scene, camera: Camera, point: tuple[float, float, float] | None) -> Zoom:
    """The zoom from a camera to a point, by default to the surface in the picture's middle."""
    radii = [b.geometry.spheres[:, 3] for b in scene.bodies() if len(b.geometry.spheres)]
    extent = float(np.ptp(scene.bounds(), axis=0).max())
    atom = float(np.median(np.concatenate(radii))) if radii else extent / 500
    half = camera.half_height() if camera.height is None else camera.height / 2 / camera.distance
    found = landing_point(scene, camera) if point is None else np.asarray(point)
    return Zoom(camera, tuple(found.tolist()), atom * ATOMS_HIGH / half)


def zoom_settings(scene: Scene, settings: Settings) -> Settings:
    """Settings of a zoom: semantic, and levels chosen by the distance from what is approached.

    The thesis measures the distance to the scene's centre, which a camera that lands on the outside
    never comes near.
    """
    changes = {"semantic__distance_to": "target"}
    if settings.semantic.mode == "off" and scene.bodies():
        changes["semantic__mode"] = "screen"
    return settings.replace(**changes)


def landing_point(scene: Scene, camera: Camera) -> NDArray[np.float64]:
    """(3,) where the line through the picture's middle first meets a surface.

    Where it meets none: the nearest side of the instance that it passes closest.
    """
    eye = np.asarray(camera.position, np.float64)
    way = np.subtract(camera.target, eye) / camera.distance
    enters = _kept_from(scene.clip, eye, way)
    spheres: list[tuple[float, float, Body, int]] = []
    closest, beside = np.inf, np.asarray(camera.target, np.float64)
    for body in scene.bodies():
        if not len(body.geometry) or not body.instances:
            continue
        body = _nearest_copy(body, eye, way)
        middle = body.geometry.bounds.astype(np.float64).mean(axis=0)
        centers = turned(body.rotations, middle) + body.positions - eye
        along = centers @ way
        off = np.linalg.norm(centers - along[:, None] * way, axis=1)
        first = int(off.argmin())
        if off[first] < closest:
            closest, beside = off[first], eye + centers[first] - body.radius * way
        near = np.flatnonzero((off < body.radius) & (along + body.radius > enters))
        spheres += [(float(along[i]) - body.radius, off[i], body, int(i)) for i in near]
    best = np.inf
    for start, _, body, index in sorted(spheres, key=lambda s: s[0]):
        if start > best:
            break
        turn = rotation_matrices(body.rotations[index : index + 1])[0]
        origin = turn.T @ (eye - body.positions[index])
        best = min(best, _first_hit(body.geometry, origin, turn.T @ way, enters))
    return eye + best * way if np.isfinite(best) else beside


def _nearest_copy(body: Body, eye: NDArray, way: NDArray) -> Body:
    """A body of an assembly, standing where the copy nearest to the ray stands."""
    frames = body.frames
    if frames is None:
        return body
    centers = turned(frames.rotations, body.own_bounds.mean(axis=0)) + frames.positions - eye
    off = np.linalg.norm(centers - (centers @ way)[:, None] * way, axis=1)
    one = slice(int(off.argmin()), int(off.argmin()) + 1)
    placed = Frames(frames.rotations[one], frames.positions[one]).placing(
        Frames(body.rotations, body.positions)
    )
    return replace(body, rotations=placed.rotations, positions=placed.positions, frames=None)


def _kept_from(clip: Clip, eye: NDArray, way: NDArray) -> float:
    """How far along a ray the kept side of all planes begins."""
    enters = 0.0
    for x, y, z, offset in clip.equations():
        slope = float(way @ (x, y, z))
        if slope > 1e-9:
            enters = max(enters, -(float(eye @ (x, y, z)) + offset) / slope)
    return enters


def _first_hit(geometry: Geometry, origin: NDArray, way: NDArray, enters: float) -> float:
    """Distance of the first ball on a ray, infinite for none; from inside a ball, ``enters``."""
    corners = geometry.triangles.reshape(-1, 3)
    balls = np.concatenate(
        [
            geometry.spheres,
            geometry.rods.reshape(-1, 4),
            np.concatenate([corners, np.full((len(corners), 1), _SMALLEST)], axis=1),
        ]
    ).astype(np.float64)
    offset = balls[:, :3] - origin
    along = offset @ way
    rest = balls[:, 3] ** 2 - ((offset - along[:, None] * way) ** 2).sum(axis=1)
    half = np.sqrt(np.maximum(rest, 0))
    hit = (rest > 0) & (along + half > enters)
    return float(np.maximum(along - half, enters)[hit].min()) if hit.any() else np.inf
