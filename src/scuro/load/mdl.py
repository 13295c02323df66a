"""MDL mol and SD files, V2000 (fixed columns) and V3000 (blank-separated)."""

from __future__ import annotations

import re

import numpy as np

from scuro.errors import LoadError
from scuro.load.elements import atomic_numbers
from scuro.load.source import Source
from scuro.load.table import AtomTable, FileBonds

_V2000_CHARGES = {1: 3, 2: 2, 3: 1, 5: -1, 6: -2, 7: -3}
"""Charge codes of the atom block."""


class _Record:
    """One molecule: parallel lists, atoms numbered from 0."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.xyz: list[tuple[float, float, float]] = []
        self.symbol: list[str] = []
        self.charge: list[int] = []
        self.bonds: list[tuple[int, int, int]] = []


def read_table(source: Source) -> AtomTable:
    """All records of a file; the record's number is the model.

    Raises:
        LoadError: A count or number cannot be read (names the line), or a bond to no atom.
    """
    lines = source.lines().read().split("\n")
    records = []
    start = 0
    while start + 3 < len(lines) and any(line.strip() for line in lines[start : start + 4]):
        end = next((i for i in range(start, len(lines)) if lines[i].startswith("$$$$")), len(lines))
        records.append(_record(source, lines, start, end))
        start = end + 1
    if not records:
        raise LoadError(source.name, "has no molecule (a mol record begins with four header lines)")
    return records_table(source, records)


def _record(source: Source, lines: list[str], start: int, end: int) -> _Record:
    record = _Record(lines[start].strip())
    counts = lines[start + 3]
    number = start + 4
    try:
        if "V3000" in counts:
            _read_v3000(record, lines[start + 4 : end])
        else:
            atoms, bonds = int(counts[0:3]), int(counts[3:6])
            for line in lines[start + 4 : start + 4 + atoms]:
                number += 1
                record.xyz.append((float(line[0:10]), float(line[10:20]), float(line[20:30])))
                record.symbol.append(line[31:34].strip())
                record.charge.append(_V2000_CHARGES.get(int(line[36:39].strip() or 0), 0))
            for line in lines[start + 4 + atoms : start + 4 + atoms + bonds]:
                number += 1
                record.bonds.append((int(line[0:3]) - 1, int(line[3:6]) - 1, int(line[6:9])))
            _read_charges(record, lines[start + 4 + atoms + bonds : end])
    except (ValueError, IndexError) as error:
        raise LoadError(
            source.name, f"is damaged, or is not an SD file ({error})", number
        ) from None
    if any(not 0 <= i < len(record.xyz) for bond in record.bonds for i in bond[:2]):
        raise LoadError(source.name, "has a bond to an atom that is not there", start + 4)
    return record


def _read_charges(record: _Record, lines: list[str]) -> None:
    """``M  CHG`` lines: pairs of atom number and charge; they replace the atom block's codes."""
    told = [line.split()[3:] for line in lines if line.startswith("M  CHG")]
    if told:
        record.charge = [0] * len(record.xyz)
    for words in told:
        for atom, charge in zip(words[::2], words[1::2], strict=False):
            record.charge[int(atom) - 1] = int(charge)


def _read_v3000(record: _Record, lines: list[str]) -> None:
    text = "\n".join(line[6:].strip() for line in lines if line.startswith("M  V30"))
    text = text.replace("-\n", " ")  # a dash continues the line
    place: dict[str, int] = {}
    block = ""
    for line in text.split("\n"):
        words = line.split()
        if line.startswith("BEGIN "):
            block = words[1]
        elif line.startswith("END "):
            block = ""
        elif block == "ATOM":
            place[words[0]] = len(record.xyz)
            record.symbol.append(words[1])
            record.xyz.append((float(words[2]), float(words[3]), float(words[4])))
            charge = re.search(r"\bCHG=(-?\d+)", line)
            record.charge.append(int(charge.group(1)) if charge else 0)
        elif block == "BOND":
            record.bonds.append((place.get(words[2], -1), place.get(words[3], -1), int(words[1])))


def records_table(source: Source, records: list[_Record]) -> AtomTable:
    """Small molecules one behind the other, each a model of one residue."""
    sizes = np.array([len(r.xyz) for r in records])
    offsets = np.r_[0, np.cumsum(sizes)]
    model = np.repeat(np.arange(1, len(records) + 1), sizes)
    symbols = np.array([s for r in records for s in r.symbol], "S")
    bonds = np.array(
        [
            (a + offset, b + offset, order)
            for r, offset in zip(records, offsets.tolist(), strict=False)
            for a, b, order in r.bonds
        ],
        np.int64,
    ).reshape(-1, 3)
    order = np.where((bonds[:, 2] >= 1) & (bonds[:, 2] <= 4), bonds[:, 2], 0)
    count = int(offsets[-1])
    return AtomTable(
        name=records[0].name or source.stem,
        positions=np.array([p for r in records for p in r.xyz], np.float32).reshape(-1, 3),
        atom_name=symbols,
        residue_name=np.full(count, b"LIG"),
        residue_number=np.ones(count, np.int32),
        chain=np.zeros(count, np.int32),
        chain_names=("",),
        element=atomic_numbers(symbols) if count else None,
        hetero=np.ones(count, bool),
        polymer=np.zeros(count, np.int8),
        charge=np.array([c for r in records for c in r.charge], np.int8),
        model=model.astype(np.int32),
        bonds=FileBonds(bonds[:, :2] + 1, order.astype(np.uint8), complete=True),
        notes=[f"{len(records)} molecules in the file"] if len(records) > 1 else [],
    )
