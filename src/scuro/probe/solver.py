"""Where the probe goes when the hand wants it elsewhere: sliding contact without tunnelling.

A probe of radius R among atoms of radii r is a point among spheres of radii r + R, whose union's
surface is the solvent-accessible surface. It follows the unconstrained point like the god-object of
haptics (Zilles and Salisbury 1995): straight until it meets a sphere (found exactly, whatever the
speed), then along the part of the way that leads into none of the spheres it touches, until nothing
is gained.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.errors import SettingsError
from scuro.probe.contact import SLACK, move, sort_spheres

_MOST_CELLS = 1 << 24


@dataclass(frozen=True, eq=False)
class Grid:
    """Spheres listed in every cell that they touch."""

    centers: NDArray[np.float64]
    """(n, 3)"""
    radii: NDArray[np.float64]
    """(n,)"""
    low: NDArray[np.float64]
    """(3,) lowest corner."""
    cell: float
    """Edge of a cell."""
    shape: NDArray[np.int64]
    """(3,) cells along x, y, z."""
    starts: NDArray[np.int64]
    """(cells + 1,) where each cell's list begins in ``items``; z is fastest."""
    items: NDArray[np.int32]


def is_compiled() -> bool:
    """Whether the inner loops can run at once."""
    return bool(move.signatures)


def compile_loops() -> None:
    """Compile the inner loops, or read what was compiled before: seconds the first time ever."""
    if not is_compiled():
        Constraint(np.zeros((1, 3)), np.ones(1), 1.0).moved((4, 0, 0), (0, 0, 0))


def build_grid(centers: NDArray, radii: NDArray) -> Grid:
    """Sort spheres (n, 3) and (n,) into cells about as large as the median sphere's radius."""
    centers = np.ascontiguousarray(centers, np.float64).reshape(-1, 3)
    radii = np.ascontiguousarray(radii, np.float64)
    if len(radii) == 0:
        one = np.ones(3, np.int64)
        return Grid(
            centers, radii, np.zeros(3), 1.0, one, np.zeros(2, np.int64), np.zeros(0, np.int32)
        )
    low = (centers - radii[:, None]).min(axis=0) - 1e-3
    size = (centers + radii[:, None]).max(axis=0) + 1e-3 - low
    cell = max(float(np.median(radii)), float(np.cbrt(np.prod(size) / _MOST_CELLS)), 1e-6)
    shape = np.maximum(np.ceil(size / cell), 1).astype(np.int64)
    starts, items = sort_spheres(centers, radii, low, cell, shape)
    return Grid(centers, radii, low, cell, shape, starts, items)


class Constraint:
    """Atoms that keep a probe's centre out.

    Args:
        centers: (n, 3) atoms' centres, Å.
        radii: (n,) their radii.
        probe: Radius of the probe.
    """

    def __init__(self, centers: NDArray, radii: NDArray, probe: float) -> None:
        if len(centers) != len(radii):
            raise SettingsError(f"{len(centers)} atoms have {len(radii)} radii")
        self.probe = probe
        self.grid: Grid = build_grid(centers, np.asarray(radii, np.float64) + probe)
        g = self.grid
        self._table = (g.centers, g.radii, g.low, g.cell, g.shape, g.starts, g.items)

    def moved(self, position: ArrayLike, target: ArrayLike) -> NDArray[np.float64]:
        """(3,) the probe's centre after moving from a free place toward a target."""
        start = np.array(position, np.float64)
        goal = np.array(target, np.float64)
        if not np.isfinite(goal).all():
            return start
        return move(start, goal, *self._table)

    def depth(self, point: ArrayLike) -> float:
        """How deep a probe there would be inside the atom it enters most; 0 or less if free."""
        g = self.grid
        if not len(g.radii):
            return -math.inf
        away = np.linalg.norm(g.centers - np.asarray(point, np.float64), axis=1)
        return float(np.max(g.radii - away))

    def met(self, origin: ArrayLike, way: ArrayLike) -> NDArray[np.float64] | None:
        """(3,) free place just before a ray enters the accessible surface; ``None`` if it misses.

        Args:
            origin: (3,) where the ray begins.
            way: (3,) its direction.
        """
        g = self.grid
        start, direction = np.asarray(origin, np.float64), np.asarray(way, np.float64)
        direction = direction / np.linalg.norm(direction)
        relative = g.centers - start
        along = relative @ direction
        off = (relative * relative).sum(axis=1) - along**2
        radii = g.radii + 2 * SLACK
        hit = (off < radii**2) & (along > 0)
        if not hit.any():
            return None
        enter = along[hit] - np.sqrt(radii[hit] ** 2 - off[hit])
        place: NDArray[np.float64] = start + (enter.min() - SLACK) * direction
        return place if enter.min() > 0 and self.depth(place) < 0 else None

    def freed(self, point: ArrayLike) -> NDArray[np.float64]:
        """(3,) a free place near ``point``: the point itself, or one outside on the way out.

        Goes along the line from the middle of the atoms through the point until it is free.
        """
        place = np.array(point, np.float64)
        g = self.grid
        if not len(g.radii) or self.depth(place) < -SLACK:
            return place
        outward = place - g.centers.mean(axis=0)
        length = float(np.linalg.norm(outward))
        outward = outward / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
        relative = g.centers - place
        along = relative @ outward
        off = (relative * relative).sum(axis=1) - along**2
        inside = off < (g.radii + 2 * SLACK) ** 2
        reach = np.sqrt(np.maximum((g.radii[inside] + 2 * SLACK) ** 2 - off[inside], 0))
        enter, leave = along[inside] - reach, along[inside] + reach
        free = 0.0
        for index in np.argsort(enter):
            if enter[index] > free:
                break
            free = max(free, leave[index])
        return place + (free + SLACK) * outward
