"""A gamepad at a desktop window: its sticks and triggers as events, like those of the browser."""

from __future__ import annotations

from typing import Any

PERIOD = 0.033
"""Seconds between two looks at a gamepad that is there."""
LOOKING = 2.0
"""Seconds between two looks for one that is not."""
_DEAD = 0.15


class Gamepad:
    """The first gamepad that GLFW knows the buttons of."""

    def __init__(self) -> None:
        self._moving = False

    def look(self) -> tuple[dict[str, Any] | None, float]:
        """An event if its sticks are off their rest (or just came back), and when to look again."""
        import glfw

        number = next((n for n in range(glfw.JOYSTICK_LAST + 1) if glfw.joystick_is_gamepad(n)), -1)
        state = glfw.get_gamepad_state(number) if number >= 0 else None
        if state is None:
            return None, LOOKING
        event = event_of(list(state.axes))
        moving = any(event[name] for name in ("x", "y", "z", "turn_x", "turn_y"))
        told = moving or self._moving
        self._moving = moving
        return (event if told else None), PERIOD


def event_of(axes: list[float]) -> dict[str, Any]:
    """The event of six axes: left stick, right stick (right and down are 1), triggers (-1 to 1)."""
    x, y, turn_x, turn_y, left, right = (0.0 if abs(a) < _DEAD else a for a in axes)
    pull = (right - left) / 2
    return {
        "event_type": "gamepad",
        "x": x,
        "y": -y,
        "z": 0.0 if abs(pull) < _DEAD else -pull,
        "turn_x": turn_x,
        "turn_y": turn_y,
    }
