"""Long work as generators: they yield the share that is done and return what was made.

A window draws on between their steps; cancelling is to forget the generator.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from typing import Any, TypeVar

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


def in_thread(action: Callable[[], T]) -> Generator[float, None, T]:
    """Do what cannot be cut into steps beside whoever takes them; yields 0 until it is done.

    What is forgotten meanwhile comes to its end, but is not heard of.
    """
    results: list[Any] = []

    def run() -> None:
        try:
            results.append((True, action()))
        except BaseException as error:  # handed on to the one who waits
            results.append((False, error))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(0.02)
        yield 0.0
    fine, value = results[0]
    if not fine:
        raise value
    made: T = value
    return made
