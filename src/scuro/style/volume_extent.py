"""Where a volume shows: what cameras are fitted to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

_MOST_SAMPLES = 2_000_000
"""Voxels that are looked at; of larger volumes every second, third … along each axis."""
_LEAST_OPACITY = 0.02
"""Of a voxel, for it to count as seen."""


def visible_corners(
    volume: Volume, transfer: TransferFunction, iso: float | None = None
) -> NDArray[np.float64]:
    """(8, 3) world corners of the box of voxels that are seen, or of the whole volume if none is.

    Args:
        volume: The samples.
        transfer: What makes values opaque.
        iso: The surface's value, which then decides instead.
    """
    step = max(1, int(np.ceil((volume.values.size / _MOST_SAMPLES) ** (1 / 3))))
    sampled = volume.values[::step, ::step, ::step]
    seen = sampled >= iso if iso is not None else transfer.opacity(sampled) > _LEAST_OPACITY
    last = np.array(volume.values.shape[::-1]) - 1
    low, high = np.zeros(3), last.astype(float)
    if seen.any():
        for axis in range(3):  # x, y, z
            line = np.flatnonzero(seen.any(axis=tuple(a for a in range(3) if a != 2 - axis)))
            low[axis] = max(0, (line[0] - 1) * step)
            high[axis] = min(last[axis], (line[-1] + 1) * step)
    box = np.stack([low - 0.5, high + 0.5])
    corners = np.stack(np.meshgrid(*box.T, indexing="ij"), -1).reshape(-1, 3)
    return corners @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]
