"""Handles on the picture for clipping planes: a knob to push, a ring to tilt.

Each plane has a knob at its point and a stalk along its normal. Dragging the knob moves the plane
along its normal, dragging the stalk's end tilts it. Boxes are six planes that face inward; their
knobs lie on the faces.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scuro.scene.clip import MAX_PLANES, Clip, Plane
from scuro.viewer import navigate
from scuro.viewer.navigate import Size
from scuro.viewer.view import View

REACH = 9.0
"""Pixels within which a press takes hold of a handle."""
STALK = 0.15
"""Length of the stalks, as a share of the distance the picture's height covers."""
PUSH, TILT = "push", "tilt"
_GESTURE = "clip handle"


@dataclass(frozen=True)
class Handle:
    """One thing that can be held."""

    plane: int
    kind: str
    """``push`` or ``tilt``."""
    world: tuple[float, float, float]


class Handles:
    """The handles of a view's clipping planes."""

    def __init__(self, view: View) -> None:
        self.view = view
        self.shown = True
        self.chosen: int | None = None
        """The plane that keys and Shift+wheel move."""
        self._held: Handle | None = None

    @property
    def planes(self) -> tuple[Plane, ...]:
        return self.view.model.clip.planes

    def all(self) -> list[Handle]:
        """Every handle, with its place in the world."""
        found = []
        length = STALK * navigate.pixel_size(self.view.camera, (1, 1))
        for index, plane in enumerate(self.planes):
            n = plane.equation()[:3]
            point = np.asarray(plane.point)
            found.append(Handle(index, PUSH, plane.point))
            found.append(Handle(index, TILT, _tuple(point + n * length)))
        return found

    def press(self, point: Size, size: Size) -> bool:
        """Take hold of the nearest handle within reach; whether there is one."""
        handles = self.all() if self.shown else []
        if not handles:
            return False
        places = navigate.project(self.view.camera, [h.world for h in handles], size)
        away = np.hypot(places[:, 0] - point[0], places[:, 1] - point[1])
        away[~(places[:, 2] > 0)] = np.inf
        nearest = int(np.argmin(away))
        if away[nearest] > REACH:
            return False
        self._held = handles[nearest]
        self.chosen = self._held.plane
        return True

    def drag(self, last: Size, now: Size, size: Size) -> None:
        """Move what is held with the pointer."""
        if self._held is None or self._held.plane >= len(self.planes):
            return
        plane = self.planes[self._held.plane]
        camera = self.view.camera
        depth = float(navigate.project(camera, [plane.point], size)[0, 2])
        if depth <= 0:
            return
        step = navigate.pixel_size(camera, size, depth)
        right, up, _ = camera.view_from_world()[:3, :3]
        move = ((now[0] - last[0]) * right - (now[1] - last[1]) * up) * step
        if self._held.kind == PUSH:
            changed = _pushed(plane, _along(plane.equation()[:3], move, camera))
        else:
            length = STALK * navigate.pixel_size(camera, (1, 1))
            changed = Plane(plane.point, _tuple(plane.equation()[:3] * length + move))
        self._replace(self._held.plane, changed)

    def release(self) -> bool:
        """Let go; whether something was held."""
        held, self._held = self._held, None
        return held is not None

    def advance(self, notches: float) -> None:
        """Push the chosen (or only) plane along its normal by a share of the scene's size."""
        index = self._target()
        if index is not None:
            extent = float(np.linalg.norm(np.ptp(self.view.model.scene.bounds(), axis=0)))
            self._replace(index, _pushed(self.planes[index], 0.01 * extent * notches))

    def flip(self) -> None:
        """Keep the other side of the chosen plane."""
        index = self._target()
        if index is not None:
            plane = self.planes[index]
            self._set(index, replace(plane, normal=_tuple(-np.asarray(plane.normal))), None)

    def remove(self) -> None:
        """Take the chosen plane away."""
        index = self._target()
        if index is not None:
            planes = self.planes[:index] + self.planes[index + 1 :]
            self.chosen = None
            self.view.model.change(clip=Clip(planes))

    def add_plane(self) -> None:
        """A plane through what the camera looks at, taking away the nearer side."""
        forward = -self.view.camera.view_from_world()[2, :3]
        plane = Plane(self.view.camera.target, _tuple(forward))
        if len(self.planes) < MAX_PLANES:
            self.view.model.change(clip=Clip((*self.planes, plane)))
            self.chosen = len(self.planes) - 1

    def add_box(self) -> None:
        """Six planes around the scene, facing inward."""
        low, high = self.view.model.scene.bounds()
        middle = (low + high) / 2
        made = []
        for axis in range(3):
            for side, sign in ((low, 1.0), (high, -1.0)):
                point, normal = middle.copy(), np.zeros(3)
                point[axis], normal[axis] = side[axis], sign
                made.append(Plane(_tuple(point), _tuple(normal)))
        if len(self.planes) + 6 <= MAX_PLANES:
            self.view.model.change(clip=Clip((*self.planes, *made)))
            self.chosen = len(self.planes) - 1

    def _target(self) -> int | None:
        if self.chosen is not None and self.chosen < len(self.planes):
            return self.chosen
        return len(self.planes) - 1 if self.planes else None

    def _replace(self, index: int, plane: Plane) -> None:
        self._set(index, plane, f"{_GESTURE} {index}")

    def _set(self, index: int, plane: Plane, gesture: str | None) -> None:
        planes = (*self.planes[:index], plane, *self.planes[index + 1 :])
        self.view.model.change(gesture, clip=Clip(planes))


def _pushed(plane: Plane, distance: float) -> Plane:
    point = np.asarray(plane.point) + distance * plane.equation()[:3]
    return replace(plane, point=_tuple(point))


def _along(normal: NDArray, move: NDArray, camera: navigate.Camera) -> float:
    """How far along a normal a move in the picture's plane goes.

    A normal that points at the eye is pushed by moving up and down.
    """
    back, up = camera.view_from_world()[2, :3], camera.view_from_world()[1, :3]
    flat = normal - back * (normal @ back)
    length = float(np.linalg.norm(flat))
    if length < 0.2:
        return -float(move @ up) * float(np.sign(normal @ back))
    # the knob follows the pointer along the normal's image, which is foreshortened
    return float(move @ flat) / length**2


def _tuple(v: NDArray) -> tuple[float, float, float]:
    x, y, z = np.asarray(v, np.float64).tolist()
    return x, y, z
