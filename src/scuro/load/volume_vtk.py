"""VTK's image files (.vti, legacy .vtk, .slc) through VTK's own readers, without its rendering."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, MissingExtraError
from scuro.load.volume import affine, choose, finished
from scuro.load.volume_options import VoxelOptions
from scuro.scene.volume import Volume


def read_vtk(path: Path, options: VoxelOptions) -> Volume:
    """Read a regular VTK image: point data, or cell data whose values sit in the cells' middles."""
    reader, messages = _reader(path)
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    if messages:
        raise LoadError(path, f"VTK cannot read it: {messages[0]}")
    if image is None or not image.IsA("vtkImageData"):
        kind = image.GetClassName() if image is not None else "nothing"
        raise LoadError(path, f"holds {kind}; scuro reads regular image data (structured points)")
    name, array, on_cells = _array(path, image, options.array)
    dimensions = np.array(image.GetDimensions())
    if on_cells:
        dimensions = np.maximum(dimensions - 1, 1)
    values = _numpy(array)
    if values.ndim == 2:
        values = choose(path, values, 1, options.channel, "component")
    elif options.channel:
        raise LoadError(path, f"there is no component {options.channel}: '{name}' has only one")
    if len(values) != dimensions.prod():
        raise LoadError(path, f"'{name}' has {len(values)} values for {dimensions.prod()} voxels")
    return finished(
        path, values.reshape(dimensions[::-1]), _matrix(image, on_cells), options=options,
        value_name=name,
    )  # fmt: skip


def _matrix(image: Any, on_cells: bool) -> NDArray[np.float64]:
    direction = image.GetDirectionMatrix()
    axes = np.array([[direction.GetElement(i, j) for j in range(3)] for i in range(3)])
    matrix = affine((1, 1, 1))
    matrix[:3, :3] = axes * np.array(image.GetSpacing())
    first = np.array(image.GetExtent()[::2], float) + (0.5 if on_cells else 0.0)
    matrix[:3, 3] = np.array(image.GetOrigin()) + matrix[:3, :3] @ first
    return matrix


def _array(path: Path, image: Any, wanted: str | None) -> tuple[str, Any, bool]:
    """The array to show: the one asked for, else the active scalars, else the first."""
    found: dict[str, tuple[Any, bool]] = {}
    active = None
    for data, on_cells in ((image.GetPointData(), False), (image.GetCellData(), True)):
        for i in range(data.GetNumberOfArrays()):
            array = data.GetArray(i)
            if array is not None:
                found.setdefault(array.GetName() or f"array {i}", (array, on_cells))
        if active is None and data.GetScalars() is not None:
            active = data.GetScalars().GetName()
    if not found:
        raise LoadError(path, "the image has no arrays of numbers")
    name = wanted or (active if active in found else next(iter(found)))
    if name not in found:
        raise LoadError(path, f"there is no array '{name}': it has {', '.join(sorted(found))}")
    return name, *found[name]


def _reader(path: Path) -> tuple[Any, list[str]]:
    """A reader for the suffix, and the list that its error messages go to."""
    try:
        from vtkmodules.vtkCommonCore import vtkLogger
        from vtkmodules.vtkIOImage import vtkSLCReader
        from vtkmodules.vtkIOLegacy import vtkDataSetReader
        from vtkmodules.vtkIOXML import vtkXMLImageDataReader
    except ImportError:
        raise MissingExtraError("VTK volumes", "volume") from None
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # errors come by observers
    kinds = {".vti": vtkXMLImageDataReader, ".vtk": vtkDataSetReader, ".slc": vtkSLCReader}
    if path.suffix.lower() not in kinds:
        raise LoadError(path, f"VTK files are told by their ending: {', '.join(kinds)}")
    reader = kinds[path.suffix.lower()]()
    messages: list[str] = []

    def note(_object: Any, _event: str, text: str) -> None:
        messages.append(re.sub(r"^\w+ \(0x[0-9a-f]+\):\s*", "", text.strip().splitlines()[-1]))

    note.CallDataType = "string0"  # type: ignore[attr-defined]
    for source in (reader, getattr(reader, "GetXMLParser", lambda: None)()):
        if source is not None:
            source.AddObserver("ErrorEvent", note)  # type: ignore[arg-type]
    return reader, messages


def _numpy(array: Any) -> NDArray:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(array)
