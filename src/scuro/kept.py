"""What is found out about something once, and kept as long as that is."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

V = TypeVar("V")

_MOST = 16
"""Results of one function for one thing."""


def kept_with(function: Callable[..., V]) -> Callable[..., V]:
    """Keep a function's results as long as its first argument lives.

    ``functools.cache`` would keep the argument, too: a file that was closed long ago. Results must
    not refer to it.
    """
    known: WeakKeyDictionary[Any, dict[tuple[Hashable, ...], V]] = WeakKeyDictionary()

    @wraps(function)
    def look_up(thing: Any, *rest: Hashable) -> V:
        found = known.setdefault(thing, {})
        if rest not in found:
            if len(found) >= _MOST:
                del found[next(iter(found))]
            found[rest] = function(thing, *rest)
        return found[rest]

    return look_up
