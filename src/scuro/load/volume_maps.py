"""Density and potential maps: MRC/CCP4, Gaussian cube, OpenDX. World in ångström."""

from __future__ import annotations

import gzip
import warnings
from pathlib import Path
from typing import Any

import gemmi
import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.volume import affine, finished
from scuro.load.volume_options import VoxelOptions
from scuro.scene.volume import Volume

ANGSTROM_FROM_BOHR = 0.529177210903
CRYSTAL_CONTOUR = 1.5
"""Deviations over the mean at which crystallographers look at maps of space groups but P1."""


def read_mrc(path: Path, options: VoxelOptions) -> Volume:
    """Read an MRC or CCP4 map: axes permuted to x, y, z, cell angles, start and origin honoured."""
    header, data = _mrc(path)
    if data.ndim == 4:
        if options.time >= len(data):
            raise LoadError(path, f"there is no volume {options.time}: the stack has {len(data)}")
        data = data[options.time]
    columns = [int(header.mapc), int(header.mapr), int(header.maps)]
    notes = []
    if sorted(columns) != [1, 2, 3]:
        notes.append(f"the header's axis order {columns} is impossible: taken as x, y, z")
        columns = [1, 2, 3]
    # data is (section, row, column); axis k of the result (z, y, x) is the one that maps to it
    stored = {axis: 2 - place for place, axis in enumerate(columns)}
    data = data.transpose(stored[3], stored[2], stored[1])
    if columns != [1, 2, 3]:
        notes.append(f"axes permuted from the file's order {columns}")
    start_of = dict(
        zip(columns, (int(header.nxstart), int(header.nystart), int(header.nzstart)), strict=True)
    )
    start = np.array([start_of[1], start_of[2], start_of[3]], float)
    matrix = _cell_matrix(path, header, data.shape[::-1], notes)
    origin = np.array([header.origin.x, header.origin.y, header.origin.z], float)
    # MRC2014 files of electron microscopy place the map by its origin, crystallography by start
    if np.isfinite(origin).all() and np.any(origin):
        matrix[:3, 3] = origin
    else:
        matrix[:3, 3] = matrix[:3, :3] @ start
    contour = None
    if int(header.ispg) > 1 and float(header.rms) > 0:
        contour = float(header.dmean) + CRYSTAL_CONTOUR * float(header.rms)
    return finished(
        path, data, matrix, options=options, notes=notes, unit="Å", value_name="density",
        labels=False, contour=contour,
    )  # fmt: skip


def _mrc(path: Path) -> tuple[Any, NDArray]:
    import mrcfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with mrcfile.open(path, permissive=True) as file:
                if file.data is None:
                    raise LoadError(path, "the map has no data; the file is truncated")
                header, data, size = file.header.copy(), file.data, file.data.size
        except (ValueError, OSError, EOFError) as error:
            raise LoadError(path, f"is not a readable MRC/CCP4 map: {error}") from None
    if size != int(header.nx) * int(header.ny) * int(header.nz):
        raise LoadError(path, "has fewer voxels than its header says; the file is truncated")
    return header, data


def _cell_matrix(
    path: Path, header: Any, size: tuple[int, ...], notes: list[str]
) -> NDArray[np.float64]:
    """Edges of one voxel from the unit cell and its sampling, as columns."""
    lengths = [float(header.cella.x), float(header.cella.y), float(header.cella.z)]
    angles = [float(header.cellb.alpha), float(header.cellb.beta), float(header.cellb.gamma)]
    sampling = [int(header.mx), int(header.my), int(header.mz)]
    if min(sampling) <= 0:
        sampling = list(size)
    if not all(0 < a < 180 for a in angles):
        angles = [90.0, 90.0, 90.0]
    if min(lengths) <= 0:
        notes.append("the header gives no cell: voxels taken as 1 Å cubes")
        return affine((1, 1, 1))
    cell = gemmi.UnitCell(*lengths, *angles)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(cell.orth.mat.tolist()) / np.array(sampling)
    return matrix


def read_cube(path: Path, options: VoxelOptions) -> Volume:
    """Read a Gaussian cube file (bohr, or ångström where voxel counts are negative)."""
    opener = gzip.open if path.suffix == ".gz" else open
    try:
        with opener(path, "rt", encoding="utf-8", errors="replace") as file:
            title = file.readline().strip()
            file.readline()
            rows = [file.readline().split() for _ in range(4)]
            atoms = int(rows[0][0])
            origin = np.array(rows[0][1:4], float)
            counts = np.array([int(row[0]) for row in rows[1:]])
            axes = np.array([row[1:4] for row in rows[1:]], float)
            for _ in range(abs(atoms)):
                file.readline()
            orbitals = 1
            if atoms < 0:
                words = file.readline().split()
                orbitals = int(words[0])
                while len(words) < orbitals + 1:
                    words += file.readline().split()
            values = np.fromstring(file.read(), np.float64, sep=" ")
    except (ValueError, IndexError, EOFError, OSError) as error:
        raise LoadError(path, f"is not a readable Gaussian cube file: {error}") from None
    size = np.abs(counts)
    if 0 in size:
        raise LoadError(path, "the cube has an axis without voxels")
    if len(values) != size.prod() * orbitals:
        raise LoadError(
            path, f"has {len(values):,} values for {size.prod() * orbitals:,}: it is truncated"
        )
    if options.channel >= orbitals:
        raise LoadError(path, f"there is no orbital {options.channel}: the file has {orbitals}")
    values = values.reshape(*size, orbitals)[..., options.channel].transpose(2, 1, 0)
    scale = 1.0 if counts.min() < 0 else ANGSTROM_FROM_BOHR
    matrix = np.eye(4)
    matrix[:3, :3] = axes.T * scale
    matrix[:3, 3] = origin * scale
    return finished(path, values, matrix, options=options, unit="Å", value_name=title, labels=False)


def read_dx(path: Path, options: VoxelOptions) -> Volume:
    """Read an OpenDX scalar field on a regular grid, as APBS and others write it (z fastest).

    Own parser: the field's library reads only files that end in attributes and a field object,
    and bare grids are common.
    """
    opener = gzip.open if path.suffix == ".gz" else open
    origin, deltas = np.zeros(3), []
    size: list[int] = []
    try:
        with opener(path, "rt", encoding="utf-8", errors="replace") as file:
            for line in file:
                words = line.split()
                if "gridpositions" in words:
                    size = [int(w) for w in words[words.index("counts") + 1 :]]
                elif words[:1] == ["origin"]:
                    origin = np.array(words[1:4], float)
                elif words[:1] == ["delta"]:
                    deltas.append(np.array(words[1:4], float))
                elif "array" in words:
                    items = int(words[words.index("items") + 1])
                    break
            else:
                raise LoadError(path, "is no OpenDX grid: it has no array")
            with warnings.catch_warnings():  # text follows the numbers: numpy stops there
                warnings.simplefilter("ignore")
                values = np.fromstring(file.read(), np.float64, sep=" ")[:items]
    except (ValueError, IndexError, EOFError, OSError) as error:
        raise LoadError(path, f"is not a readable OpenDX grid: {error}") from None
    if len(size) != 3 or len(deltas) != 3 or np.prod(size) != items:
        raise LoadError(path, "is no regular three-dimensional OpenDX grid")
    if len(values) != items:
        raise LoadError(path, f"has {len(values):,} values for {items:,}: it is truncated")
    matrix = affine((1, 1, 1), origin.tolist())
    matrix[:3, :3] = np.array(deltas).T
    return finished(
        path, values.reshape(size).transpose(2, 1, 0), matrix, options=options, unit="Å",
        value_name="potential", labels=False,
    )  # fmt: skip
