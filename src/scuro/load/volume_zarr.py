"""Zarr arrays and OME-Zarr images: the finest level that fits, read by slabs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from scuro.errors import LoadError, MissingExtraError
from scuro.load.volume import affine, finished
from scuro.load.volume_blocks import MAX_SIDE
from scuro.load.volume_options import VoxelOptions
from scuro.scene.volume import Volume

MARKS = ("zarr.json", ".zarray", ".zgroup")
"""A directory with one of these files is a Zarr array or group."""

SPACE = "zyx"


def read_zarr(path: Path, options: VoxelOptions) -> Volume:
    """Read a Zarr array, or the finest level of an OME-Zarr image that fits the voxel limit."""
    try:
        import zarr
    except ImportError:
        raise MissingExtraError("Zarr volumes", "volume") from None
    try:
        node: Any = zarr.open(str(path), mode="r")
        if isinstance(node, zarr.Array):
            return _read(path, node, _default_axes(node.ndim), np.eye(4), "", [], options)
        attributes: dict[str, Any] = dict(node.attrs)
        ome = attributes.get("ome", attributes)
        if options.array is None and "multiscales" in ome:
            return _read_ome(path, node, ome["multiscales"][0], options)
        name = options.array or next(
            (key for key, array in sorted(node.arrays()) if array.ndim >= 3), None
        )
        if name is None or name not in node:
            known = ", ".join(key for key, _ in sorted(node.arrays()))
            raise LoadError(path, f"holds no such array of three axes; it has: {known or 'none'}")
        array = node[name]
        return _read(path, array, _default_axes(array.ndim), np.eye(4), "", [], options)
    except LoadError:
        raise
    except Exception as error:  # codecs, stores and metadata each raise their own kinds
        text = " ".join(str(error).split()) or type(error).__name__
        raise LoadError(path, f"cannot be read as Zarr: {text}") from None


def _read_ome(path: Path, group: Any, image: Mapping, options: VoxelOptions) -> Volume:
    axes = [axis if isinstance(axis, str) else axis["name"] for axis in image.get("axes", "tczyx")]
    units = [axis.get("unit", "") for axis in image.get("axes", []) if isinstance(axis, Mapping)]
    unit = {"micrometer": "µm", "nanometer": "nm", "millimeter": "mm", "angstrom": "Å"}.get(
        units[-1] if units else "", units[-1] if units else ""
    )
    levels, notes = image["datasets"], []

    def fits(level: Mapping) -> bool:
        shape = group[level["path"]].shape
        sides = [n for n, name in zip(shape, axes, strict=True) if name in SPACE]
        return bool(np.prod(sides, dtype=np.float64) <= options.limit) and max(sides) <= MAX_SIDE

    chosen = next((i for i, level in enumerate(levels) if fits(level)), len(levels) - 1)
    if chosen:
        notes.append(f"level {chosen} of {len(levels)} read; finer ones exceed the voxel limit")
    scale, shift = np.ones(len(axes)), np.zeros(len(axes))
    for step in (
        *levels[chosen].get("coordinateTransformations", ()),
        *image.get("coordinateTransformations", ()),
    ):
        if step["type"] == "scale":
            scale, shift = scale * step["scale"], shift * step["scale"]
        elif step["type"] == "translation":
            shift = shift + step["translation"]
    place = {name: i for i, name in enumerate(axes)}
    spacing = [scale[place[a]] if a in place else 1.0 for a in reversed(SPACE)]
    origin = [shift[place[a]] if a in place else 0.0 for a in reversed(SPACE)]
    array = group[levels[chosen]["path"]]
    return _read(path, array, axes, affine(spacing, origin), unit, notes, options)


def _read(
    path: Path, array: Any, axes: list[str], matrix: Any, unit: str, notes: list[str],
    options: VoxelOptions,
) -> Volume:  # fmt: skip
    index: list[int | slice] = []
    for name, count in zip(axes, array.shape, strict=True):
        if name in SPACE:
            index.append(slice(None))
            continue
        wanted = options.time if name == "t" else options.channel
        if wanted >= count:
            raise LoadError(path, f"there is no {name} {wanted}: the array has {count}, from 0")
        index.append(wanted)
    order = [name for name in axes if name in SPACE]
    if order != [name for name in SPACE if name in order]:
        raise LoadError(path, f"its spatial axes are ordered {order}, not z, y, x")
    lazy = _Planes(array, tuple(index))
    small = np.prod(lazy.shape, dtype=np.float64) <= options.limit
    values: Any = lazy[:] if small and max(lazy.shape) <= MAX_SIDE else lazy
    return finished(path, values, matrix, options=options, unit=unit, notes=notes)


class _Planes:
    """A (nz, ny, nx) view of an array with chosen time and channel, read only when sliced."""

    def __init__(self, array: Any, index: tuple[int | slice, ...]) -> None:
        self.array, self.index = array, index
        self.dtype = array.dtype
        kept = [n for n, i in zip(array.shape, index, strict=True) if isinstance(i, slice)]
        self.shape = tuple(kept)
        self.ndim = len(kept)

    def __getitem__(self, planes: slice) -> Any:
        spatial = [i for i, part in enumerate(self.index) if isinstance(part, slice)]
        index = list(self.index)
        index[spatial[0]] = planes
        return self.array[tuple(index)]


def _default_axes(ndim: int) -> list[str]:
    """Names of the axes of an array that does not name them: OME's order, from the end."""
    return list("tczyx"[-ndim:]) if ndim != 4 else list("tzyx")
