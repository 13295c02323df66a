"""Pairs of close points, by a grid of cells and sorting; no loop over points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MAX_CELLS = 1 << 60


def close_pairs(
    points: NDArray[np.float32], loose: NDArray[np.bool_], reach: float
) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    """Pairs of points closer than ``reach`` of which at least one is ``loose``.

    Args:
        points: (n, 3).
        loose: (n,) mask.
        reach: Distance, in the points' unit.

    Returns:
        (k, 2) indices, each pair once, and (k,) squared distances.
    """
    cell = np.floor((points - points.min(axis=0)) / reach).astype(np.int64) + 1
    size = cell.max(axis=0) + 2
    if float(np.prod(size.astype(np.float64))) > MAX_CELLS:
        return np.zeros((0, 2), np.intp), np.zeros(0, np.float32)
    key = (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
    order = np.argsort(key, kind="stable")
    sorted_key = key[order]
    mine = np.flatnonzero(loose)
    found, squares = [], []
    for offset in np.ndindex(3, 3, 3):
        dx, dy, dz = (o - 1 for o in offset)
        wanted = key[mine] + (dx * size[1] + dy) * size[2] + dz
        first = np.searchsorted(sorted_key, wanted, side="left")
        count = np.searchsorted(sorted_key, wanted, side="right") - first
        a = np.repeat(mine, count)
        # 0, 1, … count-1 for each point, laid end to end
        within = np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)
        b = order[np.repeat(first, count) + within]
        gap = points[a] - points[b]
        squared = np.einsum("ij,ij->i", gap, gap)
        # a pair of two loose points is met from both sides: keep one
        keep = (squared < reach * reach) & ((a < b) | ~loose[b])
        found.append(np.stack([a[keep], b[keep]], 1))
        squares.append(squared[keep])
    return np.concatenate(found), np.concatenate(squares)
