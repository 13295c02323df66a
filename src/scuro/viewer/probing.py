"""The probe in a view: moved by mouse and keys, drawn over the picture, replayed along its path."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.probe.probe import Probe, ProbeSettings
from scuro.steps import in_thread
from scuro.viewer import navigate
from scuro.viewer.eyes import Eye
from scuro.viewer.jobs import Jobs, Work
from scuro.viewer.navigate import Size
from scuro.viewer.view import View

STEP = 0.4
"""Å the arrow keys move the hand."""
STICK = 12.0
"""Å a second a gamepad's stick moves the probe at most."""
REPLAY = 30.0
"""Places of a recorded path that are shown a second."""
_FORCE = 4.0
"""Å an arrow has for each Å of penetration (at a stiffness of one)."""
_LONGEST = 110.0
"""Pixels of an arrow, however strong the force."""
_BALL, _SHINE, _RIM = 0x70D09040, 0x24FFE8D0, 0xFF703818
_HAND, _ARROW, _PATH, _RIM_OF_PATH = 0xFF2020C0, 0xFF2020E0, 0xFFB06020, 0xC8F4EEE8
_COMPILING = "preparing the probe"
_KEYS = {
    "ArrowLeft": (-1, 0, 0),
    "ArrowRight": (1, 0, 0),
    "ArrowUp": (0, 1, 0),
    "ArrowDown": (0, -1, 0),
    "PageUp": (0, 0, -1),
    "PageDown": (0, 0, 1),
}
"""Right, up and toward the eye."""


def _is_compiled() -> bool:
    # importing the solver imports numba, which alone takes a second
    solver = sys.modules.get("scuro.probe.solver")
    return solver is not None and solver.is_compiled()


def _compile() -> None:
    from scuro.probe.solver import compile_loops

    compile_loops()


class Probing:
    """One view's hand on the model's probe, which all views share.

    Args:
        view: Where it is moved and seen.
        jobs: Where its loops are compiled, before the first probe of a process.
        clock: Seconds.
    """

    def __init__(
        self, view: View, jobs: Jobs, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self.view = view
        self._jobs = jobs
        self._clock = clock
        self._wanted = ProbeSettings()
        self._replay: list[list[float]] = []
        self._begun = 0.0
        self._shown = 0
        self._pushed = (0.0, 0.0, 0.0)
        self._pushed_at = 0.0

    @property
    def probe(self) -> Probe | None:
        return self.view.model.probe

    @property
    def settings(self) -> ProbeSettings:
        """Of the probe, or of the one that will be."""
        return self._wanted if self.probe is None else self.probe.settings

    def toggle(self) -> None:
        """Put a probe where the camera looks, onto the atoms there, or take it away.

        The first of a process comes when its loops are compiled, beside the pages.
        """
        model = self.view.model
        if model.probe is not None:
            self._wanted = model.probe.settings
            model.set_probe(None)
        elif _is_compiled():
            self._put()
        elif not any(job.title == _COMPILING for job in self._jobs.waiting):
            self._jobs.add(_COMPILING, self._put_compiled())

    def _put(self) -> None:
        camera = self.view.camera
        self.view.model.set_probe(self._wanted, camera.target, navigate.viewpoint(camera))

    def _put_compiled(self) -> Work:
        yield from in_thread(_compile)
        if self.probe is None:
            self._put()
        return ""

    def change(self, settings: ProbeSettings) -> None:
        """Take other settings."""
        self._wanted = settings
        if self.probe is not None:
            self.view.model.change("probe", probe=settings)

    # --- hands -------------------------------------------------------------------------------

    def key(self, key: str) -> bool:
        """Take a key; whether it was the probe's."""
        if key.lower() == "p":
            self.toggle()
            return True
        if self.probe is None or key not in _KEYS:
            return False
        self._replay = []
        offset = np.array(_KEYS[key]) @ self.view.camera.view_from_world()[:3, :3] * STEP
        self.probe.move(self.probe.position + offset)
        self.view.model.tell()
        return True

    def push(self, x: float, y: float, z: float) -> None:
        """A gamepad's sticks: to the right, up and toward the eye, each -1 to 1; until the next."""
        self._pushed, self._pushed_at = (x, y, z), self._clock()

    def _follow_sticks(self) -> None:
        now = self._clock()
        passed = min(now - self._pushed_at, 0.1)
        self._pushed_at = now
        if self.probe is None or not any(self._pushed):
            return
        way = np.array(self._pushed) @ self.view.camera.view_from_world()[:3, :3]
        # squared, so that a light touch is slow
        way *= float(np.linalg.norm(way)) * STICK * passed
        self.probe.move(self.probe.position + way)
        self.view.model.tell()

    def press(self, point: Size, eye: Eye) -> bool:
        """Take hold of the probe, if it is there."""
        if self.probe is None:
            return False
        x, y, depth = eye.project([self.probe.position])[0]
        reach = self._pixels(eye, depth) + 4
        held = bool(depth > 0 and np.hypot(x - point[0], y - point[1]) <= reach)
        if held:
            self._replay = []  # the hand has it
        return held

    def drag(self, last: Size, now: Size, eye: Eye) -> None:
        """Move the hand in the plane of the picture."""
        if self.probe is None:
            return
        camera = self.view.camera
        depth = float(eye.project([self.probe.target])[0, 2])
        step = navigate.pixel_size(camera, eye.size, depth)
        right, up, _ = camera.view_from_world()[:3, :3]
        move = ((now[0] - last[0]) * right - (now[1] - last[1]) * up) * step
        self.probe.move(self.probe.target + move)
        self.view.model.tell()

    def release(self) -> bool:
        """Let go: the hand springs back to the probe."""
        if self.probe is not None and (self.probe.force != 0).any():
            self.probe.rest()
            self.view.model.tell()
        return False

    def _pixels(self, eye: Eye, depth: float) -> float:
        """Radius of the probe on the screen."""
        radius = self.settings.radius
        return radius / navigate.pixel_size(eye.camera, eye.size, max(depth, 1e-6))

    # --- path --------------------------------------------------------------------------------

    @property
    def path(self) -> list[list[float]]:
        """What was recorded; if nothing, what was saved and is in the scene."""
        tracks = self.view.model.scene.tracks
        if self.probe is None or self.probe.path or not tracks:
            return [] if self.probe is None else self.probe.path
        return tracks[0].track.points.tolist()

    @property
    def replaying(self) -> bool:
        return bool(self._replay)

    def replay(self) -> None:
        """Go along the path again, or stop doing so."""
        if self._replay:
            self._replay = []
        elif self.probe is not None:
            self.probe.recording = False
            self._replay, self._begun, self._shown = list(self.path), self._clock(), -1

    @property
    def wait(self) -> float | None:
        """Seconds until the replay or a stick goes on; ``None`` if there is none."""
        if self.probe is not None and any(self._pushed):
            return 0.02
        return 1 / REPLAY if self._replay else None

    def tick(self) -> None:
        """Take the replay, and what the sticks push, to the present time."""
        self._follow_sticks()
        if not self._replay or self.probe is None:
            self._replay = []
            return
        index = int((self._clock() - self._begun) * REPLAY)
        if index >= len(self._replay):
            index, self._replay, places = len(self._replay) - 1, [], self._replay
        else:
            places = self._replay
        if index != self._shown:
            self._shown = index
            self.probe.move(places[index])
            self.view.model.tell()

    # --- drawing -----------------------------------------------------------------------------

    def draw(self, eye: Eye) -> None:
        """The probe, the hand, the force and the path, over the picture, for an eye."""
        from imgui_bundle import imgui

        from scuro.viewer.overlay import arrow

        probe = self.probe
        if probe is None:
            return
        paper = imgui.get_background_draw_list()
        if len(probe.path) > 1:
            _trail(paper, eye.project(probe.path))
        (x, y, depth), hand = eye.project([probe.position, probe.target])
        if depth <= 0:
            return
        radius = self._pixels(eye, depth)
        _ball(paper, (x, y), radius)
        if (probe.force != 0).any() and hand[2] > 0:
            paper.add_circle_filled((hand[0], hand[1]), 3.0, _HAND)
            arrow(paper, eye, probe.position, self._arrow(eye, depth), _ARROW)

    def _arrow(self, eye: Eye, depth: float) -> NDArray[np.float64]:
        """(3,) Å along the force: in proportion to a small one, and never out of the picture."""
        assert self.probe is not None
        force = _FORCE * self.probe.force
        length = float(np.linalg.norm(force))
        most = _LONGEST * navigate.pixel_size(eye.camera, eye.size, depth)
        shown: NDArray[np.float64] = force * (most * math.tanh(length / most) / length)
        return shown


def _trail(paper: Any, places: NDArray[np.float64]) -> None:
    """A line through places (n, 3), parted where they are behind the eye; with a light rim, so
    that it is seen on dark things, too."""
    from imgui_bundle import imgui

    hidden = np.flatnonzero(~(places[:, 2] > 0))
    runs = [np.delete(run, 0, 0) if n else run for n, run in enumerate(np.split(places, hidden))]
    for ink, width in ((_RIM_OF_PATH, 4.0), (_PATH, 2.0)):
        for run in runs:
            if len(run) > 1:
                points = [imgui.ImVec2(x, y) for x, y in run[:, :2].tolist()]
                paper.add_polyline(points, ink, width, 0)


def _ball(paper: Any, middle: Size, radius: float) -> None:
    """A translucent ball: seen wherever it is, and what is behind it, too."""
    x, y = middle
    paper.add_circle_filled(middle, radius, _BALL, 48)
    for share in (0.75, 0.5, 0.25):
        spot = (x - 0.3 * radius * (1 - share), y - 0.35 * radius * (1 - share))
        paper.add_circle_filled(spot, radius * share, _SHINE, 48)
    paper.add_circle(middle, radius, _RIM, 48, 1.5)
