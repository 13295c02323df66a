"""Undo and redo: a line of immutable states."""

from __future__ import annotations

from dataclasses import dataclass, field

from scuro.export.scene_file import SceneFile
from scuro.probe.probe import ProbeSettings

MOST_STEPS = 500
"""Older states are forgotten; states share all that did not change, so that each is small."""


@dataclass(frozen=True)
class State:
    """Everything about a scene that people change and may want back."""

    document: SceneFile
    probe: ProbeSettings | None = None
    """Of the probe in the scene, if there is one. Where it is depends on the atoms."""


@dataclass
class History:
    """The states before and after the present one."""

    present: State
    _past: list[State] = field(default_factory=list)
    _future: list[State] = field(default_factory=list)
    _gesture: str | None = None

    def change(self, state: State, gesture: str | None = None) -> None:
        """Make ``state`` the present one.

        Args:
            state: The new state.
            gesture: Name of a running gesture (a slider being dragged); its later changes replace
                its first, so that one undo takes all of it back.
        """
        if state == self.present:
            return
        if gesture is None or gesture != self._gesture:
            self._past.append(self.present)
            del self._past[:-MOST_STEPS]
        self._gesture = gesture
        self.present = state
        self._future.clear()

    def end_gesture(self) -> None:
        """The next change is a step of its own."""
        self._gesture = None

    def undo(self) -> bool:
        """Go back a step; False if there is none."""
        return self._move(self._past, self._future)

    def redo(self) -> bool:
        """Go forward again; False if nothing was undone since the last change."""
        return self._move(self._future, self._past)

    def _move(self, source: list[State], target: list[State]) -> bool:
        self.end_gesture()
        if not source:
            return False
        target.append(self.present)
        self.present = source.pop()
        return True

    @property
    def steps(self) -> int:
        """How many states are kept besides the present one."""
        return len(self._past) + len(self._future)

    @property
    def can_undo(self) -> bool:
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        return bool(self._future)
