"""Benchmarks: ``scuro bench NAME`` runs ``scuro.measure.bench.NAME``.

A benchmark is one module here; it is found by its name. Its docstring's first line is its help, and
it defines ``run(options: BenchOptions) -> dict[str, Any]``, whose result is the JSON report; rows
for the table people read are under ``"rows"``, a list of flat dictionaries with equal keys.
"""

from __future__ import annotations

import math
import pkgutil
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from scuro.errors import SettingsError
from scuro.settings import unknown

if TYPE_CHECKING:
    from scuro.render_settings import Settings


@dataclass(frozen=True)
class BenchOptions:
    """What every benchmark is told."""

    inputs: tuple[str, ...] = ()
    """Files, PDB IDs or samples to measure on; each benchmark has its own by default."""
    size: tuple[int, int] = (1280, 720)
    frames: int = 5
    device: str | None = None
    say: Callable[[str], None] = lambda text: None
    """Tells people what is measured just now."""
    measured: Path | None = None
    """JSON of earlier runs to go on from, where a benchmark keeps one."""

    def plain(self) -> Settings:
        """Direct light alone, at the size asked for: what single techniques are added to."""
        from scuro.render_settings import Settings

        return Settings(size=self.size).replace(lighting__preset="studio", antialias__method="none")


def label(name: str) -> str:
    """What tables call an input: a file without its folder, which is another on each machine."""
    return name if name.startswith("sample:") else Path(name).name


def names() -> list[str]:
    """Every benchmark."""
    return [module.name for module in pkgutil.iter_modules(__path__)]


def check(name: str) -> None:
    """Raise :class:`SettingsError` if there is no such benchmark."""
    if name not in names():
        raise SettingsError(unknown("benchmark", name, names()))


def median_seconds(action: Callable[[], object], count: int, *, long: float = math.inf) -> float:
    """Median time of ``count`` runs of ``action``, after one that warms up.

    Where that takes more than ``long`` seconds, a single run is timed.
    """
    start = time.perf_counter()
    action()
    if time.perf_counter() - start > long:
        count = 1
    times = []
    for _ in range(count):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return statistics.median(times)
