"""Which cells of a corner-point grid touch which: split faces, gaps, collapsed cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.cornerpoint import CornerPointGrid

SPLIT_TOLERANCE = 0.1
"""Corners further apart than this (in the grid's unit of length) are not shared: a fault."""

THIN = 1e-3
"""Cells nowhere thicker than this have collapsed."""


@dataclass(frozen=True)
class CellCounts:
    """Peculiar cells and faces of a grid."""

    split: int
    """Faces along i and j whose corners differ from their neighbour's."""
    collapsed: int
    inverted: int


def count_cells(grid: CornerPointGrid, tolerance: float = SPLIT_TOLERANCE) -> CellCounts:
    """Count split faces of all cells, and collapsed and inverted active cells."""
    thick = thickness(grid)
    thickest = thick.max(axis=(2, 4))
    thinnest = thick.min(axis=(2, 4))
    return CellCounts(
        int(np.count_nonzero(split_faces(grid, "i", tolerance)))
        + int(np.count_nonzero(split_faces(grid, "j", tolerance))),
        int(np.count_nonzero((thickest < THIN) & (thinnest > -THIN) & grid.active)),
        int(np.count_nonzero((thinnest < -THIN) & grid.active)),
    )


def thickness(grid: CornerPointGrid) -> NDArray[np.float32]:
    """(nk, nj, 2, ni, 2): bottom minus top depth at each cell's four pillars."""
    return grid.zcorn[:, 1] - grid.zcorn[:, 0]


def split_faces(
    grid: CornerPointGrid, axis: str, tolerance: float = SPLIT_TOLERANCE
) -> NDArray[np.bool_]:
    """Whether the face between cell n and n + 1 along an axis is split: any corner differs.

    Returns:
        (nk, nj, ni - 1) for axis ``i``, (nk, nj - 1, ni) for ``j``, (nk - 1, nj, ni) for ``k``.
    """
    z = grid.zcorn
    nk, nj, ni = grid.active.shape
    ends = {"i": (nk, nj, ni - 1), "j": (nk, nj - 1, ni), "k": (nk - 1, nj, ni)}[axis]
    split = np.zeros(ends, bool)
    # layer by layer: what is worked on stays in the processor's caches
    for k in range(ends[0]):
        for a, b in np.ndindex(2, 2):
            if axis == "i":
                apart = z[k, a, :, b, :-1, 1] - z[k, a, :, b, 1:, 0]
            elif axis == "j":
                apart = z[k, a, :-1, 1, :, b] - z[k, a, 1:, 0, :, b]
            else:
                apart = z[k, 1, :, a, :, b] - z[k + 1, 0, :, a, :, b]
            split[k] |= np.abs(apart) > tolerance
    return split


def vertex_values(
    grid: CornerPointGrid, values: NDArray, tolerance: float = SPLIT_TOLERANCE
) -> NDArray[np.float32]:
    """Carry cell values to corners: the mean over active cells that share the vertex.

    A vertex is shared by neighbours whose corners on the same pillar agree within ``tolerance``, so
    nothing bleeds across a fault or a gap. Values that are not finite do not count.

    Args:
        grid: The grid.
        values: (n_active,).
        tolerance: In the grid's unit of length.

    Returns:
        (nk, 2, nj, 2, ni, 2), NaN at corners of inactive cells.
    """
    nk, nj, ni = grid.active.shape
    cell = np.zeros(grid.active.shape, np.float32)
    cell[grid.active] = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    counts = np.zeros(grid.active.shape, np.float32)
    counts[grid.active] = np.isfinite(values)
    z = np.pad(grid.zcorn, [(1, 1), (0, 0)] * 3, mode="edge")
    cell = np.pad(cell * counts, 1)
    counts = np.pad(counts, 1)
    result = np.full(grid.zcorn.shape, np.nan, np.float32)
    for dk, dj, di in np.ndindex(2, 2, 2):
        own = grid.zcorn[:, dk, :, dj, :, di]
        total = np.zeros((nk, nj, ni), np.float32)
        weight = np.zeros((nk, nj, ni), np.float32)
        for sk, sj, si in np.ndindex(2, 2, 2):
            # the neighbour on the other side along the axes chosen, and its corner that faces ours
            at = tuple(
                slice(1 + s * (2 * d - 1), 1 + s * (2 * d - 1) + n)
                for s, d, n in ((sk, dk, nk), (sj, dj, nj), (si, di, ni))
            )
            facing = z[at[0], dk ^ sk, at[1], dj ^ sj, at[2], di ^ si]
            shared = (np.abs(facing - own) <= tolerance) & (counts[at] > 0)
            total += np.where(shared, cell[at], 0)
            weight += shared
        mean = np.divide(total, weight, out=np.full_like(total, np.nan), where=weight > 0)
        result[:, dk, :, dj, :, di] = np.where(grid.active, mean, np.nan)
    return result
