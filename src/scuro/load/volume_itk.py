"""Medical and general image volumes through SimpleITK: NIfTI, NRRD, MetaImage, DICOM series."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, MissingExtraError
from scuro.load.volume import choose, finished
from scuro.load.volume_options import VoxelOptions
from scuro.scene.volume import Volume

RAS_FROM_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])
"""ITK's world is left-posterior-superior; scuro shows patients right-anterior-superior."""


def read_image(path: Path, options: VoxelOptions) -> Volume:
    """Read NIfTI, NRRD/NHDR, MetaImage or a single DICOM file, with orientation and time step."""
    sitk = _sitk()
    reader = sitk.ImageFileReader()
    reader.SetFileName(str(path))
    try:
        reader.ReadImageInformation()
    except RuntimeError as error:
        raise LoadError(path, _reason(error)) from None
    size = list(reader.GetSize())
    if len(size) > 3:
        _choose_step(path, reader, size, options.time)
    elif options.time:
        raise LoadError(path, f"there is no time step {options.time}: the file has only one")
    return _volume(path, reader, options)


def read_dicom_folder(path: Path, options: VoxelOptions) -> Volume:
    """Read the DICOM series of a folder; several series are listed, and one has to be chosen."""
    sitk = _sitk()
    series = list(sitk.ImageSeriesReader.GetGDCMSeriesIDs(str(path)))
    if not series:
        raise LoadError(
            path, "is a folder, and holds neither a DICOM series nor a Zarr image; name a file"
        )
    if options.series is not None:
        chosen = [uid for uid in series if uid.endswith(options.series)]
        if len(chosen) != 1:
            raise LoadError(
                path, f"no one series ends in '{options.series}'; {_listed(sitk, path, series)}"
            )
        series = chosen
    if len(series) > 1:
        raise LoadError(path, f"choose one with --voxels-series; {_listed(sitk, path, series)}")
    names = sitk.ImageSeriesReader.GetGDCMSeriesFileNames(str(path), series[0])
    reader = sitk.ImageSeriesReader()
    reader.SetFileNames(names)
    return _volume(path, reader, options)


def _volume(path: Path, reader: Any, options: VoxelOptions) -> Volume:
    sitk = _sitk()
    try:
        image = reader.Execute()
    except RuntimeError as error:
        raise LoadError(path, _reason(error)) from None
    values: NDArray = sitk.GetArrayFromImage(image)
    dimensions = image.GetDimension()
    if image.GetNumberOfComponentsPerPixel() > 1:
        values = choose(path, values, values.ndim - 1, options.channel, "channel")
    elif options.channel:
        raise LoadError(path, f"there is no channel {options.channel}: the file has only one")
    matrix = np.eye(4)
    spacing = np.array(image.GetSpacing())
    direction = np.array(image.GetDirection()).reshape(dimensions, dimensions)
    n = min(dimensions, 3)
    matrix[:n, :n] = direction[:n, :n] * spacing[:n]
    matrix[:n, 3] = image.GetOrigin()[:n]
    suffixes = [s.lower() for s in path.suffixes]
    # an NRRD file need not say how it lies in a patient; the other formats always do
    nrrd = bool({".nrrd", ".nhdr"} & set(suffixes))
    anatomical = not nrrd or "NRRD_space" in reader.GetMetaDataKeys()
    if anatomical:
        matrix = RAS_FROM_LPS @ matrix
    return finished(
        path,
        values,
        matrix,
        options=options,
        unit="mm" if anatomical else "",
        anatomical=anatomical,
    )


def _choose_step(path: Path, reader: Any, size: list[int], time: int) -> None:
    """Have the reader extract one three-dimensional step of a series over time."""
    if time >= size[3]:
        raise LoadError(path, f"there is no time step {time}: the file has {size[3]}, from 0")
    reader.SetExtractIndex([0, 0, 0, time] + [0] * (len(size) - 4))
    reader.SetExtractSize(size[:3] + [0] * (len(size) - 3))


def _listed(sitk: Any, path: Path, series: list[str]) -> str:
    """The folder's series, one clause each: end of the UID, modality, description, slices."""
    clauses = []
    for uid in series:
        names = sitk.ImageSeriesReader.GetGDCMSeriesFileNames(str(path), uid)
        reader = sitk.ImageFileReader()
        reader.SetFileName(names[0])
        reader.ReadImageInformation()
        words = [
            reader.GetMetaData(key).strip()
            for key in ("0008|0060", "0008|103e")
            if reader.HasMetaDataKey(key)
        ]
        clauses.append(f"{uid} ({' '.join([*words, f'{len(names)} slices'])})")
    return f"the folder has {len(series)} series: " + "; ".join(clauses)


def _sitk() -> Any:
    try:
        import SimpleITK
    except ImportError:
        raise MissingExtraError("NIfTI, NRRD, MetaImage and DICOM volumes", "volume") from None
    SimpleITK.ProcessObject.SetGlobalWarningDisplay(False)
    return SimpleITK


def _reason(error: Exception) -> str:
    """The one useful line of ITK's message, without its source files and addresses."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    told = [re.sub(r"^.*?\(0x[0-9a-f]+\):\s*", "", line) for line in lines[1:]] or lines
    useful = [t for t in told if t and not t.startswith(("/", "in ", "Exception"))]
    text = (useful or told)[-1].rstrip(".")
    return f"cannot be read: {text}; the file may be truncated or not what its name says"
