"""From what side and how near a scene is seen: settings that become a :class:`Camera`."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.camera import Camera
from scuro.scene.geometry import rotation_matrices
from scuro.scene.points import focus_points, scene_points
from scuro.settings import SettingsGroup, setting

if TYPE_CHECKING:
    from scuro.scene.scene import Scene

_SIDES = {
    "front": ((0, 0, 1), (0, 1, 0)),
    "back": ((0, 0, -1), (0, 1, 0)),
    "right": ((1, 0, 0), (0, 1, 0)),
    "left": ((-1, 0, 0), (0, 1, 0)),
    "top": ((0, 1, 0), (0, 0, -1)),
    "bottom": ((0, -1, 0), (0, 0, 1)),
}
"""Direction to the eye and upward direction. ``front`` looks along -z with y up."""
_PATIENT_SIDES = {
    "front": ((0, 1, 0), (0, 0, 1)),
    "back": ((0, -1, 0), (0, 0, 1)),
    "right": ((1, 0, 0), (0, 0, 1)),
    "left": ((-1, 0, 0), (0, 0, 1)),
    "top": ((0, 0, 1), (0, 1, 0)),
    "bottom": ((0, 0, -1), (0, 1, 0)),
}
"""The same for patients, whose y points to the front and whose z points up."""
_RESERVOIR_SIDES = _PATIENT_SIDES | {
    "front": ((0.31, -0.79, 0.53), (0, 0, 1)),
    "back": ((-0.31, 0.79, 0.53), (0, 0, 1)),
}
"""Reservoirs are flat: seen from the south or the north, but from above."""
_PRINCIPAL = "principal"


def _check_up(up: tuple[float, float, float]) -> None:
    if not any(up):
        raise SettingsError("up needs a direction that is not zero")


class ViewSettings(SettingsGroup):
    """Where the camera stands. Without a position it is fitted to the scene, or to the focus."""

    view: str = setting(
        "front",
        "side to look from; 'principal' lays the longest axis across the picture",
        choices=(*_SIDES, _PRINCIPAL),
    )
    azimuth: float = setting(0.0, "walk around the scene, to the right", unit="deg")
    elevation: float = setting(0.0, "rise above the scene", low=-90, high=90, unit="deg")
    roll: float = setting(0.0, "turn the picture clockwise", unit="deg")
    zoom: float = setting(1.0, "enlarge the picture's middle", low=0.01, high=10_000)
    fov: float = setting(30.0, "vertical field of view", low=0.1, high=160, unit="deg")
    orthographic: bool = setting(False, "parallel projection")
    focus: str = setting("", "selection that fills the picture, in PyMOL's words")
    position: tuple[float, float, float] | None = setting(
        None, "the eye's place in the file's coordinates, instead of a fitted one"
    )
    target: tuple[float, float, float] | None = setting(
        None, "the point looked at (default: the middle of what is seen)"
    )
    up: tuple[float, float, float] | None = setting(
        None, "upward direction of the picture", check=_check_up
    )

    @classmethod
    def of(cls, camera: Camera) -> ViewSettings:
        """A camera as settings, for scene files and pictures."""
        fov = camera.fov
        if camera.height is not None:
            # an orthographic view is stored by its height at the target: the angle gives it back
            fov = math.degrees(2 * math.atan(camera.height / 2 / camera.distance))
        return cls(
            position=camera.position,
            target=camera.target,
            up=camera.up,
            fov=min(160.0, max(0.1, fov)),
            orthographic=camera.orthographic,
        )


def view_camera(
    scene: Scene,
    view: ViewSettings,
    aspect: float,
    *,
    turning: bool = False,
    points: NDArray | None = None,
) -> Camera:
    """The camera that a view of a scene means.

    Args:
        scene: What is seen.
        view: From where.
        aspect: The picture's width over its height.
        turning: Whether the camera will go around, so that it must see all from every side.
        points: (n, 4) centres and radii to fit instead of those that are in focus now.

    Raises:
        SettingsError: The focus selects nothing.
    """
    if points is None:
        outermost = view.view != _PRINCIPAL  # whose axes are those of all
        points = (
            focus_points(scene, view.focus)
            if view.focus
            else scene_points(scene, outermost=outermost)
        )
    bounds = _bounds(points) if len(points) else scene.bounds()
    if view.position is not None:
        camera = _placed(view, bounds)
    else:
        direction, up = _direction(view, points, _sides(scene))
        if turning and len(points):
            points = _revolved(points, bounds.mean(axis=0), direction, up)
        camera = Camera.fitted(
            bounds,
            direction=direction,
            up=up,
            fov=view.fov,
            aspect=aspect,
            orthographic=view.orthographic,
            points=points if len(points) else None,
        )
        if view.target is not None:
            shift = np.subtract(view.target, camera.target)
            eye = tuple((np.asarray(camera.position) + shift).tolist())
            camera = replace(camera, position=eye, target=view.target)
    return _zoomed(_rolled(camera, view.roll), view.zoom)


def _revolved(points: NDArray, center: NDArray, direction: tuple, up: tuple) -> NDArray[np.float64]:
    """Points and radii turned to twelve sides about the picture's vertical through ``center``."""
    axis = Camera(direction, (0, 0, 0), up).view_from_world()[1, :3]
    half = np.radians(np.arange(0, 360, 30))[:, None] / 2
    turns = rotation_matrices(np.concatenate([axis * np.sin(half), np.cos(half)], axis=1))
    turned = np.einsum("kij,nj->kni", turns, points[:, :3] - center) + center
    radii = np.broadcast_to(points[None, :, 3:], (*turned.shape[:2], 1))
    return np.concatenate([turned, radii], axis=-1).reshape(-1, 4)


def _placed(view: ViewSettings, bounds: NDArray) -> Camera:
    assert view.position is not None
    middle = tuple(np.mean(bounds, axis=0).tolist())
    camera = Camera(view.position, view.target or middle, view.up or (0.0, 1.0, 0.0), view.fov)
    if view.orthographic:
        camera = replace(camera, height=2 * camera.distance * camera.half_height())
    return camera


def _sides(scene: Scene) -> dict[str, tuple[tuple, tuple]]:
    patient = bool(scene.items) and all(
        getattr(getattr(item, "volume", None), "anatomical", False) for item in scene.items
    )
    if scene.items and len(scene.reservoirs) == len(scene.items):
        return _RESERVOIR_SIDES
    return _PATIENT_SIDES if patient else _SIDES


def _direction(
    view: ViewSettings, points: NDArray, sides: dict[str, tuple[tuple, tuple]]
) -> tuple[tuple, tuple]:
    """Unit directions to the eye and upward."""
    if view.view == _PRINCIPAL:
        rows = principal_axes(points[:, :3])
        direction, up = tuple(rows[2].tolist()), tuple(rows[1].tolist())
    else:
        direction, up = sides[view.view]
    if view.up is not None:
        up = view.up
    probe = Camera(direction, (0, 0, 0), up).orbited(view.azimuth, view.elevation)
    return probe.position, probe.up


def principal_axes(positions: NDArray) -> NDArray[np.float64]:
    """(3, 3) rows: axes of the longest, middle and shortest extent, right-handed.

    An axis's sign is chosen so that the longer tail of the points lies on its positive side; the
    same structure therefore always shows the same face.
    """
    if len(positions) < 2:
        return np.eye(3)
    centered = np.asarray(positions, np.float64) - np.mean(positions, axis=0)
    _, vectors = np.linalg.eigh(centered.T @ centered)
    axes = vectors.T[::-1].copy()
    skew = np.sum((centered @ axes.T) ** 3, axis=0)
    axes[skew < 0] *= -1
    axes[2] = np.cross(axes[0], axes[1])
    return axes


def _rolled(camera: Camera, degrees: float) -> Camera:
    if not degrees:
        return camera
    right, up, _ = camera.view_from_world()[:3, :3]
    # the picture turns clockwise when the camera turns the other way
    angle = math.radians(degrees)
    turned = math.cos(angle) * up - math.sin(angle) * right
    return replace(camera, up=tuple(turned.tolist()))


def _zoomed(camera: Camera, zoom: float) -> Camera:
    """A longer lens from the same place, so that zooming never cuts into the scene."""
    if zoom == 1:
        return camera
    if camera.height is not None:
        return replace(camera, height=camera.height / zoom)
    half = math.atan(camera.half_height() / zoom)
    return replace(camera, fov=min(170.0, max(0.01, math.degrees(2 * half))))


def _bounds(points: NDArray) -> NDArray[np.float64]:
    centers, radii = points[:, :3], points[:, 3:]
    return np.stack([(centers - radii).min(axis=0), (centers + radii).max(axis=0)])
