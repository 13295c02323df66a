"""The PDB format, by columns, vectorised: all atom lines at once as one array of characters.

Written here rather than taken from gemmi because gemmi 0.7 reads damaged coordinates as 0, refuses
1992-style files (entry code in columns 73-80) and misreads wide BIOMT serials; the time is the
same (docs/decisions.md, "Reading structures").
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.columns import fixed_floats, fixed_integers, strip
from scuro.load.elements import atomic_numbers
from scuro.load.lines import Lines
from scuro.load.pdb_header import read_assemblies, read_bonds, read_entities, read_secondary
from scuro.load.source import Source
from scuro.load.table import AtomTable, first_seen, strings


def read_table(source: Source) -> AtomTable:
    """The atoms of a PDB file.

    Raises:
        LoadError: No atoms, or a line whose coordinates cannot be read (names the line).
    """
    return _pdb_table(source, *_atom_lines(source))


def read_pqr(source: Source) -> AtomTable:
    """The atoms of a PQR file: PDB's records, separated by blanks, with charges and radii.

    Raises:
        LoadError: No atoms, or fields that cannot be read.
    """
    return _pqr_table(source, *_atom_lines(source))


def _atom_lines(source: Source) -> tuple[Lines, NDArray[np.intp]]:
    lines = Lines(source.data)
    rows = lines.atoms()
    if len(rows) == 0:
        raise LoadError(source.name, "has no atoms (no line begins with ATOM or HETATM)")
    return lines, rows


def _pdb_table(source: Source, lines: Lines, rows: NDArray) -> AtomTable:
    def bad(what: str):
        return lambda i: LoadError(source.name, f"{what} cannot be read", int(rows[i]) + 1)

    notes: list[str] = []
    positions = np.empty((len(rows), 3), np.float32)
    for axis, first in enumerate((31, 39, 47)):
        positions[:, axis] = fixed_floats(
            lines.columns(rows, first, first + 7), bad("the atom's coordinate")
        )
    modern = _has_elements(lines, rows, notes)
    chain_text = lines.columns(rows, 22, 22)
    if modern and not strip(chain_text).astype(bool).any():
        # simulation programs leave the chain blank and write a segment name instead
        chain_text = strip(lines.columns(rows, 73, 76))
    chain, names = first_seen(chain_text)
    serial, overflow = _serials(lines, rows)
    if overflow.any():
        notes.append("some atoms have no readable serial number and are numbered by their place")
        serial[overflow] = np.flatnonzero(overflow) + 1
    number, unreadable = fixed_integers(lines.columns(rows, 23, 26), hybrid=True)
    if unreadable.any():
        notes.append("some residue numbers cannot be read and are taken as 0")
    padded = lines.columns(rows, 13, 16)
    hetero = lines.record[rows] == b"HETATM"
    chain_names = strings(names)
    entity, entity_names = read_entities(lines, chain_names)
    return AtomTable(
        name=_title(lines, rows) or source.stem,
        positions=positions,
        atom_name=strip(padded),
        padded_name=padded,
        residue_name=strip(lines.columns(rows, 18, 21)),
        residue_number=number.astype(np.int32),
        chain=chain,
        chain_names=chain_names,
        element=atomic_numbers(lines.columns(rows, 77, 78)) if modern else None,
        insertion=strip(lines.columns(rows, 27, 27)),
        altloc=strip(lines.columns(rows, 17, 17)),
        hetero=hetero,
        polymer=_polymer(lines, rows, chain),
        b_factor=fixed_floats(lines.columns(rows, 61, 66), default=0.0),
        occupancy=fixed_floats(lines.columns(rows, 55, 60), default=1.0),
        charge=_charges(lines.columns(rows, 79, 80)) if modern else None,
        serial=serial,
        model=_models(lines, rows),
        chain_entity=entity,
        entity_names=entity_names,
        bonds=read_bonds(lines, chain_names),
        secondary=read_secondary(lines, chain_names),
        assemblies=read_assemblies(source, lines, chain_names),
        notes=notes,
    )


def _serials(lines: Lines, rows: NDArray) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Serial numbers, and which of them cannot be read.

    Beyond 99,999 programs go on in hybrid-36, write asterisks, or take one more column to the
    left (``ATOM 100000``) or right (``HETATM100000``).
    """
    serial, bad = fixed_integers(lines.columns(rows, 7, 11), hybrid=True)
    for beyond, first in ((6, 6), (12, 7)):
        codes = lines.codes[rows, beyond - 1]
        wide = (codes >= 48) & (codes <= 57)
        if wide.any():
            number, unread = fixed_integers(lines.columns(rows[wide], first, first + 5))
            serial[wide], bad[wide] = number, unread
    return serial, bad


def _has_elements(lines: Lines, rows: NDArray, notes: list[str]) -> bool:
    """Whether columns 73-80 hold segment, element and charge, not a 1992-style code and number."""
    tail = strip(lines.columns(rows, 77, 80))
    filled = tail != b""
    if not filled.any():
        return True
    counted = np.char.isdigit(tail)
    if counted[filled].mean() > 0.9:
        notes.append("columns 73-80 hold the entry's code and line numbers (1992 style), ignored")
        return False
    return True


def _title(lines: Lines, rows: NDArray) -> str:
    header = lines.of(b"HEADER")
    return lines.columns(header[:1], 63, 66)[0].decode("latin-1").strip() if len(header) else ""


def _models(lines: Lines, rows: NDArray) -> NDArray[np.int32] | None:
    starts = lines.of(b"MODEL ")
    if len(starts) == 0:
        return None
    numbers, unreadable = fixed_integers(lines.columns(starts, 7, 14))
    numbers = np.where(unreadable, np.arange(1, len(starts) + 1), numbers)
    if len(np.unique(numbers)) != len(numbers):
        numbers = np.arange(1, len(starts) + 1)
    # atoms before the first MODEL line belong to the first
    place = np.maximum(np.searchsorted(starts, rows) - 1, 0)
    return numbers[place].astype(np.int32)


def _polymer(lines: Lines, rows: NDArray, chain: NDArray) -> NDArray[np.int8]:
    """TER ends the polymer of its chain: atoms before it are in it, later ones are not."""
    ends = lines.of(b"TER   ")
    polymer = np.full(len(rows), -1, np.int8)
    if len(ends) == 0:
        return polymer
    before = np.searchsorted(rows, ends) - 1
    before = before[before >= 0]
    # last terminated row of each (model's) chain: models repeat, so work on runs between TERs
    starts = lines.of(b"MODEL ")
    model = np.searchsorted(starts, rows)
    key = model.astype(np.int64) * (int(chain.max()) + 1) + chain
    last = np.full(int(key.max()) + 1, -1, np.int64)
    np.maximum.at(last, key[before], before)
    known = last[key] >= 0
    polymer[known] = np.arange(len(rows))[known] <= last[key][known]
    return polymer


def _charges(columns: NDArray[np.bytes_]) -> NDArray[np.int8]:
    """``2+``, ``1-`` (or ``+2``, ``-1``) to numbers; anything else is 0."""
    charge = np.zeros(len(columns), np.int8)
    values, inverse = np.unique(columns, return_inverse=True)
    for i, value in enumerate(values.tolist()):
        digits, sign = value.strip(b" +-"), value.strip(b" 0123456789")
        if digits.isdigit() and sign in (b"+", b"-"):
            charge[inverse.ravel() == i] = int(digits) * (1 if sign == b"+" else -1)
    return charge


def _pqr_table(source: Source, lines: Lines, rows: NDArray) -> AtomTable:
    """PQR: blank-separated; the last five fields are x, y, z, charge and radius."""
    fields = [bytes(lines.codes[r]).split() for r in rows]
    widths = {len(f) for f in fields}
    if not widths <= {10, 11}:
        raise LoadError(source.name, "a PQR atom line has 10 or 11 fields, separated by blanks")
    try:
        numbers = np.array([f[-5:] for f in fields]).astype(np.float64)
        residue_number = np.array([f[-6] for f in fields]).astype(np.int64)
    except ValueError as error:
        raise LoadError(source.name, f"a number of an atom cannot be read ({error})") from None
    chain, names = first_seen(np.array([f[4] if len(f) == 11 else b"" for f in fields]))
    return AtomTable(
        name=source.stem,
        positions=numbers[:, :3].astype(np.float32),
        atom_name=np.array([f[2] for f in fields]),
        residue_name=np.array([f[3] for f in fields]),
        residue_number=residue_number.astype(np.int32),
        chain=chain,
        chain_names=strings(names),
        hetero=lines.record[rows] == b"HETATM",
        radius=numbers[:, 4].astype(np.float32),
    )
