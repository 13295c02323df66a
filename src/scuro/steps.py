"""Long work as generators: they yield the share that is done and return what was made.

A window draws on between their steps; cancelling is to forget the generator.
"""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Generator
from typing import Any, Generic, TypeVar

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


class _Work(Generic[T]):
    """Steps that have more than one taker."""

    def __init__(self, key: Any, steps: Generator[float, None, T]) -> None:
        self.key = key
        self._steps = steps
        self._share = 0.0
        self.made: list[T] = []
        self.fault: Exception | None = None
        self.left = False
        """Whether a taker was cancelled within a step, which ends the generator."""

    @property
    def ended(self) -> bool:
        return bool(self.made) or self.left or self.fault is not None

    def taken(self) -> Generator[float, None, None]:
        while not self.ended:
            if not self._steps.gi_running:  # type: ignore[attr-defined]
                try:
                    self._share = next(self._steps)
                except StopIteration as end:
                    self.made.append(end.value)
                    return
                except Exception as fault:
                    self.fault = fault
                    return
                except BaseException:
                    self.left = True
                    raise
            # else another taker gave way within a step
            yield self._share


class Sharing(Generic[T]):
    """Work that several want at the same time is done once: whoever has a turn takes a step.

    It is forgotten with the last who takes them.
    """

    def __init__(self) -> None:
        self._work: Callable[[], _Work[T] | None] = lambda: None

    def steps(
        self, key: Any, begin: Callable[[], Generator[float, None, T]]
    ) -> Generator[float, None, T]:
        """Those of the work of that key, which somebody may have begun."""
        while True:
            work = self._work()
            if work is None or work.ended or work.key != key:
                work = _Work(key, begin())
                self._work = weakref.ref(work)
            yield from work.taken()
            if work.fault is not None:
                raise work.fault
            if work.made:
                return work.made[0]
