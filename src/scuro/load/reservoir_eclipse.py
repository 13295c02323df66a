"""ECLIPSE and OPM output: EGRID or GRID, with the INIT and restart files that lie beside it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.options import LoadOptions
from scuro.load.reservoir_build import build_grid
from scuro.load.reservoir_records import RecordFile, words
from scuro.load.reservoir_wells import read_wells
from scuro.load.source import Source, open_source
from scuro.scene.cornerpoint import CornerPointGrid, TimeStep, Well

_SYSTEMS = {1: "METRIC", 2: "FIELD", 3: "LAB"}
_RESTART = re.compile(r"\.[XF]\d{4}$", re.IGNORECASE)
_HEADERS = {"INTEHEAD", "LOGIHEAD", "DOUBHEAD", "TAB", "TABDIMS", "CON", "TRANNNC", "ACTNUM"}
KEPT_ARRAYS = 16
"""Arrays of restart steps kept in memory."""


@dataclass(frozen=True)
class Geometry:
    """What a grid file says."""

    dimensions: tuple[int, int, int]
    coord: NDArray
    zcorn: NDArray
    active: NDArray | None
    unit: str | None
    map_axes: NDArray | None
    map_unit: str
    depth_down: bool
    connections: NDArray


def read_eclipse(source: Source, options: LoadOptions) -> CornerPointGrid:
    """Read a grid file and what lies beside it; an INIT or restart file leads to its grid."""
    grid_source = source
    if source.suffix not in (".egrid", ".grid", ".fegrid", ".fgrid", ""):
        found = _beside(source, ("egrid", "grid", "fegrid"))
        if found is None:
            raise LoadError(
                source.name, "holds no geometry, and there is no EGRID or GRID of that name beside"
            )
        grid_source = found
    records = RecordFile(grid_source)
    geometry = read_cells(records) if records.find("CORNERS") else read_pillars(records)
    notes = [f"{grid_source.name}: {records.cut_off}"] if records.cut_off else []
    count = int(np.prod(geometry.dimensions))
    active_count = count if geometry.active is None else int(np.count_nonzero(geometry.active))
    # damage beside the grid takes nothing from the grid itself
    system = ""
    statics: dict[str, NDArray[np.float32]] = {}
    try:
        system, statics = _read_init(grid_source, count, active_count, geometry.active, notes)
    except LoadError as error:
        notes.append(f"{error}; left out")
    steps, wells, restart_system = _read_restarts(
        grid_source, count, active_count, geometry.active, notes
    )
    return build_grid(
        grid_source,
        geometry.dimensions,
        geometry.coord,
        geometry.zcorn,
        active=geometry.active,
        unit=geometry.unit,
        unit_system=system or restart_system,
        options=options,
        map_axes=geometry.map_axes,
        map_unit=geometry.map_unit,
        depth_down=geometry.depth_down,
        statics=statics,
        steps=steps,
        wells=wells,
        connections=geometry.connections,
        notes=notes,
    )


def read_pillars(records: RecordFile) -> Geometry:
    """The corner-point form: GRIDHEAD, COORD, ZCORN (EGRID, and newer GRID files)."""
    head = records.needed("GRIDHEAD")
    if len(head) < 4 or head[0] != 1:
        raise LoadError(records.name, "the grid is not corner-point (GRIDHEAD's type is not 1)")
    nnc1, nnc2 = records.array("NNC1"), records.array("NNC2")
    pairs = np.zeros((0, 2), np.int64)
    if nnc1 is not None and nnc2 is not None and len(nnc1) == len(nnc2):
        pairs = np.stack([nnc1, nnc2], axis=1).astype(np.int64) - 1
    units = words(records.array("GRIDUNIT"))
    orientation = words(records.array("GDORIENT"))
    map_axes = None if "MAP" in units[1:] else records.array("MAPAXES")
    active = records.array("ACTNUM")
    return Geometry(
        tuple(int(n) for n in head[1:4]),  # type: ignore[arg-type]
        records.needed("COORD"),
        records.needed("ZCORN"),
        None if active is None else active & 1 > 0,
        units[0] if units else None,
        map_axes,
        (words(records.array("MAPUNITS")) or [""])[0],
        "UP" not in orientation,
        pairs,
    )


def read_cells(records: RecordFile) -> Geometry:
    """The older GRID form: for each cell COORDS (i, j, k, number, active) and CORNERS (24)."""
    ni, nj, nk = (int(n) for n in records.needed("DIMENS")[:3])
    count = ni * nj * nk
    table = [(r.keyword, r) for r in records.records if r.keyword in ("COORDS", "CORNERS")]
    heads = [records.read(r) for keyword, r in table if keyword == "COORDS"]
    corners = [records.read(r) for keyword, r in table if keyword == "CORNERS"]
    if len(heads) != count or len(corners) != count:
        raise LoadError(records.name, f"has {len(corners)} cells of {count}: the file is cut off")
    place = np.array([h[:3] for h in heads], np.int64) - 1
    order = place[:, 0] + ni * (place[:, 1] + nj * place[:, 2])
    boxes = np.empty((count, 2, 2, 2, 3), np.float32)
    boxes[order] = np.array(corners, np.float32).reshape(-1, 2, 2, 2, 3)
    boxes = boxes.reshape(nk, nj, ni, 2, 2, 2, 3)
    active = np.ones(count, bool)
    active[order] = [len(h) < 5 or h[4] > 0 for h in heads]
    # each pillar runs through the corners of the top and the bottom cell of a column beside it
    ends = np.empty((nj + 1, ni + 1, 2, 3))
    for dj, di in np.ndindex(2, 2):
        ends[dj : nj + dj, di : ni + di, 0] = boxes[0, :, :, 0, dj, di]
        ends[dj : nj + dj, di : ni + di, 1] = boxes[-1, :, :, 1, dj, di]
    zcorn = boxes[..., 2].transpose(0, 3, 1, 4, 2, 5)
    units = words(records.array("GRIDUNIT")) or words(records.array("MAPUNITS"))
    return Geometry(
        (ni, nj, nk), ends, zcorn, active, units[0] if units else None,
        records.array("MAPAXES"), "", True,
        np.zeros((0, 2), np.int64),
    )  # fmt: skip


def _beside(source: Source, endings: Sequence[str]) -> Source | None:
    """A file of the same name with another ending, whatever the case."""
    if source.path is None:
        return None
    stem = source.stem.lower()
    for ending in endings:
        for path in sorted(source.path.parent.glob(f"{_escaped(source.stem)}.*")):
            if path.name.lower().removesuffix(".gz") == f"{stem}.{ending}":
                return open_source(path)
    return None


def _escaped(text: str) -> str:
    return re.sub(r"([\[\]*?])", r"[\1]", text)


def _active_values(array: NDArray, count: int, active: NDArray | None) -> NDArray[np.float32]:
    """Values at active cells, whether the file has all cells or only those."""
    if active is not None and len(array) == count:
        array = array[active.ravel()]
    return array.astype(np.float32)


def _read_init(
    source: Source, count: int, active_count: int, active: NDArray | None, notes: list[str]
) -> tuple[str, dict[str, NDArray[np.float32]]]:
    found = _beside(source, ("init", "finit"))
    if found is None:
        notes.append("there is no INIT beside the grid: no porosity, permeability and the like")
        return "", {}
    records = RecordFile(found)
    if records.cut_off:
        notes.append(f"{found.name}: {records.cut_off}; what comes before is used")
    head = records.array("INTEHEAD")
    system = _SYSTEMS.get(int(head[2]), "") if head is not None and len(head) > 2 else ""
    statics: dict[str, NDArray[np.float32]] = {}
    for record in records.records:
        if record.keyword in _HEADERS or record.length in (0, 1):
            continue
        if record.length in (count, active_count):
            try:
                values = records.read(record)
            except LoadError as error:
                notes.append(f"{error}; left out")
                continue
            if values.dtype.kind in "if":
                statics.setdefault(record.keyword, _active_values(values, count, active))
        elif record.keyword in ("PORO", "PERMX", "PERMY", "PERMZ", "NTG"):
            notes.append(
                f"{found.name}: {record.keyword} has {record.length:,} values, but the grid has "
                f"{active_count:,} active cells: left out"
            )
    return system, statics


def _read_restarts(
    source: Source, count: int, active_count: int, active: NDArray | None, notes: list[str]
) -> tuple[tuple[TimeStep, ...], tuple[Well, ...], str]:
    files: list[RecordFile] = []
    unified = _beside(source, ("unrst", "funrst"))
    found = [] if unified is None else [unified]
    if unified is None and source.path is not None:
        beside = sorted(source.path.parent.glob(f"{_escaped(source.stem)}.*"))
        found = [open_source(path) for path in beside if _RESTART.search(path.name)]
    for restart in found:
        try:
            files.append(RecordFile(restart))
        except LoadError as error:
            notes.append(f"{error}; left out")
    if not found:
        notes.append("there is no restart file beside the grid: no pressures or saturations")
        return (), (), "METRIC"
    steps: list[TimeStep] = []
    wells: tuple[Well, ...] = ()
    system = "METRIC"
    for records in files:
        if records.cut_off:
            notes.append(f"{records.name}: {records.cut_off}; the steps before are used")
        starts = [n for n, r in enumerate(records.records) if r.keyword == "INTEHEAD"]
        for first, last in pairwise([*starts, len(records.records)]):
            ends_inside = bool(records.cut_off) and last == len(records.records)
            if ends_inside and records.find("ENDSOL", first, last) is None:
                continue
            try:
                head = records.read(records.records[first])
                system = _SYSTEMS.get(int(head[2]) if len(head) > 2 else 0, system)
                steps.append(_step(records, head, first, last, count, active_count, active, notes))
                wells = read_wells(records, head, first, last) or wells
            except LoadError as error:
                notes.append(f"{error}; left out")
    return tuple(steps), wells, system


def _step(
    records: RecordFile,
    head: NDArray,
    first: int,
    last: int,
    count: int,
    active_count: int,
    active: NDArray | None,
    notes: list[str],
) -> TimeStep:
    solution = {}
    inside = records.find("STARTSOL", first, last) is None
    for record in records.records[first:last]:
        inside |= record.keyword == "STARTSOL"
        if not inside or record.keyword in _HEADERS:
            continue
        if record.length in (count, active_count) and record.length > 1:
            solution[record.keyword] = record
        elif record.keyword in ("PRESSURE", "SWAT", "SGAS", "SOIL"):
            note = (
                f"{records.name}: {record.keyword} has {record.length:,} values, but the grid has "
                f"{active_count:,} active cells: left out"
            )
            if note not in notes:
                notes.append(note)

    @lru_cache(maxsize=KEPT_ARRAYS)
    def read(name: str) -> NDArray[np.float32]:
        return _active_values(records.read(solution[name]), count, active)

    return TimeStep(_report(records, first, head), _date(head), tuple(solution), read)


def _report(records: RecordFile, first: int, head: NDArray) -> int:
    if first > 0 and records.records[first - 1].keyword == "SEQNUM":
        return int(records.read(records.records[first - 1])[0])
    suffix = Path(records.name).suffix
    return int(suffix[2:]) if _RESTART.search(suffix) else int(head[68]) if len(head) > 68 else 0


def _date(head: NDArray) -> date | None:
    try:
        return date(int(head[66]), int(head[65]), int(head[64]))
    except (IndexError, ValueError):
        return None
