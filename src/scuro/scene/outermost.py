"""Of many spheres, those that can be the outermost in some direction."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

_FEW = 20_000
"""So many are kept as they are."""
_ACROSS = 128
"""Columns along the longest side of the box."""


def outermost(spheres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of (n, 4) centres and radii that some plane may touch first, coming from outside.

    Cameras, boxes and depths of all the spheres are theirs, exactly: a direction leans most along
    one axis, and in its column along that axis a sphere that lies deeper below the highest than
    the column's width and the difference in radii make up for cannot be met first.
    """
    if len(spheres) <= _FEW:
        return spheres
    centers, radii = spheres[:, :3], spheres[:, 3]
    low = centers.min(axis=0)
    width = max(float((centers.max(axis=0) - low).max()), 1e-9) / _ACROSS
    deepest = 2.001 * width + math.sqrt(3) * float(radii.max() - radii.min())
    cells = ((centers - low) / width).astype(np.int32)
    kept = np.zeros(len(spheres), bool)
    for axis in range(3):
        column = cells[:, axis - 2] * (_ACROSS + 1) + cells[:, axis - 1]
        for heights in (centers[:, axis], -centers[:, axis]):
            highest = np.full((_ACROSS + 1) ** 2, -np.inf)
            np.maximum.at(highest, column, heights)
            kept |= heights >= highest[column] - deepest
    return spheres[kept]
