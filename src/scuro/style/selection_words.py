"""What the words of a selection mean: tables from word to function, used by ``selection.py``.

Functions raise ``ValueError`` for values they cannot read.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from fnmatch import translate
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import (
    COIL,
    HELIX,
    ION,
    LIGAND,
    OTHER_POLYMER,
    POLYMER_NUCLEIC,
    POLYMER_PROTEIN,
    SOLVENT,
    STRAND,
    Molecule,
)
from scuro.style.bath import bath
from scuro.style.elements import METALS, NUMBER_OF

Mask = NDArray[np.bool_]
F = TypeVar("F")

PROTEIN_BACKBONE = ("N", "CA", "C", "O", "OXT", "H", "HA", "HA2", "HA3", "H1", "H2", "H3")
NUCLEIC_BACKBONE = (
    "P", "OP1", "OP2", "OP3", "O1P", "O2P", "O3P", "O5'", "C5'", "C4'", "O4'", "C3'", "O3'",
    "C2'", "O2'", "C1'", "O5*", "C5*", "C4*", "O4*", "C3*", "O3*", "C2*", "O2*", "C1*",
)  # fmt: skip
"""Sugar included, in today's and in the old PDB's names."""


# Properties: word VALUES ---------------------------------------------------------------------


def split(values: str) -> list[tuple[str, bool]]:
    """Alternatives of a list such as ``CA+C*+"A+B"`` with whether each was quoted."""
    pieces = re.findall(r'"([^"]*)"|(?<![^+,])\'([^\']*)\'(?=[+,]|$)|([^+,"]+)', values)
    return [(a or b or c, not c) for a, b, c in pieces]


def match(names: NDArray[np.str_], values: str, ignore_case: bool = True) -> Mask:
    """Which of ``names`` agree with one of the alternatives in ``values``."""
    found = np.zeros(len(names), bool)
    compared = np.strings.upper(names) if ignore_case else names
    for value, quoted in split(values):
        wanted = value.upper() if ignore_case else value
        if quoted or not re.search(r"[*?]", wanted):
            found |= compared == wanted
        else:
            unique, code = np.unique(compared, return_inverse=True)
            pattern = re.compile(translate(wanted))
            found |= np.array([bool(pattern.match(u)) for u in unique], bool)[code]
    return found


def ranges(numbers: NDArray, values: str, what: str) -> Mask:
    """Which numbers lie in a list of numbers and ranges such as ``1-5+9+-3--1``."""
    found = np.zeros(len(numbers), bool)
    for value, _ in split(values):
        read = re.fullmatch(r"\\?(-?\d+)(?:[-:]\\?(-?\d+))?", value)
        if read is None:
            raise ValueError(f"expected {what} such as 10, 10-40 or 1+5+9, not '{value}'")
        low = int(read[1])
        found |= (numbers >= low) & (numbers <= int(read[2] or low))
    return found


def residue_numbers(m: Molecule, values: str) -> Mask:
    """Residues by the author's number; ``52A`` is insertion code A, ``52`` alone has none."""
    found = np.zeros(len(m.residue_number), bool)
    for value, _ in split(values):
        read = re.fullmatch(r"\\?(-?\d+)([A-Za-z]?)", value)
        if read is None:
            found |= ranges(m.residue_number, value, "a residue number")
        else:
            same = np.strings.upper(np.strings.strip(m.insertion_code)) == read[2].upper()
            found |= (m.residue_number == int(read[1])) & same
    return found[m.residue]


def chains(m: Molecule, values: str) -> Mask:
    """Chains by the author's name, in the case it has."""
    names = np.array(m.chain_names, dtype=str)
    return match(names, values, ignore_case=False)[m.chain] if len(m) else np.zeros(0, bool)


def residues(m: Molecule, values: str) -> Mask:
    """Residues by name."""
    return match(m.residue_name, values)[m.residue]


def elements(m: Molecule, values: str) -> Mask:
    """Atoms by chemical symbol."""
    symbols = [value for value, _ in split(values)]
    unknown = [symbol for symbol in symbols if symbol.upper() not in NUMBER_OF]
    if unknown:
        raise ValueError(f"expected chemical symbols such as C or Fe+Zn, not '{unknown[0]}'")
    return np.isin(m.element, [NUMBER_OF[symbol.upper()] for symbol in symbols])


def secondary(m: Molecule, values: str) -> Mask:
    """``h`` helix, ``s`` strand, ``l`` or empty coil; proteins only."""
    letters = {"h": HELIX, "s": STRAND, "e": STRAND, "l": COIL, "c": COIL, "": COIL}
    wanted = []
    for value, _ in split(values):
        if value.lower() not in letters:
            raise ValueError(f"expected h (helix), s (strand) or l (loop), not '{value}'")
        wanted.append(letters[value.lower()])
    return np.isin(m.secondary, wanted)[m.residue] & (m.kind == POLYMER_PROTEIN)


def macro(m: Molecule, text: str) -> Mask:
    """PyMOL's ``/object/segment/chain/residue/atom``; parts left empty or out match everything."""
    parts = text[1:].split("/")
    if len(parts) > 5:
        raise ValueError("expected at most /object/segment/chain/residue/atom")
    object_, segment, chain, residue, atom = parts + [""] * (5 - len(parts))
    found = np.ones(len(m), bool)
    if object_:
        found &= match(np.array([m.name]), object_)[0]
    for name in filter(None, (segment, chain)):
        found &= chains(m, name)
    name, _, number = residue.rpartition("`")
    if number and (name or re.match(r"\\?-?\d", number)):
        found &= residue_numbers(m, number)
    elif number:
        name = number
    if name:
        found &= residues(m, name)
    return found & match(m.atom_name, atom) if atom else found


_PROPERTIES: dict[tuple[str, ...], Callable[[Molecule, str], Mask]] = {
    ("chain", "c.", "segi", "segid", "s."): chains,
    ("resi", "i.", "resid", "residue"): residue_numbers,
    ("resn", "r.", "resname"): residues,
    ("name", "n."): lambda m, v: match(m.atom_name, v),
    ("elem", "element", "e.", "symbol"): elements,
    ("index", "idx."): lambda m, v: ranges(np.arange(1, len(m) + 1), v, "an atom's index"),
    ("id",): lambda m, v: ranges(m.serial, v, "an atom's number"),
    ("model", "m.", "state"): lambda m, v: ranges(m.model, v, "a model's number"),
    ("alt",): lambda m, v: match(m.altloc, v),
    ("ss",): secondary,
}  # fmt: skip


# Flags: a word alone -------------------------------------------------------------------------


def backbone(m: Molecule) -> Mask:
    """Main chain of proteins; phosphate and sugar of nucleic acids."""
    protein = (m.kind == POLYMER_PROTEIN) & np.isin(m.atom_name, PROTEIN_BACKBONE)
    return protein | (m.kind == POLYMER_NUCLEIC) & np.isin(m.atom_name, NUCLEIC_BACKBONE)


def polymer(m: Molecule) -> Mask:
    """Proteins, nucleic acids and other chains of residues."""
    return np.isin(m.kind, (POLYMER_PROTEIN, POLYMER_NUCLEIC, OTHER_POLYMER))


def _with_carbon(m: Molecule) -> Mask:
    """Atoms of residues that hold carbon."""
    return np.bincount(m.residue, m.element == 6, len(m.residue_name))[m.residue] > 0


_FLAGS: dict[tuple[str, ...], Callable[[Molecule], Mask]] = {
    ("all", "*"): lambda m: np.ones(len(m), bool),
    ("auto",): lambda m: ~bath(m),
    ("none",): lambda m: np.zeros(len(m), bool),
    ("polymer", "pol."): polymer,
    ("protein", "polymer.protein"): lambda m: m.kind == POLYMER_PROTEIN,
    ("nucleic", "polymer.nucleic"): lambda m: m.kind == POLYMER_NUCLEIC,
    ("organic", "org."): lambda m: (m.kind == LIGAND) & _with_carbon(m),
    ("ligand",): lambda m: m.kind == LIGAND,
    ("inorganic", "ino."): lambda m: np.isin(m.kind, (LIGAND, ION)) & ~_with_carbon(m),
    ("ion", "ions"): lambda m: m.kind == ION,
    ("solvent", "sol.", "water", "waters"): lambda m: m.kind == SOLVENT,
    ("metals",): lambda m: np.isin(m.element, METALS),
    ("hetatm", "het", "hetero"): lambda m: m.hetero,
    ("hydrogens", "hydrogen", "hydro", "h."): lambda m: m.element == 1,
    ("backbone", "bb."): backbone,
    ("sidechain", "sc."): lambda m: polymer(m) & ~backbone(m),
    ("guide",): lambda m: (m.kind == POLYMER_PROTEIN) & (m.atom_name == "CA")
    | (m.kind == POLYMER_NUCLEIC) & np.isin(m.atom_name, ("C4'", "C4*")),
}  # fmt: skip

NUMBERS: dict[str, Callable[[Molecule], NDArray]] = {
    "b": lambda m: m.b_factor,
    "q": lambda m: m.occupancy,
    "x": lambda m: m.positions[:, 0],
    "y": lambda m: m.positions[:, 1],
    "z": lambda m: m.positions[:, 2],
    "fc.": lambda m: m.formal_charge,
    "formal_charge": lambda m: m.formal_charge,
}


# Operators: from a mask to a mask ------------------------------------------------------------


def _whole(code: NDArray, mask: Mask) -> Mask:
    """All atoms of every group (``code`` (n,), from 0) that has an atom in ``mask``."""
    return np.bincount(code, mask, int(code.max(initial=-1)) + 1)[code] > 0


def _chain_names(m: Molecule) -> NDArray:
    """Number of the author's chain name of each atom; several chains may share one."""
    return np.unique(np.array(m.chain_names, dtype=str), return_inverse=True)[1][m.chain]


def _molecules(m: Molecule) -> NDArray:
    """Number of the bonded component of each atom."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b = m.bonds.T
    graph = coo_array((np.ones(len(a), bool), (a, b)), shape=(len(m), len(m)))
    return connected_components(graph, directed=False)[1]


def _bonded(m: Molecule, mask: Mask) -> Mask:
    """Atoms with a bond to one in ``mask``."""
    found = np.zeros(len(m), bool)
    a, b = m.bonds.T
    found[a[mask[b]]] = True
    found[b[mask[a]]] = True
    return found


def _extend(m: Molecule, mask: Mask, bonds: float) -> Mask:
    for _ in range(int(bonds)):
        wider = mask | _bonded(m, mask)
        if wider.sum() == mask.sum():
            break
        mask = wider
    return mask


def _one(mask: Mask, which: int) -> Mask:
    found = np.zeros_like(mask)
    found[np.flatnonzero(mask)[which : which + 1 or None]] = True
    return found


def near(m: Molecule, mask: Mask, distance: float) -> Mask:
    """Atoms whose centre is at most ``distance`` Å from that of an atom in ``mask``."""
    from scipy.spatial import cKDTree

    found = np.zeros(len(m), bool)
    targets = m.positions[mask]
    if len(targets) == 0 or distance < 0:
        return found
    reach = distance + 1e-4  # in a box first: most atoms of a large molecule are far away
    low, high = targets.min(axis=0) - reach, targets.max(axis=0) + reach
    close = np.flatnonzero(((m.positions >= low) & (m.positions <= high)).all(axis=1))
    found_distance, _ = cKDTree(targets).query(m.positions[close], distance_upper_bound=reach)
    found[close[found_distance <= distance]] = True
    return found


_BY: dict[tuple[str, ...], Callable[[Molecule, Mask], Mask]] = {
    ("byres", "byresi", "byresidue", "br."): lambda m, s: _whole(m.residue, s),
    ("bychain", "bc.", "bysegi", "bysegment", "bs."): lambda m, s: _whole(_chain_names(m), s),
    ("bymolecule", "bymol", "bm."): lambda m, s: _whole(_molecules(m), s),
    ("bymodel",): lambda m, s: _whole(np.unique(m.model, return_inverse=True)[1], s),
    ("neighbor", "neighbour", "nbr."): lambda m, s: _bonded(m, s) & ~s,
    ("bound_to", "bto."): lambda m, s: _bonded(m, s),
    ("first",): lambda m, s: _one(s, 0),
    ("last",): lambda m, s: _one(s, -1),
}  # fmt: skip
_POSTFIX: dict[tuple[str, ...], Callable[[Molecule, Mask, float], Mask]] = {
    ("around", "a."): lambda m, s, d: near(m, s, d) & ~s,
    ("expand", "x."): lambda m, s, d: near(m, s, d) | s,
    ("extend", "xt."): _extend,
}
_WITHIN: dict[tuple[str, ...], Callable[[Molecule, Mask, float], Mask]] = {
    ("within", "w."): near,
    ("near_to", "nto."): lambda m, s, d: near(m, s, d) & ~s,
    ("beyond", "be."): lambda m, s, d: ~near(m, s, d),
}


def _spelled(table: dict[tuple[str, ...], F]) -> dict[str, F]:
    return {word: meaning for words, meaning in table.items() for word in words}


PROPERTIES, FLAGS, BY = _spelled(_PROPERTIES), _spelled(_FLAGS), _spelled(_BY)
POSTFIX, WITHIN = _spelled(_POSTFIX), _spelled(_WITHIN)
