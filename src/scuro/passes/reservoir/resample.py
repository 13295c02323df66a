"""A reservoir sampled on a regular grid: for the SRG strategy, and for light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.reservoir.model import ReservoirModel
from scuro.passes.reservoir.pack import AREAL

MOST_TEXELS = 24_000_000
"""Finer grids are made coarser until they fit what every device binds at once."""


MOST_A_CELL = 4
MOST_FLAT = 8
"""Texels at least along the shortest side."""


class Resampled:
    """A regular grid over the model's box: value × inside and inside, as half-floats.

    Args:
        model: With values in place.
        size: Texels along x, y, z.
    """

    def __init__(self, model: ReservoirModel, size: tuple[int, int, int]) -> None:
        self.model = model
        self.size = size
        """(3,) texels along x, y, z."""
        low, high = model.bounds
        self.low, self.voxel = low, (high - low) / self.size
        nx, ny, nz = self.size
        row = -(-nx // 64) * 64
        gpu = model.gpu
        texels = gpu.buffer(4 * row * ny * nz, label="resampled reservoir")
        fields = {
            "low": self.low,
            "row": row,
            "voxel": self.voxel,
            "first": 0,
            "size": self.size,
            "pad": 0,
        }
        gpu.compute(
            "passes/reservoir/resample.wgsl",
            "main",
            self.size,
            model.resources | {"resample": fields, "texels": texels},
        )
        self._row, self._texels = row, texels

    @property
    def bytes(self) -> int:
        """GPU memory of the texture."""
        return 4 * int(np.prod(self.size))

    def texture(self) -> Any:
        """The grid as an rg16float texture."""
        gpu = self.model.gpu
        texture = gpu.texture(self.size, "rg16float", dimension="3d", label="resampled reservoir")
        record = gpu.recorder()
        record.copy_buffer_to_texture(self._texels, texture)
        record.submit()
        return texture

    def read(self) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """Values, 0 to 1 over the property's range, and where the model is; (nz, ny, nx)."""
        nx, ny, nz = self.size
        halves = self.model.gpu.read_buffer(self._texels, np.float16)
        grid = halves[: nz * ny * self._row * 2].reshape(nz, ny, self._row, 2)[:, :, :nx]
        return grid[..., 0].astype(np.float32), grid[..., 1] > 0.5


def cubic_size(model: ReservoirModel, longest: int) -> tuple[int, int, int]:
    """Texels along x, y, z that are as good as cubes: so many along the longest side, or fewer
    where that would be more than :data:`MOST_A_CELL` along a column's side."""
    extent = model.bounds[1] - model.bounds[0]
    column = float(model.mean_extents[:2].min())
    longest = min(longest, int(np.ceil(MOST_A_CELL * extent.max() / column)))
    nx, ny, nz = np.maximum(np.ceil(extent / extent.max() * longest), MOST_FLAT).astype(int)
    return int(nx), int(ny), int(nz)


def resampled_size(model: ReservoirModel, factor: float) -> tuple[int, int, int]:
    """Texels along x, y, z for so many samples per cell, within :data:`MOST_TEXELS`."""
    areal = np.asarray(model.uniform["areal_dims"], float) / AREAL
    size = factor * np.array([*areal, model.grid.dimensions[2]])
    size = size * min(1.0, float(MOST_TEXELS / np.prod(size)) ** (1 / 3))
    nx, ny, nz = np.clip(np.rint(size), 2, 2048).astype(int)
    return int(nx), int(ny), int(nz)
