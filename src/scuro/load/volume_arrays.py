"""Plain arrays: raw samples, NumPy files, TIFF stacks."""

from __future__ import annotations

import gzip
import re
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, MissingExtraError
from scuro.load.volume import affine, choose, finished
from scuro.load.volume_options import VoxelOptions
from scuro.scene.volume import Volume

RAW_NAME = re.compile(
    r"(\d+)[x_](\d+)[x_](\d+)[_.-]?(uint8|uint16|int8|int16|int32|float32|float64|u8|u16|i8|i16|f32|f64)?",
    re.IGNORECASE,
)
"""Size and type in a file's name, as open data sets are usually named: skull_256x256x256_uint8."""

SHORT_TYPES = {"u8": "u1", "u16": "u2", "u32": "u4", "i8": "i1", "i16": "i2", "i32": "i4",
               "f16": "f2", "f32": "f4", "f64": "f8"}  # fmt: skip


def sample_type(text: str) -> np.dtype:
    """The type named by ``u8``, ``int16``, ``>f4`` …; a leading ``>`` means big-endian.

    Raises:
        ValueError: no such type of number.
    """
    order, word = ("", text)
    if text[:1] in "<>":
        order, word = text[0], text[1:]
    try:
        found = np.dtype(order + np.dtype(SHORT_TYPES.get(word.lower(), word.lower())).str[1:])
    except TypeError:
        found = None
    if found is None or found.kind not in "uif":
        raise ValueError(f"unknown type of samples '{text}': use u8, u16, i16, f32, >i2, …")
    return found


def read_raw(path: Path, options: VoxelOptions) -> Volume:
    """Read raw samples, x fastest; size and type from the options, else from the file's name."""
    size, dtype, notes = options.size, options.type, []
    named = RAW_NAME.search(path.name)
    if size is None and named:
        size = (int(named[1]), int(named[2]), int(named[3]))
        notes.append(f"size {size[0]}x{size[1]}x{size[2]} taken from the file's name")
    if dtype is None and named and named[4]:
        dtype = named[4]
        notes.append(f"type {dtype} taken from the file's name")
    if size is None or dtype is None:
        raise LoadError(
            path,
            "tells neither size nor type: give both, as --voxels-size 256x256x133 --voxels-type u8",
        )
    try:
        kind = sample_type(dtype)
    except ValueError as error:
        raise LoadError(path, str(error)) from None
    count = int(np.prod(size, dtype=np.int64))
    data: NDArray
    if path.suffix == ".gz":
        try:
            data = np.frombuffer(gzip.decompress(path.read_bytes())[options.header :], np.uint8)
        except (OSError, EOFError, zlib.error) as error:
            raise LoadError(path, f"cannot be unpacked: {error}") from None
    else:
        data = (
            np.memmap(path, np.uint8, "r")[options.header :]
            if path.stat().st_size
            else np.empty(0, np.uint8)
        )
    wanted = count * kind.itemsize
    if len(data) != wanted:
        shown = "x".join(map(str, size))
        raise LoadError(
            path,
            f"has {len(data):,} bytes, but {shown} voxels of {kind.name} need {wanted:,}: "
            "the size or type is wrong or the file is truncated",
        )
    values = data.view(kind).reshape(size[::-1])
    return finished(path, values, options=options, notes=notes)


def read_numpy(path: Path, options: VoxelOptions) -> Volume:
    """Read ``.npy`` or one array of ``.npz``, indexed (z, y, x); a fourth axis in front is time."""
    notes: list[str] = []
    try:
        if path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as file:
                name = _npz_array(path, file, options.array)
                values = file[name]
        else:
            name, values = "", np.load(path, allow_pickle=False, mmap_mode="r")
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise LoadError(path, f"is not a readable NumPy file: {error}") from None
    if values.ndim == 4:
        values = choose(path, values, 0, options.time, "time step")
        notes.append("the first of four axes is taken as time")
    return finished(path, values, options=options, notes=notes, value_name=name)


def _npz_array(path: Path, file: Any, wanted: str | None) -> str:
    if wanted is not None:
        if wanted not in file:
            raise LoadError(path, f"there is no array '{wanted}': it has {', '.join(file.files)}")
        return wanted
    for name in file.files:
        if file[name].ndim >= 3:
            return name
    raise LoadError(path, "holds no array with three axes")


def read_tiff(path: Path, options: VoxelOptions) -> Volume:
    """Read a multi-page TIFF (plain, ImageJ or OME); time and channel chosen by index."""
    try:
        import tifffile
    except ImportError:
        raise MissingExtraError("TIFF volumes", "volume") from None
    try:
        with tifffile.TiffFile(path) as file:
            series = file.series[0]
            axes, values = series.axes, series.asarray()
            spacing, unit = _tiff_spacing(file)
    except Exception as error:  # tifffile raises many kinds, also its codecs' own
        raise LoadError(path, f"is not a readable TIFF stack: {error}") from None
    for letter, index, what in (
        ("T", options.time, "time step"),
        ("C", options.channel, "channel"),
        ("S", options.channel, "sample"),
    ):
        if letter in axes:
            place = axes.index(letter)
            values = choose(path, values, place, index, what)
            axes = axes.replace(letter, "")
    return finished(path, values, affine(spacing), options=options, unit=unit)


def _tiff_spacing(file: Any) -> tuple[tuple[float, float, float], str]:
    """Spacing along x, y, z from OME-XML, or from ImageJ's and the page's resolution."""
    if file.ome_metadata:
        sizes = dict(re.findall(r'PhysicalSize([XYZ])="([^"]+)"', file.ome_metadata))
        if sizes:
            x = float(sizes.get("X", 1.0))
            return (x, float(sizes.get("Y", x)), float(sizes.get("Z", x))), "µm"
    ij = file.imagej_metadata or {}
    page = file.pages[0]
    steps = []
    for tag in ("XResolution", "YResolution"):
        value = page.tags[tag].value if tag in page.tags else (1, 1)
        steps.append(value[1] / value[0] if value[0] else 1.0)
    if "spacing" not in ij:  # dots per inch of a plain picture say nothing of voxels
        return (1.0, 1.0, 1.0), ""
    return (steps[0], steps[1], float(ij["spacing"])), str(ij.get("unit", ""))
