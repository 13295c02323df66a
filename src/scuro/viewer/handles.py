"""Handles on the picture for clipping planes and the navigation cube.

A plane has a ring about its point, a knob there, which pushes it along its normal, and a stalk
whose end tilts it. Where the stalk would point at the eye or away from it, it lies on the ring and
rocks the plane like a ball under the hand.
The cube has a knob on each face, which pushes the face, one in its middle, which moves the cube,
and a stalk that turns it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.scene.camera import Camera
from scuro.scene.clip import Cut, Plane
from scuro.viewer import cube, navigate
from scuro.viewer.eyes import Eye
from scuro.viewer.navigate import Size
from scuro.viewer.view import View

REACH = 10.0
"""Pixels within which a press takes hold of a handle."""
STALK = 0.15
"""Length of the stalks, as a share of the distance the picture's height covers."""
PUSH, TILT, ROCK, FACE, MOVE, TURN = "push", "tilt", "rock", "face", "move", "turn"
_FACING = 0.94
"""Cosine of the angle between the normal and the line of sight from which a stalk is too short."""
_GESTURE = "clip handle"


@dataclass(frozen=True)
class Handle:
    """One thing that can be held."""

    kind: str
    """``push``, and ``tilt`` or ``rock``, of planes; ``face``, ``move``, ``turn`` of the cube."""
    number: int
    """Of the plane, or of the face."""
    world: tuple[float, float, float]
    root: tuple[float, float, float]
    """Where its stalk begins; ``world`` itself for knobs."""


class Handles:
    """The handles of a view's clipping planes and its cube."""

    def __init__(self, view: View) -> None:
        self.view = view
        self.shown = True
        self.chosen: int | None = None
        """The plane that keys and Shift+wheel move."""
        self.held: Handle | None = None

    @property
    def planes(self) -> tuple[Plane, ...]:
        """Those that are set one by one; the cube's are not among them."""
        model = self.view.model
        return tuple(cut.plane(model.middle) for cut in model.document.clip)

    def corners(self) -> NDArray[np.float64] | None:
        """(8, 3) of the cube, if there is one."""
        model = self.view.model
        clipping = model.document.clipping
        return None if clipping.cube is None else cube.corners(clipping, model.middle)

    def all(self) -> list[Handle]:
        """Every handle, with its place in the world."""
        found = []
        right, _, back = self.view.camera.view_from_world()[:3, :3]
        for index, plane in enumerate(self.planes):
            normal = plane.equation()[:3]
            facing = abs(float(normal @ back)) > _FACING
            way = _flattened(right, normal) if facing else normal
            end = np.asarray(plane.point) + way * self._length
            found.append(Handle(PUSH, index, plane.point, plane.point))
            found.append(Handle(ROCK if facing else TILT, index, _tuple(end), plane.point))
        model = self.view.model
        clipping = model.document.clipping
        if clipping.cube is not None:
            middle = _tuple(cube.center(clipping, model.middle))
            found.append(Handle(MOVE, 0, middle, middle))
            for number in range(6):
                place = _tuple(cube.face(clipping, model.middle, number)[0])
                found.append(Handle(FACE, number, place, place))
            end = cube.corners(clipping, model.middle)[7]
            found.append(Handle(TURN, 0, _tuple(end), _tuple(end)))
        return found

    def rings(self) -> list[NDArray[np.float64]]:
        """(n, 3) points of a circle in each plane about its point."""
        angles = np.linspace(0, 2 * np.pi, 48, endpoint=False)[:, None]
        found = []
        for plane in self.planes:
            normal = plane.equation()[:3]
            u = _flattened(np.eye(3)[np.argmin(np.abs(normal))], normal)
            around = np.cos(angles) * u + np.sin(angles) * np.cross(normal, u)
            found.append(np.asarray(plane.point) + self._length * around)
        return found

    @property
    def _length(self) -> float:
        """Of stalks, in the world."""
        return STALK * navigate.pixel_size(self.view.camera, (1, 1))

    def near(self, point: Size, eye: Eye) -> Handle | None:
        """The nearest handle within reach of a pixel position, as an eye sees them."""
        handles = self.all() if self.shown else []
        if not handles:
            return None
        places = eye.project([h.world for h in handles])
        away = np.hypot(places[:, 0] - point[0], places[:, 1] - point[1])
        away[~(places[:, 2] > 0)] = np.inf
        nearest = int(np.argmin(away))
        return handles[nearest] if away[nearest] <= REACH else None

    def press(self, point: Size, eye: Eye) -> bool:
        """Take hold of the nearest handle within reach; whether there is one."""
        self.held = self.near(point, eye)
        if self.held is not None and self.held.kind in (PUSH, TILT, ROCK):
            self.chosen = self.held.number
        return self.held is not None

    def drag(self, last: Size, now: Size, eye: Eye) -> None:
        """Move what is held with the pointer."""
        held, camera = self.held, self.view.camera
        if held is None:
            return
        depth = float(eye.project([held.root])[0, 2])
        if depth <= 0:
            return
        step = navigate.pixel_size(camera, eye.size, depth)
        right, up, _ = camera.view_from_world()[:3, :3]
        move = ((now[0] - last[0]) * right - (now[1] - last[1]) * up) * step
        if held.kind in (PUSH, TILT, ROCK):
            self._drag_plane(held, move)
        else:
            self._drag_cube(held, move)
        if held.kind not in (TILT, ROCK):
            self.held = next(
                (h for h in self.all() if (h.kind, h.number) == (held.kind, held.number)), None
            )

    def _drag_plane(self, held: Handle, move: NDArray) -> None:
        if held.number >= len(self.planes):
            return
        plane, camera = self.planes[held.number], self.view.camera
        normal = plane.equation()[:3]
        if held.kind == PUSH:
            changed = _pushed(plane, _along(normal, move, camera))
        elif held.kind == TILT:
            changed = Plane(plane.point, _tuple(normal * self._length + move))
        else:
            changed = Plane(plane.point, _tuple(_rocked(normal, move, camera, self._length)))
        self.set(held.number, changed, f"{_GESTURE} {held.number}")

    def _drag_cube(self, held: Handle, move: NDArray) -> None:
        model, camera = self.view.model, self.view.camera
        clipping = model.document.clipping
        if clipping.cube is None:
            return
        if held.kind == MOVE:
            changed = cube.moved(clipping, model.middle, move)
        elif held.kind == FACE:
            _, outward = cube.face(clipping, model.middle, held.number)
            changed = cube.pushed(
                clipping, model.middle, held.number, _along(outward, move, camera)
            )
        else:
            back = camera.view_from_world()[2, :3]
            axis = np.cross(back, move)
            radius = float(np.linalg.norm(clipping.cube)) / 2
            if not axis.any():
                return
            changed = cube.turned(clipping, axis, float(np.linalg.norm(move)) / radius)
        model.change(f"{_GESTURE} cube", clipping=changed)

    def release(self) -> bool:
        """Let go; whether something was held."""
        held, self.held = self.held, None
        return held is not None

    # --- keys and buttons --------------------------------------------------------------------

    def advance(self, notches: float) -> None:
        """Push the chosen (or only) plane along its normal by a share of the scene's size."""
        index = self._target()
        if index is not None:
            extent = float(np.linalg.norm(np.ptp(self.view.model.scene.bounds(), axis=0)))
            plane = _pushed(self.planes[index], 0.01 * extent * notches)
            self.set(index, plane, f"{_GESTURE} {index}")

    def flip(self) -> None:
        """Keep the other side of the chosen plane."""
        index = self._target()
        if index is not None:
            plane = self.planes[index]
            self.set(index, replace(plane, normal=_tuple(-np.asarray(plane.normal))), None)

    def remove(self) -> None:
        """Take the chosen plane away; the cube if there are no planes."""
        index = self._target()
        model = self.view.model
        if index is not None:
            cuts = model.document.clip
            self.chosen = None
            model.change(clip=cuts[:index] + cuts[index + 1 :])
        elif model.document.clipping.cube is not None:
            model.change(clipping=model.document.clipping.replace(cube=None))

    def add_plane(self) -> None:
        """A plane through what the camera looks at, taking away the nearer side."""
        forward = _tuple(-self.view.camera.view_from_world()[2, :3])
        cuts = self.view.model.document.clip
        cut = Cut(normal=forward, point=self.view.camera.target)
        if self.view.model.change(clip=(*cuts, cut)):
            self.chosen = len(cuts)

    def toggle_cube(self, rest: str) -> None:
        """Clip to a box, outside of which polymers show as ``rest``; or do so no longer."""
        model = self.view.model
        clipping = model.document.clipping
        if clipping.cube is not None:
            model.change(clipping=clipping.replace(cube=None))
            return
        new = cube.made(model.scene.bounds(), rest)
        model.change(clipping=new.replace(spare=clipping.spare, whole_atoms=clipping.whole_atoms))

    def set(self, index: int, plane: Plane, gesture: str | None) -> None:
        """Put another plane in the place of one."""
        cuts = self.view.model.document.clip
        cut = Cut(normal=plane.normal, point=plane.point)
        self.view.model.change(gesture, clip=(*cuts[:index], cut, *cuts[index + 1 :]))

    def _target(self) -> int | None:
        count = len(self.planes)
        if self.chosen is not None and self.chosen < count:
            return self.chosen
        return count - 1 if count else None


def _pushed(plane: Plane, distance: float) -> Plane:
    point = np.asarray(plane.point) + distance * plane.equation()[:3]
    return replace(plane, point=_tuple(point))


def _rocked(normal: NDArray, move: NDArray, camera: Camera, radius: float) -> NDArray:
    """A normal turned like a ball of a radius under the hand: about the axis across the move."""
    from scipy.spatial.transform import Rotation

    length = float(np.linalg.norm(move))
    if length == 0:
        return normal
    axis = np.cross(camera.view_from_world()[2, :3], move) / length
    turned: NDArray = Rotation.from_rotvec(axis * length / radius).apply(normal)
    return turned


def _flattened(way: NDArray, normal: NDArray) -> NDArray:
    """The unit direction in a plane that is nearest to another."""
    flat = way - normal * (normal @ way)
    return np.asarray(flat / np.linalg.norm(flat))


def _along(normal: NDArray, move: NDArray, camera: Camera) -> float:
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


def _tuple(v: ArrayLike) -> tuple[float, float, float]:
    x, y, z = (np.asarray(v, np.float64) + 0.0).tolist()  # nobody wants to read -0
    return x, y, z
