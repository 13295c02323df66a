"""Where a reservoir shows: what cameras are fitted to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.reservoir import ReservoirItem
from scuro.style.reservoir import item_transfer
from scuro.style.reservoir_bodies import layers_mask

LEAST_OPACITY = 0.01
"""Of a cell, for it to count as seen."""


def seen_cells(item: ReservoirItem) -> NDArray[np.bool_] | None:
    """(nk, nj, ni) which cells are seen; all active ones if none is, ``None`` for an isosurface,
    which is bounded by its own triangles.

    Raises:
        SettingsError: A property, step or slice does not exist.
    """
    grid = item.grid
    if item.show == "iso":
        return None
    shown = item.chosen()
    if item.show == "volume":
        values = item.values()
        shown = shown & (item_transfer(item).opacity(np.nan_to_num(values)) > LEAST_OPACITY)
        shown &= np.isfinite(values)
    seen = np.zeros(grid.active.shape, bool)
    seen[grid.active] = shown
    if item.show == "slices":
        seen &= layers_mask(item)
    return seen if seen.any() else grid.active
