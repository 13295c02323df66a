"""Small molecules made by hand, whose answers can be counted on the fingers."""

from __future__ import annotations

import numpy as np
import pytest

from scuro.scene.molecule import ION, LIGAND, POLYMER_NUCLEIC, POLYMER_PROTEIN, SOLVENT, Molecule

RESIDUES = [
    # chain, number, insertion code, name, kind, secondary, atoms (name, element)
    ("A", -1, "", "MET", POLYMER_PROTEIN, 0, [("N", 7), ("CA", 6), ("C", 6), ("O", 8), ("SD", 16)]),
    ("A", 10, "", "ALA", POLYMER_PROTEIN, 1, [("N", 7), ("CA", 6), ("C", 6), ("O", 8), ("CB", 6)]),
    ("A", 10, "A", "GLY", POLYMER_PROTEIN, 2, [("N", 7), ("CA", 6), ("C", 6), ("O", 8), ("H", 1)]),
    ("b", 5, "", "DA", POLYMER_NUCLEIC, 0, [("P", 15), ("O5'", 8), ("C1'", 6), ("N9", 7)]),
    ("b", 301, "", "HEM", LIGAND, 0, [("FE", 26), ("CHA", 6), ("NA", 7)]),
    ("b", 302, "", "SO4", LIGAND, 0, [("S", 16), ("O1", 8)]),
    ("b", 303, "", "ZN", ION, 0, [("ZN", 30)]),
    ("b", 401, "", "HOH", SOLVENT, 0, [("O", 8)]),
]


@pytest.fixture
def mixture() -> Molecule:
    """Protein, nucleotide, ligands, an ion and water, one atom each 2 Å along x, bonds in rows."""
    rows = [(r, name, z) for r, entry in enumerate(RESIDUES) for name, z in entry[6]]
    n = len(rows)
    residue = np.array([r for r, _, _ in rows], np.int32)
    kind = np.array([entry[4] for entry in RESIDUES], np.uint8)[residue]
    neighbors = np.stack([np.arange(n - 1), np.arange(1, n)], axis=1)
    same = residue[neighbors[:, 0]] == residue[neighbors[:, 1]]
    bonds = neighbors[same].astype(np.int32)
    return Molecule(
        name="mix",
        positions=np.stack([2.0 * np.arange(n), np.zeros(n), np.zeros(n)], 1).astype(np.float32),
        element=np.array([z for _, _, z in rows], np.uint8),
        atom_name=np.array([name for _, name, _ in rows]),
        residue=residue,
        chain=np.array([entry[0] == "b" for entry in RESIDUES], np.int32)[residue],
        kind=kind,
        hetero=(kind != POLYMER_PROTEIN) & (kind != POLYMER_NUCLEIC),
        b_factor=np.linspace(0, 100, n).astype(np.float32),
        occupancy=np.where(np.arange(n) == 4, 0.5, 1.0).astype(np.float32),
        altloc=np.where(np.arange(n) == 4, "B", ""),
        formal_charge=np.zeros(n, np.int8),
        serial=np.arange(101, 101 + n, dtype=np.int32),
        model=np.ones(n, np.int32),
        residue_name=np.array([entry[3] for entry in RESIDUES]),
        residue_number=np.array([entry[1] for entry in RESIDUES], np.int32),
        insertion_code=np.array([entry[2] for entry in RESIDUES]),
        secondary=np.array([entry[5] for entry in RESIDUES], np.uint8),
        chain_names=("A", "b"),
        chain_entity=np.array([0, 1], np.int32),
        bonds=bonds,
        bond_order=np.ones(len(bonds), np.uint8),
    )
