"""PSF (CHARMM, NAMD, X-PLOR): atoms and bonds without coordinates, blank-separated."""

from __future__ import annotations

import re

import numpy as np

from scuro.errors import LoadError
from scuro.load.source import Source
from scuro.load.table import AtomTable, FileBonds, first_seen, strings


def read_table(source: Source) -> AtomTable:
    """Atoms and bonds; the coordinates are NaN until a trajectory gives them.

    Raises:
        LoadError: A section is missing or cut off.
    """
    atoms, count = _section(source, "NATOM")
    fields = atoms.split("\n", count)[:count]
    cells = [line.split(None, 6)[:6] for line in fields]
    if len(cells) != count or any(len(row) < 6 for row in cells) or count == 0:
        raise LoadError(source.name, f"{count} atoms are announced, but not all are there")
    _, segment, number, residue, name, _ = (np.array(c, "S") for c in zip(*cells, strict=True))
    bonds, bond_count = _section(source, "NBOND")
    pairs = np.array(re.split(r"\n\s*\n", bonds, maxsplit=1)[0].split()[: 2 * bond_count], np.int64)
    chain, chain_names = first_seen(segment)
    digits = [re.sub(r"[^0-9-]", "", n) or "0" for n in number.astype(str).tolist()]
    return AtomTable(
        name=source.stem,
        positions=np.full((count, 3), np.nan, np.float32),
        atom_name=name,
        residue_name=residue,
        residue_number=np.array(digits, np.int64).astype(np.int32),
        chain=chain,
        chain_names=strings(chain_names),
        bonds=FileBonds(pairs.reshape(-1, 2), np.zeros(len(pairs) // 2, np.uint8), complete=True),
    )


def _section(source: Source, key: str) -> tuple[str, int]:
    """Text behind a section's title line, and the count that the title gives."""
    title = re.search(rf"^\s*(\d+)\s+!{key}\b.*\n", source.text, re.MULTILINE)
    if title is None:
        raise LoadError(source.name, f"has no section {key}: not a PSF file?")
    return source.text[title.end() :], int(title.group(1))
