"""Which reader reads a volume file: the table of suffixes, and the one way in."""

from __future__ import annotations

import gzip
import shutil
import tempfile
import zlib
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from scuro.errors import LoadError
from scuro.load.volume import VolumeOptions
from scuro.load.volume_zarr import MARKS
from scuro.scene.volume import Volume

READERS = {
    ".nii": "volume_itk:read_image",
    ".nrrd": "volume_itk:read_image",
    ".nhdr": "volume_itk:read_image",
    ".mha": "volume_itk:read_image",
    ".mhd": "volume_itk:read_image",
    ".dcm": "volume_itk:read_image",
    ".vti": "volume_vtk:read_vtk",
    ".vtk": "volume_vtk:read_vtk",
    ".slc": "volume_vtk:read_vtk",
    ".mrc": "volume_maps:read_mrc",
    ".map": "volume_maps:read_mrc",
    ".ccp4": "volume_maps:read_mrc",
    ".cube": "volume_maps:read_cube",
    ".cub": "volume_maps:read_cube",
    ".dx": "volume_maps:read_dx",
    ".tif": "volume_arrays:read_tiff",
    ".tiff": "volume_arrays:read_tiff",
    ".npy": "volume_arrays:read_numpy",
    ".npz": "volume_arrays:read_numpy",
    ".raw": "volume_arrays:read_raw",
    ".zarr": "volume_zarr:read_zarr",
}
"""File suffix, before any ``.gz``, to the module and function that reads it."""

UNPACKS_ITSELF = {".nii", ".mrc", ".map", ".ccp4", ".cube", ".cub", ".dx", ".raw"}
"""Formats whose reader takes a gzipped file as it is."""


def read_volume(path: str | Path, options: VolumeOptions | None = None) -> Volume:
    """Read a scalar volume from a file, a DICOM folder or a Zarr directory.

    Raises:
        LoadError: missing, damaged, of unknown format, or something has to be chosen.
        MissingExtraError: the format's library is not installed.
    """
    path = Path(path)
    options = options or VolumeOptions()
    if not path.exists():
        raise LoadError(path, "there is no such file")
    if path.is_dir():
        zarr = any((path / mark).exists() for mark in MARKS)
        return _reader("volume_zarr:read_zarr" if zarr else "volume_itk:read_dicom_folder")(
            path, options
        )
    suffixes = [s.lower() for s in path.suffixes]
    packed = suffixes[-1:] == [".gz"]
    suffix = suffixes[-2 if packed else -1] if len(suffixes) > packed else ""
    if suffix not in READERS:
        known = " ".join(sorted(READERS))
        raise LoadError(path, f"'{suffix or path.name}' is no volume format; known: {known}")
    reader = _reader(READERS[suffix])
    if not packed or suffix in UNPACKS_ITSELF:
        return reader(path, options)
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        try:
            with gzip.open(path) as source, plain.open("wb") as target:
                shutil.copyfileobj(source, target)
        except (OSError, EOFError, zlib.error) as error:
            raise LoadError(path, f"cannot be unpacked: {error}") from None
        return reader(plain, options)


def _reader(place: str) -> Callable[[Path, VolumeOptions], Volume]:
    module, function = place.split(":")
    reader: Callable[[Path, VolumeOptions], Volume] = getattr(
        import_module(f"scuro.load.{module}"), function
    )
    return reader
