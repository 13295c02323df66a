"""A scalar volume: samples on a regular grid, placed in the world by an affine matrix."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Volume:
    """Scalar samples on a regular grid (compared and cached by identity)."""

    values: NDArray
    """(nz, ny, nx): x fastest, the layout of a GPU's 3-D texture; uint8, int16, uint16, float32."""
    world_from_index: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    """(4, 4), column vectors (x, y, z, 1): integer indices are voxel *centres*."""
    name: str = ""
    unit: str = ""
    """Unit of length of the world, e.g. ``"mm"`` or ``"Å"``; empty where the file does not say."""
    value_name: str = ""
    source: str = ""
    notes: tuple[str, ...] = ()
    """What the reader mended (NaN counted, axes permuted, levels chosen), one sentence each."""

    @cached_property
    def spacing(self) -> NDArray[np.float64]:
        """(3,) edge lengths of a voxel along x, y, z, in world units."""
        return np.linalg.norm(self.world_from_index[:3, :3], axis=0)

    @cached_property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest finite value."""
        if self.values.dtype.kind == "f":
            finite = self.values[np.isfinite(self.values)]
            return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
        return float(self.values.min()), float(self.values.max())

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) world box around the volume, voxels' outer faces included."""
        nz, ny, nx = self.values.shape
        corners = np.array(
            [
                [x, y, z, 1.0]
                for x in (-0.5, nx - 0.5)
                for y in (-0.5, ny - 0.5)
                for z in (-0.5, nz - 0.5)
            ]
        )
        world = (corners @ self.world_from_index.T)[:, :3]
        return np.stack([world.min(axis=0), world.max(axis=0)])
