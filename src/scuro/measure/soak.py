"""Random hands on a viewer for as long as one likes: nothing may grow or stand still."""

from __future__ import annotations

import gc
import random
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from scuro.errors import ScuroError
from scuro.export.scene_file import SceneFile
from scuro.heap import held
from scuro.measure.memory import resident_mb
from scuro.measure.soak_tour import tour
from scuro.viewer.screen import Screen

_KEYS = (*"xyzfiobncvpw,. ", "Delete", "Escape", "Tab", "ArrowUp", "ArrowLeft", "PageDown")
_ROUND = 4.0
"""Seconds after which all is put back as it was, and memory is measured: what the hands have set
(a finer picture, a larger atlas) may take memory, but not keep it."""
_GLANCE = 0.6
"""Seconds that each feature of the tour is drawn for at most."""
_RESTLESS = 90.0
"""Seconds after which a picture that does not come to rest has failed."""


@dataclass(frozen=True)
class Round:
    """Memory after the hands have put all back."""

    seconds: float
    """Since the hands began; before, of the tour, it is negative."""
    resident: float
    """MB of the process that are in RAM."""
    parts: dict[str, float]
    """What holds memory, by name: MB, or how many."""


@dataclass
class Soaked:
    """What came of it."""

    events: int = 0
    pictures: int = 0
    features: int = 0
    """How many were used once before growth counted."""
    longest: float = 0.0
    """Seconds the window stood still at most."""
    rounds: list[Round] = field(default_factory=list)
    """Of the hands, after the tour."""

    @property
    def growth(self) -> float:
        """Growth of memory since the tour, as a share: the median of the last tenth of the rounds
        in relation to that of the first tenth; 0 before there are two."""
        memory = [r.resident for r in self.rounds]
        tenth = max(1, len(memory) // 10)
        return _median(memory[-tenth:]) / _median(memory[:tenth]) - 1 if memory else 0.0

    @property
    def pace(self) -> float:
        """MB a minute that memory grows in the second half of the time: the slope of a line."""
        import numpy as np

        half = self.rounds[len(self.rounds) // 2 :]
        if len(half) < 3:
            return 0.0
        slope = np.polyfit([r.seconds for r in half], [r.resident for r in half], 1)[0]
        return float(60 * slope)

    def trends(self) -> dict[str, tuple[float, float]]:
        """What holds memory: how much at first and at last."""
        if not self.rounds:
            return {}
        first, last = self.rounds[0].parts, self.rounds[-1].parts
        return {name: (first[name], last[name]) for name in first}

    def line(self) -> str:
        """The result in a line."""
        if not self.rounds:
            return f"no round was completed; {self.features} features were used"
        return (
            f"{self.rounds[-1].seconds:.0f} s, {self.events} events, {self.pictures} pictures, "
            f"longest standstill {self.longest:.2f} s; memory {self.rounds[0].resident:.0f} MB "
            f"after {self.features} features, now {self.rounds[-1].resident:.0f} MB: "
            f"growth {self.growth:+.1%}, lately {self.pace:+.1f} MB/min"
        )


class _Soak:
    """Hands, a screen and what comes of it."""

    def __init__(self, screen: Screen, clock: Callable[[], float], result: Soaked) -> None:
        self.screen, self.clock, self.result = screen, clock, result
        self.target: Any = None

    def draw(self) -> None:
        screen = self.screen
        size = screen.physical
        if self.target is None or self.target.size[:2] != size:
            self.target = screen.gpu.texture(size, "rgba8unorm", attachment=True)
        start = self.clock()
        screen.draw(self.target)
        screen.gpu.finish()
        self.result.longest = max(self.result.longest, self.clock() - start)
        self.result.pictures += 1

    def rest(self, most: float, enough: bool = False) -> None:
        """Draw until there is nothing to draw, or, where that is ``enough``, for some seconds."""
        end = self.clock() + most
        view = self.screen.view
        # a text field that was clicked has its cursor blink for ever: that is no reason to go on
        while self.screen.wait == 0.0 or not view.complete:
            if self.clock() > end:
                if enough:
                    return
                raise ScuroError(f"the picture does not come to rest: {view.status}")
            self.draw()

    def put_back(self, document: SceneFile) -> None:
        """All as it was at first, drawn to the end."""
        screen = self.screen
        screen.handle({"event_type": "key_down", "key": "Escape", "modifiers": ()})
        screen.model.player.stop()
        screen.view.spinning = False
        screen.panel.jobs.close()
        screen.model.open(document)
        screen.view.camera = screen.view.initial_camera()
        screen.view.stir()
        screen.panel.open = True
        self.rest(_RESTLESS)
        gc.collect()

    def hands(self, hands: random.Random) -> None:
        """A gesture, and a few pictures of what it did."""
        for event in _gesture(hands, self.screen.logical):
            self.screen.handle(event)
            self.result.events += 1
            self.draw()
        for _ in range(hands.randrange(6)):
            if self.screen.wait is None:
                break
            self.draw()


def soak(
    screen: Screen,
    seconds: float,
    seed: int = 0,
    clock: Callable[[], float] = time.perf_counter,
    documents: Sequence[SceneFile] | None = None,
    warm: bool = True,
    say: Callable[[str], None] = lambda line: None,
    result: Soaked | None = None,
) -> Soaked:
    """Use every feature once; then drag, scroll, click and press keys at random, drawing between.

    Args:
        screen: Already of some size.
        seconds: For how long the hands have it, after the tour of the features.
        seed: Of the hands.
        clock: Seconds, for tests.
        documents: Shown in turn, one a round; the one that is open by default.
        warm: Whether to use every feature first.
        say: Is told how it goes, after every feature and round.
        result: Where to keep what came of it, for one who may have to stop.

    Raises:
        ScuroError: A picture never comes to rest.
    """
    result = Soaked() if result is None else result
    documents = documents or [screen.model.document]
    at, hand = _Soak(screen, clock, result), random.Random(seed)
    for document in documents if warm else ():
        at.put_back(document)
        for name in tour(screen, lambda: at.rest(_GLANCE, enough=True)):
            result.features += 1
            say(f"{result.features} features, {resident_mb():.0f} MB: {name}")
    begun, turn = clock(), 0
    while clock() < begun + seconds or not turn:
        document = documents[turn % len(documents)]
        at.put_back(document)
        again = clock() + _ROUND
        while clock() < min(again, begun + seconds):
            at.hands(hand)
        # always the first, so that rounds compare
        at.put_back(documents[0])
        turn += 1
        result.rounds.append(Round(clock() - begun, resident_mb(), _parts(screen)))
        say(result.line())
    return result


def _parts(screen: Screen) -> dict[str, float]:
    gpu, targets = screen.gpu, screen.view.renderer.targets
    return {
        **held(),
        "textures of pictures, MB": targets.bytes / (1 << 20),
        "pipelines": float(gpu.programs.count),
        "Python objects": float(len(gc.get_objects())),
        "states to undo": float(screen.model.history.steps),
    }


def _gesture(hands: random.Random, size: tuple[float, float]) -> list[dict[str, Any]]:
    """A few events in a row."""

    def event(kind: str, **more: Any) -> dict[str, Any]:
        modifiers = ("Shift",) if hands.random() < 0.2 else ()
        x, y = hands.random() * size[0], hands.random() * size[1]
        made = {"event_type": kind, "x": x, "y": y, "button": 0, "modifiers": modifiers}
        return made | more

    kind = hands.choice(("drag", "drag", "click", "wheel", "key", "key", "undo", "leave"))
    if kind == "drag":
        button = hands.choice((1, 1, 1, 2, 3))
        moves = [event("pointer_move") for _ in range(hands.randrange(1, 6))]
        return [event("pointer_down", button=button), *moves, event("pointer_up", button=button)]
    if kind == "click":
        at = event("pointer_move")
        press = {**at, "button": 1}
        down = {**press, "event_type": "pointer_down"}
        up = {**press, "event_type": "pointer_up"}
        double = [{**press, "event_type": "double_click"}] if hands.random() < 0.2 else []
        return [at, down, up, *double]
    if kind == "wheel":
        return [event("wheel", dx=0.0, dy=hands.choice((-100.0, 100.0)))]
    if kind == "undo":
        return [event("key_down", key="z", modifiers=("Control",)) for _ in range(3)]
    if kind == "leave":
        return [event("pointer_leave")]
    return [event("key_down", key=hands.choice(_KEYS), modifiers=())]


def _median(values: list[float]) -> float:
    return sorted(values)[len(values) // 2]
