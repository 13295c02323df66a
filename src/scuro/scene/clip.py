"""Clipping: the kept region is the intersection of half-spaces, hence convex."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError

MAX_PLANES = 32


@dataclass(frozen=True)
class Plane:
    """Keeps the side to which ``normal`` points: points x with normal · (x - point) >= 0."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (*self.point, *self.normal))):
            raise SettingsError("a clipping plane has numbers that are not finite")
        if not any(self.normal):
            raise SettingsError("a clipping plane needs a normal that is not zero")

    def equation(self) -> NDArray[np.float64]:
        """(4,) unit normal and offset: n · x + offset >= 0 is kept."""
        n = np.asarray(self.normal, np.float64)
        n /= np.linalg.norm(n)
        return np.append(n, -n @ np.asarray(self.point, np.float64))


@dataclass(frozen=True)
class Clip:
    """A set of planes, in world units; what lies outside any of them is gone, for every ray."""

    planes: tuple[Plane, ...] = ()

    def __post_init__(self) -> None:
        if len(self.planes) > MAX_PLANES:
            raise SettingsError(f"at most {MAX_PLANES} clipping planes, not {len(self.planes)}")

    def equations(self) -> NDArray[np.float64]:
        """(k, 4) plane equations, see :meth:`Plane.equation`."""
        return np.array([p.equation() for p in self.planes], np.float64).reshape(-1, 4)
