"""From which empty cells of a grid, and in which directions, nothing lies ahead.

A ray that comes to such a cell ends there instead of walking on to the grid's border. Directions
fall into 24 bins (``direction_bin`` of wgsl/dda.wgsl): the axis of their largest component and the
signs of all three. What a ray of a bin can visit widens by at most one cell sideways, each way,
from one layer across the largest axis to the next, so one sweep over the layers decides each bin
exactly for the worst ray in it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def clear_directions(empty: NDArray[np.bool_]) -> NDArray[np.uint32]:
    """A bit for each bin of directions in which rays from a cell meet only empty cells.

    Args:
        empty: (nz, ny, nx) whether each cell is empty; what is outside counts as empty.

    Returns:
        (nz, ny, nx) bits; none is set where the cell itself is not empty.
    """
    bits = np.zeros(empty.shape, np.uint32)
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        # layers across the axis, and in each the later coordinate first, as in `empty`
        layers = np.moveaxis(empty, 2 - axis, 0)
        result = np.moveaxis(bits, 2 - axis, 0)
        for sign in (0, 1):
            for way in range(4):
                flips = (sign, way >> 1, way & 1)
                view = tuple(slice(None, None, -1 if flip else 1) for flip in flips)
                shifts = (sign << axis) + (flips[2] << others[0]) + (flips[1] << others[1])
                clear = _sweep(layers[view])
                result[view] |= clear.astype(np.uint32) << np.uint32(8 * axis + shifts)
    return bits


def _sweep(layers: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The bin of directions along +0, no more along +1 and +2: (n, a, b) as ``layers``."""
    clear = np.array(layers)
    ahead = np.ones(layers.shape[1:], bool)
    for layer in clear[::-1]:
        # a ray may cross to the next cell sideways within a layer, and again on entering it
        layer &= ahead
        layer[:-1] &= layer[1:].copy()
        layer[:, :-1] &= layer[:, 1:].copy()
        ahead = layer
    return clear
