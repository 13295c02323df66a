"""Volumes larger than a texture or memory: read by slabs and averaged in blocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAX_SIDE = 2048
"""Largest side of a 3-D texture on any WebGPU device."""

MAX_VOXELS = 512 * 512 * 1024
"""Default limit of voxels kept: 0.5 GB as half-floats."""

SLAB_BYTES = 64 << 20
"""Roughly how much of the source is held at a time."""


def reduction(shape: Sequence[int], max_voxels: int) -> tuple[int, int, int]:
    """Block size (z, y, x) that brings a shape (nz, ny, nx) within the limits.

    The axis with most voxels left is halved, thirded, … first, so that voxels stay near cubes of
    their first shape.
    """
    factors = [1, 1, 1]

    def sides() -> list[int]:
        return [-(-n // f) for n, f in zip(shape, factors, strict=True)]

    while max(sides()) > MAX_SIDE or np.prod(sides(), dtype=np.float64) > max_voxels:
        factors[int(np.argmax(sides()))] += 1
    return factors[0], factors[1], factors[2]


def reduce_blocks(values: Any, factors: Sequence[int]) -> NDArray:
    """Means over blocks, reading the source a slab of planes at a time.

    Args:
        values: (nz, ny, nx) array, memory map or lazily read array; sliced along z only.
        factors: Block size (z, y, x); blocks at the far faces may be partial.

    Returns:
        float32, or the source's type rounded for integers; NaN in a block are left out of its mean.
    """
    fz, fy, fx = factors
    nz, ny, nx = values.shape
    out_shape = (-(-nz // fz), -(-ny // fy), -(-nx // fx))
    dtype = np.dtype(values.dtype)
    out = np.empty(out_shape, np.float32 if dtype.kind == "f" else dtype)
    planes = max(1, SLAB_BYTES // max(1, ny * nx * dtype.itemsize * fz))
    for start in range(0, out_shape[0], planes):
        stop = min(start + planes, out_shape[0])
        slab = np.asarray(values[start * fz : min(stop * fz, nz)])
        out[start:stop] = _block_means(slab, fz, fy, fx, out.dtype)
    return out


def _block_means(slab: NDArray, fz: int, fy: int, fx: int, dtype: np.dtype) -> NDArray:
    valid = np.isfinite(slab) if slab.dtype.kind == "f" else np.ones((1, 1, 1), bool)
    total = np.where(valid, slab, 0).astype(np.float64)
    count = np.broadcast_to(valid, slab.shape).astype(np.float64)
    for axis, factor in enumerate((fz, fy, fx)):
        starts = np.arange(0, slab.shape[axis], factor)
        total = np.add.reduceat(total, starts, axis=axis)
        count = np.add.reduceat(count, starts, axis=axis)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / count
    return (np.rint(mean) if dtype.kind in "ui" else mean).astype(dtype)
