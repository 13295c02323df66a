"""Numbers out of columns of characters, vectorised."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray


def strip(values: NDArray[np.bytes_]) -> NDArray[np.bytes_]:
    """Without surrounding blanks."""
    codes = np.ascontiguousarray(values).view(np.uint8)
    if not (codes == 32).any():
        return values
    distinct, inverse = np.unique(values, return_inverse=True)
    return np.char.strip(distinct)[inverse.ravel()]


def fixed_floats(
    columns: NDArray[np.bytes_],
    bad: Callable[[int], Exception] | None = None,
    default: float = 0.0,
) -> NDArray[np.float64]:
    """Numbers of a fixed-width column.

    Args:
        columns: (n,) text.
        bad: Makes the error for the first element that is not a finite number; without it such
            elements get ``default``.
        default: See ``bad``.
    """
    try:
        values = columns.astype(np.float64)
        if np.isfinite(values).all():
            return values
    except ValueError:
        values = None
    # something is wrong: look only at the distinct texts to find which
    distinct, inverse = np.unique(columns, return_inverse=True)
    numbers = np.array([_number(text) for text in distinct.tolist()], np.float64)
    values = numbers[inverse.ravel()]
    wrong = ~np.isfinite(values)
    if bad is not None and wrong.any():
        raise bad(int(np.argmax(wrong)))
    values[wrong] = default
    return values


def _number(text: bytes) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")


def fixed_integers(
    columns: NDArray[np.bytes_], hybrid: bool = False
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Whole numbers of a fixed-width column.

    Args:
        columns: (n,) text.
        hybrid: Whether letters continue the count (hybrid-36: ``A0000`` follows ``99999``).

    Returns:
        The numbers (0 where unreadable) and a mask of the unreadable ones.
    """
    try:
        return columns.astype(np.int64), np.zeros(len(columns), bool)
    except (ValueError, OverflowError):
        pass
    plain = _plain_integers(columns)
    rest = np.flatnonzero(plain < 0)
    values = plain.copy()
    bad = np.zeros(len(columns), bool)
    distinct, inverse = np.unique(columns[rest], return_inverse=True)
    read = [_integer(text, columns.dtype.itemsize, hybrid) for text in distinct.tolist()]
    numbers = np.array([0 if v is None else v for v in read], np.int64)
    unread = np.array([v is None for v in read], bool)
    values[rest] = numbers[inverse.ravel()]
    bad[rest] = unread[inverse.ravel()]
    return values, bad


def _plain_integers(columns: NDArray[np.bytes_]) -> NDArray[np.int64]:
    """Unsigned right-aligned decimal numbers; -1 where a text is anything else."""
    codes = np.ascontiguousarray(columns).view(np.uint8).reshape(len(columns), -1)
    value = np.zeros(len(columns), np.int64)
    started = np.zeros(len(columns), bool)
    good = np.ones(len(columns), bool)
    for column in codes.T:
        digit = (column >= 48) & (column <= 57)
        value = np.where(digit, value * 10 + column - 48, value)
        good &= digit | ((column == 32) & ~started)
        started |= digit
    return np.where(good & started, value, -1)


def _integer(text: bytes, width: int, hybrid: bool) -> int | None:
    try:
        return int(text)
    except ValueError:
        return _hybrid_36(text, width) if hybrid else None


def _hybrid_36(text: bytes, width: int) -> int | None:
    """Decode hybrid-36 (Grosse-Kunstleve): decimal, then base 36 from ``A…``, then from ``a…``."""
    if len(text) != width or not text.isalnum() or not text[:1].isalpha():
        return None
    if not (text == text.upper() or text == text.lower()):
        return None
    base = int(text, 36) - 10 * 36 ** (width - 1) + 10**width
    return base if text == text.upper() else base + 26 * 36 ** (width - 1)
