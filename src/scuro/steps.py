"""Long work as generators: they yield the share that is done and return what was made.

A window draws on between their steps; cancelling is to forget the generator.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeVar

T = TypeVar("T")


def finished(steps: Generator[float, None, T]) -> T:
    """Do all steps at once; what was made."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            made: T = end.value
            return made


def scaled(steps: Generator[float, None, T], low: float, high: float) -> Generator[float, None, T]:
    """Shares of a part as shares of the whole."""
    while True:
        try:
            share = next(steps)
        except StopIteration as end:
            made: T = end.value
            return made
        yield low + share * (high - low)
