"""Mouse, touch and keys: rendercanvas' events to what a view does.

Left drag turns, right or Ctrl+left (or middle) drag shifts, the wheel zooms to the pointer, a click
selects, Shift+click adds, a double click centres. :data:`KEYS` lists the keys.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from scuro.viewer import navigate
from scuro.viewer.handles import Handles
from scuro.viewer.probing import Probing
from scuro.viewer.view import View

KEYS = {
    "x, y, z": "look along an axis; with Shift from the other side",
    "f": "fit the scene to the picture",
    "i": "spin",
    "o": "parallel or perspective projection",
    "c": "add a clipping plane through the middle; Delete removes the chosen one, v flips it",
    "b": "clip to a box",
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
LEFT, RIGHT, MIDDLE = 1, 2, 3


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

    # --- pointer -----------------------------------------------------------------------------

    def _down(self, event: dict[str, Any]) -> None:
        point = (event["x"], event["y"])
        self._start = self.pointer = point
        modifiers, button = event.get("modifiers", ()), event["button"]
        held = [h for h in self._holders if button == LEFT and h.press(point, self.logical)]
        if held:
            self._drag = lambda last, now: held[0].drag(last, now, self.logical)
        elif button in (RIGHT, MIDDLE) or (button == LEFT and "Control" in modifiers):
            self._depth = self.view.depth(*self._relative(point))
            self._drag = self._pan
        elif button == LEFT:
            self._drag = self._roll if navigate.on_rim(point, self.logical) else self._orbit

    def _move(self, event: dict[str, Any]) -> None:
        last, self.pointer = self.pointer, (event["x"], event["y"])
        if self._drag is not None and last is not None and last != self.pointer:
            self._drag(last, self.pointer)

    def _up(self, event: dict[str, Any]) -> None:
        point, start = (event["x"], event["y"]), self._start
        dragged, self._drag, self._start = self._drag, None, None
        held = any([holder.release() for holder in self._holders])
        self.view.model.history.end_gesture()
        if start is None or dragged is None or held or event["button"] != LEFT:
            return
        if max(abs(point[0] - start[0]), abs(point[1] - start[1])) <= _CLICK:
            add = "Shift" in event.get("modifiers", ())
            self.view.select(self.view.pick(*self._relative(point)), add)

    def _leave(self, event: dict[str, Any]) -> None:
        self.pointer = None

    def _double(self, event: dict[str, Any]) -> None:
        x, y = self._relative((event["x"], event["y"]))
        found = self.view.pick(x, y)
        if found is not None:
            self.view.move(navigate.centered(self.view.camera, found.anchor))

    def _wheel(self, event: dict[str, Any]) -> None:
        point = (event["x"], event["y"])
        notches = -event["dy"] / _NOTCH
        if "Shift" in event.get("modifiers", ()):
            self.handles.advance(notches)
            return
        depth = self.view.depth(*self._relative(point))
        camera = self.view.camera
        anchor = navigate.unproject(camera, point, self.logical, depth)
        self.view.move(navigate.zoom(camera, _STEP**notches, anchor))

    def _orbit(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        move = (now[0] - last[0], now[1] - last[1])
        self.view.move(navigate.orbit(self.view.camera, move, self.logical))

    def _roll(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        self.view.move(navigate.roll(self.view.camera, last, now, self.logical))

    def _pan(self, last: tuple[float, float], now: tuple[float, float]) -> None:
        move = (now[0] - last[0], now[1] - last[1])
        self.view.move(navigate.pan(self.view.camera, move, self.logical, self._depth))

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
    "b": lambda c: c.handles.add_box(),
    "v": lambda c: c.handles.flip(),
    "Delete": lambda c: c.handles.remove(),
    "Escape": Controls._escape,
}
