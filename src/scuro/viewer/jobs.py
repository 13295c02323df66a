"""Work that takes longer than a picture, done a slice at a time, with progress, to be cancelled."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from scuro.errors import ScuroError

T = TypeVar("T")
Work = Generator[float, None, str]
"""Yields the share that is done after each slice; returns a sentence for people."""


@dataclass(eq=False)
class Job:
    """One such work."""

    title: str
    work: Work
    share: float = 0.0


class Jobs:
    """Those of one screen, one after another."""

    def __init__(self) -> None:
        self.waiting: list[Job] = []
        self.message = ""
        """What the last one said when it ended."""
        self.failed = False
        """Whether it could not be done."""

    def add(self, title: str, work: Work) -> None:
        """Begin a work when those before it are done."""
        self.waiting.append(Job(title, work))
        self.message, self.failed = "", False

    def cancel(self, job: Job) -> None:
        """Stop a work; it leaves nothing behind."""
        job.work.close()
        self.waiting.remove(job)
        self.message = f"{job.title}: cancelled"

    def tick(self) -> None:
        """Do one slice."""
        if not self.waiting:
            return
        job = self.waiting[0]
        try:
            job.share = next(job.work)
        except StopIteration as end:
            self.waiting.remove(job)
            self.message = end.value or ""
        except ScuroError as error:
            self.waiting.remove(job)
            said = str(error)
            self.message = said if said.startswith(job.title) else f"{job.title}: {said}"
            self.failed = True

    @property
    def wait(self) -> float | None:
        """Seconds until the next slice; ``None`` if there is nothing to do."""
        return 0.0 if self.waiting else None

    def close(self) -> None:
        """Stop all of them."""
        while self.waiting:
            self.cancel(self.waiting[0])


class _Cancelled(BaseException):
    """Ends the action of :func:`in_turns` where it waits."""


def in_turns(action: Callable[[Callable[[float], None]], T]) -> Generator[float, None, T]:
    """Do a long action a turn at a time though it is no generator; yields the shares it tells.

    Args:
        action: Takes a function that it calls between turns with the share that is done. It has a
            thread of its own, but never runs beside the caller: only one of them has its turn.
    """
    results: list[Any] = []
    told = [0.0]
    its_turn, our_turn = threading.Semaphore(0), threading.Semaphore(0)
    cancelled = threading.Event()

    def pause(share: float) -> None:
        told[0] = share
        our_turn.release()
        its_turn.acquire()
        if cancelled.is_set():
            raise _Cancelled

    def run() -> None:
        try:
            pause(0.0)
            results.append((True, action(pause)))
        except BaseException as error:  # handed on to the one who waits
            results.append((False, error))
        our_turn.release()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    our_turn.acquire()
    try:
        while not results:
            yield told[0]
            its_turn.release()
            our_turn.acquire()
    finally:
        if not results:
            cancelled.set()
            its_turn.release()
        thread.join()
    fine, value = results[0]
    if not fine:
        raise value
    made: T = value
    return made


def scaled(shares: Iterator[float], low: float, high: float) -> Iterator[float]:
    """Shares of a part as shares of the whole."""
    for share in shares:
        yield low + share * (high - low)
