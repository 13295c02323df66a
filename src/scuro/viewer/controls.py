"""Mouse, touch and keys: rendercanvas' events to what a view does.

What a drag does is a matter of habit: :data:`PROFILES`. In all of them the wheel zooms to the
pointer, a click selects, Shift+click adds, a double click centres. :data:`KEYS` lists the keys.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from scuro.viewer import navigate
from scuro.viewer.eyes import Eye, eye_at
from scuro.viewer.handles import Handles
from scuro.viewer.probing import Probing
from scuro.viewer.under import depth_at, surface_at
from scuro.viewer.view import View
from scuro.viewer.windowing import adjust_window, toggle_windowing

LEFT, RIGHT, MIDDLE = 1, 2, 3
TURN, SHIFT, ZOOM = "turn", "shift", "zoom"


@dataclass(frozen=True)
class Profile:
    """What drags do: by button and modifier key (empty for none)."""

    drags: dict[tuple[int, str], str]
    help: tuple[str, ...]


PROFILES = {
    "scuro": Profile(
        {
            (LEFT, ""): TURN, (LEFT, "Control"): SHIFT, (LEFT, "Meta"): SHIFT,
            (RIGHT, ""): SHIFT, (MIDDLE, ""): SHIFT,
        },
        ("left: turn (at the rim: roll)", "right, middle, Ctrl+left: shift", "wheel: zoom"),
    ),
    "pymol, chimerax": Profile(
        {(LEFT, ""): TURN, (MIDDLE, ""): SHIFT, (RIGHT, ""): ZOOM, (LEFT, "Alt"): SHIFT},
        ("left: turn", "middle, Alt+left: shift", "right: zoom"),
    ),
    "blender": Profile(
        {(MIDDLE, ""): TURN, (MIDDLE, "Shift"): SHIFT, (MIDDLE, "Control"): ZOOM},
        ("middle: turn", "Shift+middle: shift", "Ctrl+middle, wheel: zoom"),
    ),
}  # fmt: skip
"""Mouse habits by the programs they come from."""
KEYS = {
    "x, y, z": "look along an axis; with Shift from the other side",
    "f": "fit the scene to the picture",
    "i": "spin",
    "o": "parallel or perspective projection",
    "c": "add a clipping plane through the middle; Delete removes the chosen one, v flips it",
    "b": "clip to a box, n with the rest as a backbone: the navigation cube",
    "w": "window and level of a volume: dragging sets them until w is pressed again",
    "Space": "play or stop; comma and period go back and on by a frame",
    "p": "probe: arrows, Page Up and Page Down move it",
    "Escape": "select nothing",
    "Ctrl+Z, Ctrl+Y": "undo, redo",
}
"""What the keys do, for people."""
_STEP = 1.1
"""Enlargement of one notch of the wheel."""
_NOTCH = 100.0
"""Wheel events count in pixels; one notch of a mouse is so many."""
_CLICK = 4.0
"""Pixels the pointer may stray between pressing and releasing a click."""


class Controls:
    """One pointer and keyboard on one view. Positions are in logical pixels."""

    def __init__(self, view: View, handles: Handles, probing: Probing | None = None) -> None:
        self.view = view
        self.handles = handles
        self._holders = [h for h in (probing, handles) if h is not None]
        self.logical = (1.0, 1.0)
        """Width and height of the picture in the events' pixels."""
        self.pointer: tuple[float, float] | None = None
        self._start: tuple[float, float] | None = None
        self._drag: Callable[[tuple[float, float], tuple[float, float]], None] | None = None
        self._depth = 1.0
        self.key_hook: Callable[[str], bool] = lambda key: False
        """Is offered keys first; says whether it took one."""

    def handle(self, event: dict[str, Any]) -> None:
        """Act on one event."""
        handler = _HANDLERS.get(event["event_type"])
        if handler is not None:
            handler(self, event)

    @property
    def dragging(self) -> bool:
        return self._drag is not None

    def _relative(self, point: tuple[float, float]) -> tuple[float, float]:
        return point[0] / self.logical[0], point[1] / self.logical[1]

    def _eye(self, point: tuple[float, float]) -> Eye:
        """The one whose picture is there."""
        return eye_at(self.view.eyes(self.logical), point[0])

    # --- pointer -----------------------------------------------------------------------------

    def _down(self, event: dict[str, Any]) -> None:
        point = (event["x"], event["y"])
        self._start = self.pointer = point
        modifiers, button = event.get("modifiers", ()), event["button"]
        eye = self._eye(point)
        held = [h for h in self._holders if button == LEFT and h.press(point, eye)]
        if held:
            self._drag = lambda last, now: held[0].drag(last, now, self._eye(point))
        elif button == LEFT and self.view.windowing:
            self._drag = self._window
        else:
            self._drag = self._by_habit(button, modifiers, point)

    def _by_habit(
        self, button: int, modifiers: tuple[str, ...], point: tuple[float, float]
    ) -> Callable[[tuple[float, float], tuple[float, float]], None] | None:
        drags = PROFILES[self.view.profile].drags
        keys = [key for key in modifiers if (button, key) in drags]
        does = drags.get((button, keys[0] if keys else ""))
        if does == TURN:
            eye = self._eye(point)
            on_rim = navigate.on_rim(eye.local(point), eye.size)
            return self._roll if on_rim else self._orbit
        if does is not None:
            self._depth = depth_at(self.view, *self._relative(point))
        return {SHIFT: self._pan, ZOOM: self._zoom_by_drag, None: None}.get(does)

    def _move(self, event: dict[str, Any]) -> None:
        last, self.pointer = self.pointer, (event["x"], event["y"])
        if self._drag is not None and last is not None and last != self.pointer:
            self._drag(last, self.pointer)

    def _up(self, event: dict[str, Any]) -> None:
        point, start = (event["x"], event["y"]), self._start
        self._drag = self._start = None
        held = any([holder.release() for holder in self._holders])
        self.view.model.history.end_gesture()
        if start is None or held or event["button"] != LEFT:
            return
        if max(abs(point[0] - start[0]), abs(point[1] - start[1])) <= _CLICK:
            add = "Shift" in event.get("modifiers", ())
            self.view.select(surface_at(self.view, *self._relative(point)), add)

    def _leave(self, event: dict[str, Any]) -> None:
        self.pointer = None

    def _double(self, event: dict[str, Any]) -> None:
        x, y = self._relative((event["x"], event["y"]))
        found = surface_at(self.view, x, y)
        if found is not None:
            self.view.move(navigate.centered(self.view.camera, found.anchor))

    def _wheel(self, event: dict[str, Any]) -> None:
        point = (event["x"], event["y"])
        notches = -event["dy"] / _NOTCH
        if "Shift" in event.get("modifiers", ()):
            self.handles.advance(notches)
            return
        depth = depth_at(self.view, *self._relative(point))
        camera = self.view.camera
        anchor = self._eye(point).unproject(point, depth)
        self.view.move(navigate.zoom(camera, _STEP**notches, anchor))

    def _orbit(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        move = (now[0] - last[0], now[1] - last[1])
        self.view.move(navigate.orbit(self.view.camera, move, self._eye(now).size))

    def _roll(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        eye = self._eye(self._start or now)
        self.view.move(navigate.roll(self.view.camera, eye.local(last), eye.local(now), eye.size))

    def _zoom_by_drag(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        camera = self.view.camera
        factor = _STEP ** ((now[1] - last[1]) / 12)
        self.view.move(navigate.zoom(camera, factor, camera.target))

    def _window(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        """To the right widens the window, down lowers its level: as radiologists know it."""
        width, height = self.logical
        wider, higher = (now[0] - last[0]) / width, (last[1] - now[1]) / height
        adjust_window(self.view.model, wider, higher)

    def _pan(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        move = (now[0] - last[0], now[1] - last[1])
        self.view.move(navigate.pan(self.view.camera, move, self._eye(now).size, self._depth))

    # --- keys --------------------------------------------------------------------------------

    def _key(self, event: dict[str, Any]) -> None:
        key, modifiers = event["key"], event.get("modifiers", ())
        view = self.view
        if "Control" in modifiers or "Meta" in modifiers:
            if key.lower() == "z":
                (view.model.redo if "Shift" in modifiers else view.model.undo)()
            elif key.lower() == "y":
                view.model.redo()
            return
        if self.key_hook(key):
            return
        name = key.lower() if len(key) == 1 else key
        if name in navigate.AXES:
            view.move(navigate.along_axis(view.camera, name, "Shift" in modifiers))
        elif name in _KEYS:
            _KEYS[name](self)

    def _escape(self) -> None:
        self.view.selection = []
        self.view.windowing = False
        self.handles.chosen = None

    def _projection(self) -> None:
        camera = self.view.camera
        if camera.orthographic:
            self.view.move(replace(camera, height=None))
        else:
            height = 2 * camera.half_height() * camera.distance
            self.view.move(replace(camera, height=height))


_HANDLERS: dict[str, Callable[[Controls, dict[str, Any]], None]] = {
    "pointer_down": Controls._down,
    "pointer_move": Controls._move,
    "pointer_up": Controls._up,
    "pointer_leave": Controls._leave,
    "double_click": Controls._double,
    "wheel": Controls._wheel,
    "key_down": Controls._key,
}
_KEYS: dict[str, Callable[[Controls], None]] = {
    "f": lambda c: c.view.fit(),
    "i": lambda c: c.view.toggle_spin(),
    "o": Controls._projection,
    "c": lambda c: c.handles.add_plane(),
    "b": lambda c: c.handles.toggle_cube("none"),
    "n": lambda c: c.handles.toggle_cube("backbone"),
    "w": lambda c: toggle_windowing(c.view),
    " ": lambda c: c.view.model.player.toggle(),
    ",": lambda c: c.view.model.player.step(-1),
    ".": lambda c: c.view.model.player.step(1),
    "v": lambda c: c.handles.flip(),
    "Delete": lambda c: c.handles.remove(),
    "Escape": Controls._escape,
}
