"""How hands move a camera: pure functions from a camera to the next one.

Pixels are counted from the picture's upper left corner; ``size`` is its width and height.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.scene.camera import Camera
from scuro.scene.projection import Size, unproject
from scuro.scene.projection import project as project

TURN = 180.0
"""Degrees of a drag across the picture's smaller side."""
RIM = 0.9
"""Drags that begin outside this share of the half-size roll the picture instead."""
AXES = {
    "x": ((1, 0, 0), (0, 0, 1)),
    "y": ((0, 1, 0), (0, 0, 1)),
    "z": ((0, 0, 1), (0, 1, 0)),
}
"""Direction to the eye and upward direction of the views along the axes."""


def orbit(camera: Camera, move: Size, size: Size) -> Camera:
    """Turn the scene under the pointer by a drag of ``move`` pixels."""
    scale = TURN / min(size)
    return camera.orbited(-move[0] * scale, move[1] * scale)


def roll(camera: Camera, start: Size, end: Size, size: Size) -> Camera:
    """Turn the picture about its middle with the pointer."""
    angles = [math.atan2(size[1] / 2 - y, x - size[0] / 2) for x, y in (start, end)]
    angle = angles[1] - angles[0]
    right, up, _ = camera.view_from_world()[:3, :3]
    turned = math.cos(angle) * up + math.sin(angle) * right
    return replace(camera, up=_tuple(turned))


def on_rim(point: Size, size: Size) -> bool:
    """Whether a drag that begins here rolls."""
    x, y = (abs(2 * p / s - 1) for p, s in zip(point, size, strict=True))
    return max(x, y) > RIM


def pixel_size(camera: Camera, size: Size, distance: float | None = None) -> float:
    """World units a pixel covers at a distance from the eye (the target's by default)."""
    height = 2 * camera.half_height()
    if not camera.orthographic:
        height *= camera.distance if distance is None else distance
    return height / size[1]


def pan(camera: Camera, move: Size, size: Size, distance: float | None = None) -> Camera:
    """Shift the scene with the pointer: what lies at ``distance`` stays under it."""
    step = pixel_size(camera, size, distance)
    right, up, _ = camera.view_from_world()[:3, :3]
    return shifted(camera, -move[0] * step * right + move[1] * step * up)


def shifted(camera: Camera, by: ArrayLike) -> Camera:
    """The camera and its target, moved."""
    return replace(
        camera,
        position=_tuple(np.add(camera.position, by)),
        target=_tuple(np.add(camera.target, by)),
    )


def zoom(camera: Camera, factor: float, point: ArrayLike) -> Camera:
    """Come nearer to a world point by ``factor`` (above 1 enlarges); it keeps its pixel."""
    anchor = np.asarray(point, np.float64)
    eye, target = np.asarray(camera.position), np.asarray(camera.target)
    if camera.height is not None:
        back = camera.view_from_world()[2, :3]
        shift = (anchor - target) * (1 - 1 / factor)
        shift -= back * (shift @ back)
        return replace(shifted(camera, shift), height=camera.height / factor)
    return replace(
        camera,
        position=_tuple(anchor + (eye - anchor) / factor),
        target=_tuple(anchor + (target - anchor) / factor),
    )


def centered(camera: Camera, point: ArrayLike) -> Camera:
    """Look at a point, from the same side and distance."""
    return shifted(camera, np.subtract(point, camera.target))


def along_axis(camera: Camera, axis: str, opposite: bool = False) -> Camera:
    """Look along a coordinate axis at the same target."""
    direction, up = (np.array(v, float) for v in AXES[axis])
    eye = np.asarray(camera.target) + (-direction if opposite else direction) * camera.distance
    return replace(camera, position=_tuple(eye), up=_tuple(up))


def fit(camera: Camera, bounds: NDArray, aspect: float, points: NDArray | None = None) -> Camera:
    """See all of a box (or of spheres, (n, 4)) from the same side."""
    direction = np.subtract(camera.position, camera.target)
    return Camera.fitted(
        bounds,
        direction=_tuple(direction / np.linalg.norm(direction)),
        up=_tuple(camera.view_from_world()[1, :3]),
        fov=camera.fov,
        aspect=aspect,
        orthographic=camera.orthographic,
        points=points,
    )


def narrowed(camera: Camera, before: float, after: float, points: NDArray) -> Camera:
    """The camera to which pictures of another width over height show as much of a scene.

    Where its width was not what filled the picture, there is some to spare.

    Args:
        camera: Of the pictures before.
        before: Their width over height.
        after: That of the new ones.
        points: Of the scene, (n, 3 or more).
    """
    # without perspective: from any distance the same, so that the way back ends where it began
    across = points[:, :3] @ camera.view_from_world()[:2, :3].T
    wide, high = np.ptp(across, axis=0) if len(across) else (1.0, 1.0)
    own = wide / high if min(wide, high) > 0 else 1.0
    return zoom(camera, min(after, own) / min(before, own), camera.target)


def viewpoint(camera: Camera) -> NDArray[np.float64]:
    """(3,) a place on the line of sight to the target that is before everything seen."""
    eye = np.asarray(camera.position, np.float64)
    if not camera.orthographic:
        return eye
    return eye + 1e6 * camera.view_from_world()[2, :3]


def raised(camera: Camera, share: float) -> Camera:
    """The camera from which a share of the picture's height is free below what filled it."""
    if not share > 0:
        return camera
    wider = 1 / (1 - share)
    away = np.subtract(camera.position, camera.target) * wider
    if camera.height is not None:
        camera = replace(camera, height=camera.height * wider)
    else:
        camera = replace(camera, position=_tuple(np.add(camera.target, away)))
    up = camera.view_from_world()[1, :3]
    return shifted(camera, -up * share / 2 * pixel_size(camera, (1, 1)))


def pixel_ray(
    camera: Camera, pixel: Size, size: Size
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(3,) origin and (3,) unit direction of a pixel's ray in world space."""
    near, far = unproject(camera, pixel, size, 1.0), unproject(camera, pixel, size, 2.0)
    direction = (far - near) / np.linalg.norm(far - near)
    if not camera.orthographic:
        return np.asarray(camera.position, np.float64), direction
    # parallel rays begin behind everything that the eye could have in front of it
    return near - direction * 1e6, direction


def _tuple(vector: ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(vector, np.float64).tolist()
    return x, y, z
