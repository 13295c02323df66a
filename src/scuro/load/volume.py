"""Scalar volumes: from any reader's array to a :class:`Volume` (dtype, NaN, axes, spacing)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.volume_blocks import reduce_blocks, reduction
from scuro.load.volume_options import VoxelOptions, check_spacing
from scuro.scene.volume import Volume

GPU_TYPES = ("uint8", "int16", "uint16", "float32")
"""Types that :attr:`Volume.values` may have."""

MOST_LABELS = 64
"""Integer volumes with at most so many distinct values may be label maps."""

TOMOGRAM_SMOOTHING = 1.5
"""Deviation in voxels of the Gaussian that tomograms are seen through: single voxels are noise."""


def finished(
    path: str | Path,
    values: NDArray,
    world_from_index: NDArray | None = None,
    *,
    options: VoxelOptions,
    notes: Sequence[str] = (),
    **fields: Any,
) -> Volume:
    """A :class:`Volume` of a reader's array: blocks averaged if too large, type, NaN, spacing.

    Args:
        path: The file, for messages and for the volume's name.
        values: (nz, ny, nx), any real type; may be a memory map or other lazily read array.
        world_from_index: (4, 4); identity if None.
        options: What the user said.
        notes: What the reader has to tell.
        fields: Further fields of :class:`Volume`.

    Raises:
        LoadError: not three-dimensional, empty, complex, no finite value, or bad spacing.
    """
    told = list(notes)
    values = _three_dimensional(path, values)
    matrix = np.eye(4) if world_from_index is None else np.array(world_from_index, np.float64)
    if options.spacing is not None:
        matrix = _with_spacing(matrix, options.spacing)
    if not np.isfinite(matrix).all():
        raise LoadError(path, "the position or orientation of the volume is not finite")
    check_spacing(np.linalg.norm(matrix[:3, :3], axis=0), lambda why: LoadError(path, why))
    if abs(np.linalg.det(matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0))) < 1e-6:
        raise LoadError(path, "the volume's axes lie in one plane; its orientation is damaged")

    factors = reduction(values.shape, options.limit)
    if factors != (1, 1, 1):
        told.append(_reduction_note(values.shape, factors, options.limit))
        values = reduce_blocks(values, factors)
        fz, fy, fx = factors
        # a block's centre lies (factor - 1) / 2 voxels from its first voxel's
        shift = np.eye(4)
        shift[:3, :3] = np.diag([fx, fy, fz])
        shift[:3, 3] = (fx - 1) / 2, (fy - 1) / 2, (fz - 1) / 2
        matrix = matrix @ shift
    values, lost = canonical(path, np.asarray(values))
    told.extend(lost)
    if values.min() == values.max():
        told.append(f"all voxels have the same value, {values.flat[0]:g}: there is nothing to see")
    fields.setdefault("labels", looks_like_labels(values))
    name = fields.pop("name", "") or Path(path).name.split(".")[0]
    volume = Volume(values, matrix, name=name, source=str(path), notes=tuple(told), **fields)
    deviation = options.smooth
    if deviation is None and volume.dark_matter:
        deviation = TOMOGRAM_SMOOTHING
    return _smoothed(volume, deviation) if deviation else volume


def _smoothed(volume: Volume, deviation: float) -> Volume:
    """The volume after a Gaussian of a deviation in voxels; labels are never mixed."""
    if volume.labels:
        return volume
    from scipy import ndimage

    values = ndimage.gaussian_filter(volume.values, deviation, output=np.float32, mode="nearest")
    note = f"smoothed by a Gaussian of {deviation:g} voxels; --voxels-smooth 0 keeps the noise"
    return replace(volume, values=values, notes=(*volume.notes, note))


def canonical(path: str | Path, values: NDArray) -> tuple[NDArray, list[str]]:
    """Values in one of :data:`GPU_TYPES`, contiguous and finite, and notes of what was changed.

    Integers keep an integer type that holds their range, if there is one; NaN and infinities
    become the lowest finite value, which transfer functions show as empty.
    """
    kind = values.dtype.kind
    if kind == "c":
        raise LoadError(path, "the voxels are complex numbers; save their modulus instead")
    if kind not in "buif":
        raise LoadError(path, f"the voxels have type {values.dtype}, which is not a number")
    if kind == "b":
        values = values.astype(np.uint8)
    if kind in "ui" and values.dtype.name not in GPU_TYPES:
        low, high = int(values.min()), int(values.max())
        for name in ("uint8", "int16", "uint16"):
            if np.iinfo(name).min <= low and high <= np.iinfo(name).max:
                return np.ascontiguousarray(values, dtype=name), []
    if values.dtype.kind in "ui" and values.dtype.name in GPU_TYPES:
        return np.ascontiguousarray(values, values.dtype.newbyteorder("=")), []
    with np.errstate(over="ignore"):  # float64 beyond float32's range becomes inf: counted below
        values = np.ascontiguousarray(values, dtype=np.float32)
    finite = np.isfinite(values)
    missing = values.size - int(np.count_nonzero(finite))
    if missing == 0:
        return values, []
    if missing == values.size:
        raise LoadError(path, "no voxel has a finite value")
    lowest = values[finite].min()
    values = np.where(finite, values, lowest).astype(np.float32)
    share = 100 * missing / values.size
    return values, [
        f"{missing:,} voxels ({share:.2g} %) are NaN or infinite: taken as empty ({lowest:g})"
    ]


def looks_like_labels(values: NDArray) -> bool:
    """Whether integer values are few, small and separate enough to be classes, not intensities.

    Classes come in slabs: neighbouring voxels are mostly equal, and where they differ, they differ
    by any amount; intensities with few grey levels still change by one or two at a time.
    """
    if values.dtype.kind not in "ui" or values.max() >= 4096 or values.min() < -1:
        return False
    found: set[int] = set()
    changes = steps = 0
    for plane in values:  # plane by plane: whole volumes may be large
        found.update(np.unique(plane).tolist())
        if len(found) > MOST_LABELS:
            return False
        changes += int(np.count_nonzero(plane[:, 1:] != plane[:, :-1]))
        steps += plane[:, 1:].size
    return len(found) > 2 and changes < 0.2 * steps


def choose(path: str | Path, values: Any, axis: int, index: int, what: str) -> Any:
    """One step along a time or channel axis of an array.

    Raises:
        LoadError: there are not so many.
    """
    count = values.shape[axis]
    if index >= count:
        raise LoadError(path, f"there is no {what} {index}: the file has {count}, counted from 0")
    return values[(slice(None),) * axis + (index,)]


def affine(spacing: Sequence[float], origin: Sequence[float] = (0, 0, 0)) -> NDArray[np.float64]:
    """(4, 4) world-from-index matrix of axis-aligned voxels."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.diag(np.asarray(spacing, np.float64))
    matrix[:3, 3] = origin
    return matrix


def _three_dimensional(path: str | Path, values: NDArray) -> NDArray:
    if values.ndim == 2:
        values = values[None]
    if values.ndim != 3:
        shape = "x".join(map(str, values.shape))
        raise LoadError(path, f"a volume has three axes, but the array is {shape}")
    if 0 in values.shape:
        raise LoadError(path, "the volume has no voxels")
    return values


def _with_spacing(matrix: NDArray, spacing: Sequence[float]) -> NDArray:
    """``matrix`` with its columns scaled to new edge lengths, directions and origin kept."""
    scaled = matrix.copy()
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    for axis, (length, wanted) in enumerate(zip(lengths, spacing, strict=True)):
        column = matrix[:3, axis] / length if length > 0 else np.eye(3)[axis]
        scaled[:3, axis] = column * wanted
    return scaled


def _reduction_note(shape: Sequence[int], factors: Sequence[int], limit: int) -> str:
    size = "x".join(map(str, shape[::-1]))
    blocks = "x".join(map(str, factors[::-1]))
    return (
        f"{size} voxels are more than the limit ({limit:,} voxels, 2048 a side): "
        f"read as means of {blocks} blocks"
    )
