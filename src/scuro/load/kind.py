"""What kind of thing a residue is: protein, nucleic acid, ligand, solvent, ion."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from scuro.load.table import AtomTable
from scuro.scene.molecule import (
    ION,
    LIGAND,
    OTHER_POLYMER,
    POLYMER_NUCLEIC,
    POLYMER_PROTEIN,
    SOLVENT,
)

_WATERS = frozenset(
    b"HOH WAT H2O DOD SOL TIP TIP2 TIP3 TIP4 TIP5 TP3 TP4 TP5 T3P T4P SPC SPCE OH2".split()
)
_CAPS = frozenset(b"ACE NH2 NME NMA FOR".split())
_AMINO_VARIANTS = frozenset(
    b"HSD HSE HSP HID HIE HIP HISA HISB HISH HISD HISE LYN LYSH ASH ASPH GLH GLUH CYX CYM CYS2 "
    b"MSE SEC PYL UNK ASX GLX".split()
)
_NUCLEIC_VARIANTS = frozenset(
    b"RA RC RG RU DA5 DA3 DC5 DC3 DG5 DG3 DT5 DT3 RA5 RA3 RC5 RC3 RG5 RG3 RU5 RU3 "
    b"ADE CYT GUA THY URA".split()
)
_METALS_AND_HALIDES = np.zeros(256, bool)
_METALS_AND_HALIDES[[3, 4, 9, 11, 12, 13, 17, 35, 53]] = True
_METALS_AND_HALIDES[19:32] = True
_METALS_AND_HALIDES[37:51] = True
_METALS_AND_HALIDES[55:84] = True
_METALS_AND_HALIDES[88:104] = True

_WATER, _AMINO, _NUCLEIC, _OTHER = range(4)


@cache
def _by_name(name: bytes) -> int:
    """Class of a residue's name, by gemmi's table of the CCD's common components."""
    if name in _WATERS:
        return _WATER
    if name in _AMINO_VARIANTS or name in _CAPS:
        return _AMINO
    if name in _NUCLEIC_VARIANTS:
        return _NUCLEIC
    import gemmi

    found = gemmi.find_tabulated_residue(name.decode("latin-1"))
    if found.is_water():
        return _WATER
    if found.is_amino_acid():
        return _AMINO
    return _NUCLEIC if found.is_nucleic_acid() else _OTHER


def name_classes(residue_names: NDArray[np.bytes_]) -> tuple[NDArray, NDArray, NDArray]:
    """Per residue: whether its name is water's, an amino acid's, a nucleotide's."""
    distinct, inverse = np.unique(residue_names, return_inverse=True)
    by_name = np.array([_by_name(name) for name in distinct.tolist()], np.uint8)[inverse.ravel()]
    return by_name == _WATER, by_name == _AMINO, by_name == _NUCLEIC


def residue_kinds(
    table: AtomTable,
    heads: NDArray[np.intp],
    residue: NDArray[np.int32],
    element: NDArray[np.uint8],
) -> NDArray[np.uint8]:
    """Classify residues.

    Names decide first, then what the file says of polymers (``label_seq_id``, entity types, TER),
    then the backbone atoms that unknown residues have.

    Args:
        table: The file's atoms.
        heads: (r,) first atom of each residue.
        residue: (n,) residue of each atom.
        element: (n,) atomic numbers.

    Returns:
        (r,) values of :attr:`Molecule.kind`.
    """
    count = len(heads)
    water, amino, nucleic = name_classes(table.residue_name[heads])
    polymer = np.full(count, -1, np.int8) if table.polymer is None else table.polymer[heads]
    hetero = np.zeros(count, bool) if table.hetero is None else table.hetero[heads]
    size = np.diff(np.r_[heads, len(table)])

    def has(*names: bytes) -> NDArray[np.bool_]:
        found = np.zeros(count, bool)
        for name in names:
            found[residue[table.atom_name == name]] = True
        return found

    peptide = has(b"CA") & has(b"C") & has(b"N")
    sugar = has(b"C3'", b"C3*") & has(b"C1'", b"C1*")
    # an unknown heteroatom group that nothing places in a polymer is a ligand
    unknown = ~(water | amino | nucleic) & ((polymer == 1) | ((polymer == -1) & ~hetero))
    free = polymer == 0

    kind = np.full(count, LIGAND, np.uint8)
    kind[(polymer == 1) & unknown & (size > 1)] = OTHER_POLYMER
    kind[(amino & ~free) | (unknown & peptide)] = POLYMER_PROTEIN
    kind[(nucleic & ~free) | (unknown & sugar & ~peptide)] = POLYMER_NUCLEIC
    kind[water] = SOLVENT
    alone = (size == 1) & ~water & ~amino & ~nucleic
    kind[alone & _METALS_AND_HALIDES[element[heads]]] = ION
    return kind
