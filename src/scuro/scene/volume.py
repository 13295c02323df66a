"""A scalar volume: samples on a regular grid, placed in the world by an affine matrix."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

DARK_SKEWNESS = -0.3
"""Skewness of small blocks' means below which a map's matter is taken to be its dark part."""


@dataclass(frozen=True, eq=False)
class Volume:
    """Scalar samples on a regular grid (compared and cached by identity)."""

    values: NDArray
    """(nz, ny, nx): x fastest, the layout of a GPU's 3-D texture; uint8, int16, uint16, float32.
    All finite: readers replace NaN and infinities by the lowest value and say so in ``notes``."""
    world_from_index: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    """(4, 4), column vectors (x, y, z, 1): integer indices are voxel *centres*."""
    name: str = ""
    unit: str = ""
    """Unit of length of the world, e.g. ``"mm"`` or ``"Å"``; empty where the file does not say."""
    value_name: str = ""
    source: str = ""
    notes: tuple[str, ...] = ()
    """What the reader mended (NaN counted, axes permuted, levels chosen), one sentence each."""
    anatomical: bool = False
    """Whether the world is a patient's: x to the right, y anterior, z superior (RAS)."""
    labels: bool = False
    """Whether the values are names of classes, between which nothing may be interpolated."""
    contour: float | None = None
    """Where the surface is drawn by habit, if the file tells it."""

    @cached_property
    def spacing(self) -> NDArray[np.float64]:
        """(3,) edge lengths of a voxel along x, y, z, in world units."""
        return np.linalg.norm(self.world_from_index[:3, :3], axis=0)

    @cached_property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return float(self.values.min()), float(self.values.max())

    @cached_property
    def histogram(self) -> NDArray[np.int64]:
        """(256,) voxels in equal bins over :attr:`value_range`."""
        return np.histogram(self.values, bins=256, range=_open_range(*self.value_range))[0]

    @cached_property
    def dark_matter(self) -> bool:
        """Whether a density map's matter is darker than what surrounds it, as in tomograms.

        Means of 3³ voxels then have a tail of low values; single voxels are mostly noise.
        """
        kept = tuple(slice(0, n // 3 * 3) for n in self.values.shape)
        values = self.values[kept].astype(np.float32)
        if self.value_name != "density" or not values.size:
            return False
        z, y, x = values.shape
        means = values.reshape(z // 3, 3, y // 3, 3, x // 3, 3).mean(axis=(1, 3, 5))
        means = means.clip(*np.quantile(means, (0.001, 0.999)))  # gold markers are no matter
        means -= means.mean()
        spread = float(means.std())
        return spread > 0 and float((means**3).mean()) < DARK_SKEWNESS * spread**3

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

    def summary(self) -> dict[str, object]:
        """What ``scuro info`` prints: dimensions, spacing, range, a coarse histogram, notes."""
        nz, ny, nx = self.values.shape
        coarse = self.histogram.reshape(16, 16).sum(axis=1)
        return {
            "dimensions": [nx, ny, nz],
            "type": self.values.dtype.name,
            "spacing": [round(float(s), 6) for s in self.spacing],
            "unit": self.unit,
            "bounds": np.round(self.bounds, 4).tolist(),
            "range": list(self.value_range),
            "mean": float(self.values.mean(dtype=np.float64)),
            "labels": self.labels,
            "histogram": coarse.tolist(),
            "notes": list(self.notes),
        }


def _open_range(low: float, high: float) -> tuple[float, float]:
    """A range that ``numpy.histogram`` takes, also for a constant volume."""
    return (low, high) if high > low else (low - 0.5, high + 0.5)
