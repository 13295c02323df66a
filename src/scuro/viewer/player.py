"""Playing: the frames of a trajectory, the models of a file, the time steps of a reservoir."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import ScuroError
from scuro.load.options import LoadOptions
from scuro.scene.points import moving_points
from scuro.scene.scene import Scene
from scuro.settings import SettingsGroup, setting

if TYPE_CHECKING:
    from scuro.load.trajectory import Trajectory
    from scuro.viewer.model import Model

_GESTURE = "play"


class PlaySettings(SettingsGroup):
    """How frames are played."""

    speed: float = setting(10.0, "frames a second", low=0.1, high=120)
    loop: str = setting(
        "loop", "at the end: begin again, turn back, or stop", choices=("loop", "swing", "once")
    )
    smooth: bool = setting(True, "go straight from frame to frame, where atoms move")


class Player:
    """The time of a model's scene: what there is to play, and where it stands.

    Args:
        model: Whose scene; the frame is part of its document, so that saving keeps it.
        clock: Seconds, for tests.
    """

    def __init__(self, model: Model, clock: Callable[[], float] = time.perf_counter) -> None:
        self._model = model
        self._clock = clock
        self._trajectory: Trajectory | None = None
        self._at = 0.0
        self._backward = False
        self._broken = False
        self._points: tuple[Any, NDArray[np.float64] | None] = (None, None)
        self.settings = PlaySettings()
        self.playing = False

    @property
    def kind(self) -> str:
        """``frames``, ``steps``, or empty: nothing to play."""
        scene, document = self._model.scene, self._model.document
        if self._broken:
            return ""
        if len(scene.molecules) == 1 == len(document.input) and document.load.model == "first":
            if document.load.trajectory is not None or scene.molecules[0].molecule.models > 1:
                return "frames"
        elif len(scene.reservoirs) == 1:
            item = scene.reservoirs[0]
            if len(item.grid.steps) > 1 and item.grid.changes(item.shown_property):
                return "steps"
        return ""

    @property
    def length(self) -> int:
        """Number of frames or steps; 0 if there is nothing to play."""
        kind = self.kind
        if kind == "steps":
            return len(self._model.scene.reservoirs[0].grid.steps)
        if kind == "frames":
            try:
                return len(self._open())
            except ScuroError as error:
                self._model.message = str(error)
                self.playing, self._broken = False, True
        return 0

    @property
    def place(self) -> float:
        """The frame that is shown, from 0; between two where it is not whole."""
        if self.kind == "steps":
            time = self._model.settings.reservoir.time
            return time % self.length
        frame = self._model.document.load.frame
        return frame if frame >= 0 else frame + self.length

    @property
    def caption(self) -> str:
        """Which frame, in words; for reservoirs its date."""
        if self.kind == "steps":
            return str(self._model.scene.reservoirs[0].grid.steps[int(self.place)])
        place = self.place
        number = f"{place + 1:.0f}" if place == int(place) else f"{place + 1:.1f}"
        return f"{number} of {self.length}"

    def points(self, focus: str = "") -> NDArray[np.float64] | None:
        """(n, 4) centres and radii that bound what is seen in all frames, as films are fitted.

        Args:
            focus: A selection that alone counts, if there is one.

        Returns:
            ``None`` where no atoms move.

        Raises:
            ScuroError: A frame cannot be read, or the focus selects nothing.
        """
        if self.kind != "frames" or self.length < 2:
            return None
        item, trajectory = self._model.scene.molecules[0].twin(), self._open()
        asked = (tuple(item.shown), item.assembly, focus)
        if self._points[0] != asked:

            def play(place: float) -> None:
                item.molecule = trajectory.at(place)

            self._points = asked, moving_points([Scene([item])], play, len(trajectory) - 1, focus)
        return self._points[1]

    def _open(self) -> Trajectory:
        if self._trajectory is None:
            from scuro.load.trajectory import open_trajectory

            document = self._model.document
            changes = document.load.as_dict()
            for key in ("frame", "model", "voxels"):
                changes.pop(key)
            line = document.input[0]
            path = changes.pop("trajectory")
            self._trajectory = open_trajectory(line.path, path, format=line.format, **changes)
        return self._trajectory

    # --- moving in time ----------------------------------------------------------------------

    @staticmethod
    def only_plays(new: LoadOptions, old: LoadOptions) -> bool:
        """Whether options differ in the frame at most: no file must be read again."""
        return new.replace(frame=0.0) == old.replace(frame=0.0)

    def show(self, load: LoadOptions) -> None:
        """Put the molecule where a frame has it.

        Raises:
            LoadError: It cannot be read.
        """
        item = self._model.scene.molecules[0]
        item.molecule = self._open().at(load.frame)
        if self._model.probe is not None:
            self._model.probe.follow(self._model.scene)

    def seek(self, place: float, gesture: str | None = _GESTURE) -> None:
        """Go to a frame."""
        model = self._model
        if not self.length:
            return  # keys come whether there is time or not
        place = min(max(place, 0.0), float(self.length - 1))
        if self.kind == "steps":
            if int(place) != self.place:
                settings = model.settings.replace(reservoir__time=int(place))
                model.change(gesture, settings=settings)
        elif place != self.place:
            model.change(gesture, load=model.document.load.replace(frame=place))

    def toggle(self) -> None:
        """Play, or stop."""
        if self.playing:
            self.stop()
        elif self.length > 1:
            if self.settings.loop == "once" and self.place >= self.length - 1:
                self.seek(0.0)
            self.playing, self._at = True, self._clock()
            self._model.tell()

    def stop(self) -> None:
        """Stop where it is."""
        if self.playing:
            self.playing = False
            self._model.history.end_gesture()
            self._model.tell()

    def step(self, count: int) -> None:
        """Go on by whole frames, or back; around the ends."""
        self.stop()
        whole = round(self.place)
        self.seek(float((whole + count) % max(self.length, 1)), None)

    @property
    def wait(self) -> float | None:
        """Seconds until the next picture; ``None`` when nothing plays."""
        if not self.playing:
            return None
        if self.settings.smooth and self.kind == "frames":
            return 0.0
        return max(0.0, self._at + 1 / self.settings.speed - self._clock())

    def tick(self) -> None:
        """Take the scene to the present time."""
        length = self.length if self.playing else 0
        if length < 2:
            self.playing = False
            return
        now = self._clock()
        passed = (now - self._at) * self.settings.speed
        if not (self.settings.smooth and self.kind == "frames"):
            if passed < 1:
                return
            # a slow machine shows every frame instead of leaving some out
            passed = 1.0
        self._at = now
        # at most one frame at once: no frame is left out where drawing is slower than playing
        self._advance(min(passed, 1.0), length)

    def _advance(self, passed: float, length: int) -> None:
        place, last = self.place, float(length - 1)
        if not (self.settings.smooth and self.kind == "frames"):
            place = float(round(place))
        place += -passed if self._backward else passed
        loop = self.settings.loop
        if loop == "swing":
            if place >= last or place <= 0:
                self._backward = place >= last
                place = min(max(place, 0.0), last)
        elif place > last:
            if loop == "once":
                self.seek(last)
                self.stop()
                return
            place = 0.0
        elif self._backward:
            self._backward = False
        self.seek(place)


def play_options(player: Player) -> dict[str, Any]:
    """The options of a film that plays as the player does: see ``MovieSettings``."""
    if player.kind != "frames":
        return {}
    return {"play": True, "fps": max(1.0, player.settings.speed)}
