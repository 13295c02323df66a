"""Tripos MOL2: sections of blank-separated fields."""

from __future__ import annotations

import numpy as np

from scuro.errors import LoadError
from scuro.load.elements import atomic_numbers
from scuro.load.source import Source
from scuro.load.table import AtomTable, FileBonds, first_seen, strings

_ORDER = {"1": 1, "2": 2, "3": 3, "ar": 4, "am": 1}


def read_table(source: Source) -> AtomTable:
    """All molecules of a file; the molecule's number is the model.

    Raises:
        LoadError: A line of the atom or bond section that cannot be read (names it).
    """
    atoms: list[list[str]] = []
    model: list[int] = []
    bonds: list[tuple[int, int, int]] = []
    names: list[str] = []
    place: dict[str, int] = {}
    section, in_section = "", 0
    for number, line in enumerate(source.lines(), 1):
        if line.startswith("@<TRIPOS>"):
            section, in_section = line[9:].strip(), 0
            continue
        in_section += 1
        if section == "MOLECULE" and in_section == 1:
            names.append(line.strip())
            place = {}
        words = line.split()
        if not words or line.startswith("#"):
            continue
        try:
            if section == "ATOM":
                place[words[0]] = len(atoms)
                atoms.append([words[1], *map(_coordinate, words[2:5]), words[5], *words[6:8]])
                model.append(len(names))
            elif section == "BOND":
                ends = place[words[1]], place[words[2]]
                bonds.append((*ends, _ORDER.get(words[3].lower(), 0)))
        except (ValueError, IndexError, KeyError):
            raise LoadError(source.name, f"cannot be read ({line.strip()[:40]})", number) from None
    if not atoms:
        raise LoadError(source.name, "has no atoms (no @<TRIPOS>ATOM section)")
    # residue: its number (field 7) and name (field 8, often with the number again)
    rows = [atom + ["1", "LIG"][len(atom) - 5 :] for atom in atoms]
    number_text = [row[5].lstrip("-").isdigit() for row in rows]
    columns = list(zip(*rows, strict=True))
    bond_rows = np.array(bonds, np.int64).reshape(-1, 3)
    residue_name = np.array(columns[6], "S")
    chain, chain_names = first_seen(np.zeros(len(rows), "S1"))
    return AtomTable(
        name=names[0] if names else source.stem,
        positions=np.array(columns[1:4], np.float64).T.astype(np.float32),
        atom_name=np.array(columns[0], "S"),
        residue_name=residue_name,
        residue_number=np.where(number_text, columns[5], "1").astype(np.int32),
        chain=chain,
        chain_names=strings(chain_names),
        element=atomic_numbers(np.array([t.partition(".")[0] for t in columns[4]], "S")),
        model=np.array(model, np.int32),
        bonds=FileBonds(
            bond_rows[:, :2] + 1, bond_rows[:, 2].astype(np.uint8), complete=len(bonds) > 0
        ),
    )


def _coordinate(word: str) -> str:
    float(word)
    return word
