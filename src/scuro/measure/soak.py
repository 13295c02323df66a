"""Random hands on a viewer for as long as one likes: nothing may grow or stand still."""

from __future__ import annotations

import gc
import os
import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from scuro.export.scene_file import SceneFile
from scuro.viewer.screen import Screen

_KEYS = (*"xyzfiobncvpw,. ", "Delete", "Escape", "Tab", "ArrowUp", "ArrowLeft", "PageDown")
_ROUND = 4.0
"""Seconds after which all is put back as it was, and memory is measured: what the hands have set
(a finer picture, a larger atlas) may take memory, but not keep it."""
_WARM_UP = 0.3
"""Share of the time after which caches are full and growth is counted."""


@dataclass
class Soaked:
    """What came of it."""

    events: int = 0
    pictures: int = 0
    longest: float = 0.0
    """Seconds the window stood still at most."""
    memory: list[float] = field(default_factory=list)
    """Resident MB after each round."""

    @property
    def growth(self) -> float:
        """Growth of memory after the warm-up, as a share: the median of the last tenth of the
        time in relation to that of the tenth after the warm-up."""
        count = len(self.memory)
        tenth = max(1, count // 10)
        first = int(count * _WARM_UP)
        return _median(self.memory[-tenth:]) / _median(self.memory[first : first + tenth]) - 1


def resident_mb() -> float:
    """Memory of this process that is in RAM, in MB."""
    import psutil

    return float(psutil.Process(os.getpid()).memory_info().rss / (1 << 20))


def soak(
    screen: Screen,
    seconds: float,
    seed: int = 0,
    clock: Callable[[], float] = time.perf_counter,
) -> Soaked:
    """Drag, scroll, click and press keys at random, drawing between.

    Args:
        screen: Already of some size.
        seconds: For how long.
        seed: Of the hands.
        clock: Seconds, for tests.
    """
    hands, result = random.Random(seed), Soaked()
    target = screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    document = screen.model.document
    end = clock() + seconds
    again = clock() + _ROUND
    while (now := clock()) < end:
        if now >= again:
            again = now + _ROUND
            _put_back(screen, document, target)
            result.memory.append(resident_mb())
        for event in _gesture(hands, screen.logical):
            screen.handle(event)
            result.events += 1
            _draw(screen, target, result, clock)
        for _ in range(hands.randrange(6)):
            if screen.wait is None:
                break
            _draw(screen, target, result, clock)
    _put_back(screen, document, target)
    result.memory.append(resident_mb())
    return result


def _put_back(screen: Screen, document: SceneFile, target: Any) -> None:
    """As it was at first, drawn to the end."""
    screen.handle({"event_type": "key_down", "key": "Escape", "modifiers": ()})
    screen.model.player.stop()
    screen.view.spinning = False
    screen.panel.jobs.close()
    screen.model.open(document)
    screen.view.camera = screen.view.initial_camera()
    screen.view.stir()
    screen.panel.open = True
    # a text field that was clicked has its cursor blink for ever: that is no reason to go on
    while screen.wait == 0.0 or not screen.view.complete:
        screen.draw(target)
        screen.gpu.finish()
    gc.collect()


def _draw(screen: Screen, target: Any, result: Soaked, clock: Callable[[], float]) -> None:
    start = clock()
    screen.draw(target)
    screen.gpu.finish()
    result.longest = max(result.longest, clock() - start)
    result.pictures += 1


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
