"""Distances, angles and dihedrals between places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Measure:
    """A measure and the places it is of."""

    kind: str
    """``distance``, ``angle`` or ``dihedral``."""
    text: str
    points: NDArray[np.float64]
    """(2 to 4, 3) world positions in order."""


def distance(a: ArrayLike, b: ArrayLike) -> float:
    """Between two points, in their unit."""
    return float(np.linalg.norm(np.subtract(b, a)))


def angle(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> float:
    """At ``b`` between the ways to ``a`` and ``c``, degrees, 0 to 180."""
    u, v = np.subtract(a, b), np.subtract(c, b)
    return math.degrees(math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v)))


def dihedral(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> float:
    """About b-c, degrees, -180 to 180; positive clockwise seen along it (IUPAC)."""
    before, axis, after = np.subtract(b, a), np.subtract(c, b), np.subtract(d, c)
    first, second = np.cross(before, axis), np.cross(axis, after)
    y = float(np.linalg.norm(axis) * (before @ second))
    return math.degrees(math.atan2(y, float(first @ second)))


def measures(points: Sequence[ArrayLike], unit: str = "Å") -> list[Measure]:
    """What the last two, three or four of the points say: a distance, an angle, a dihedral.

    Args:
        points: (3,) each, in the order they were picked.
        unit: Of length.
    """
    used = [np.asarray(p, np.float64) for p in points[-4:]]
    if len(used) == 2:
        return [Measure("distance", f"{distance(*used):.2f} {unit}".strip(), np.array(used))]
    if len(used) == 3:
        return [Measure("angle", f"{angle(*used):.1f}°", np.array(used))]
    if len(used) == 4:
        turn = f"{dihedral(*used):.1f}°".replace("-", "−")
        return [Measure("dihedral", turn, np.array(used))]
    return []
