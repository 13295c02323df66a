"""Readers of volume files, as the table of :mod:`scuro.load` names them."""

from __future__ import annotations

import gzip
import shutil
import tempfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from pathlib import Path

from scuro.errors import LoadError
from scuro.load.options import LoadOptions
from scuro.load.source import Source
from scuro.load.volume_options import VoxelOptions
from scuro.load.volume_zarr import MARKS
from scuro.scene.volume import Volume


def read_itk(source: Source, options: LoadOptions) -> Volume:
    """NIfTI, NRRD, MetaImage, single DICOM files."""
    # ITK unpacks gzip too, but takes a truncated file for one that ends in zeros
    return _read(source, options, "volume_itk:read_image")


def read_vtk(source: Source, options: LoadOptions) -> Volume:
    """VTK images: .vti, legacy .vtk, .slc."""
    return _read(source, options, "volume_vtk:read_vtk")


def read_mrc(source: Source, options: LoadOptions) -> Volume:
    """MRC and CCP4 maps."""
    return _read(source, options, "volume_maps:read_mrc", unpacks=True)


def read_cube(source: Source, options: LoadOptions) -> Volume:
    """Gaussian cube files."""
    return _read(source, options, "volume_maps:read_cube", unpacks=True)


def read_dx(source: Source, options: LoadOptions) -> Volume:
    """OpenDX grids."""
    return _read(source, options, "volume_maps:read_dx", unpacks=True)


def read_tiff(source: Source, options: LoadOptions) -> Volume:
    """Multi-page TIFF."""
    return _read(source, options, "volume_arrays:read_tiff")


def read_numpy(source: Source, options: LoadOptions) -> Volume:
    """NumPy arrays."""
    return _read(source, options, "volume_arrays:read_numpy")


def read_raw(source: Source, options: LoadOptions) -> Volume:
    """Raw samples."""
    return _read(source, options, "volume_arrays:read_raw", unpacks=True)


def read_folder(source: Source, options: LoadOptions) -> Volume:
    """A Zarr directory, else a folder of DICOM files."""
    assert source.path is not None
    zarr = any((source.path / mark).exists() for mark in MARKS)
    place = "volume_zarr:read_zarr" if zarr else "volume_itk:read_dicom_folder"
    return _read(source, options, place, unpacks=True)


def _read(source: Source, options: LoadOptions, place: str, *, unpacks: bool = False) -> Volume:
    """Call a reader with a plain file; name the source as the user did.

    Args:
        source: What to read.
        options: All options; readers get those of volumes.
        place: Module and function.
        unpacks: Whether the reader takes a gzipped file as it is.
    """
    module, function = place.split(":")
    read: Callable[[Path, VoxelOptions], Volume] = getattr(
        import_module(f"scuro.load.{module}"), function
    )
    with _plain_file(source, unpacks) as path:
        try:
            volume = read(path, options.voxels)
        except LoadError as error:
            raise LoadError(source.name, error.why, error.line) from None
    return replace(volume, name=source.stem, source=source.name)


@contextmanager
def _plain_file(source: Source, unpacks: bool) -> Iterator[Path]:
    """The source's path, or that of an unpacked copy that lasts as long as the reading."""
    path = source.path
    if path is not None and (unpacks or path.suffix != ".gz"):
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / (path.stem if path is not None else "stdin")
        try:
            if path is None:
                copy.write_bytes(source.data)
            else:
                with gzip.open(path) as packed, copy.open("wb") as target:
                    shutil.copyfileobj(packed, target)
        except (OSError, EOFError, zlib.error) as error:
            raise LoadError(source.name, f"cannot be unpacked: {error}") from None
        yield copy
