"""What a structure holds, in plain words and numbers: ``scuro info``."""

from __future__ import annotations

from typing import Any

import numpy as np

from scuro.scene.molecule import (
    HELIX,
    ION,
    LIGAND,
    OTHER_POLYMER,
    POLYMER_NUCLEIC,
    POLYMER_PROTEIN,
    SOLVENT,
    STRAND,
    Molecule,
    first_atoms,
)
from scuro.style.elements import SYMBOLS

KIND_NAMES = {
    POLYMER_PROTEIN: "protein",
    POLYMER_NUCLEIC: "nucleic",
    LIGAND: "ligand",
    SOLVENT: "solvent",
    ION: "ion",
    OTHER_POLYMER: "other polymer",
}
MOST_LIGANDS = 50
"""Ligands are listed by name up to this many different ones."""


def describe(molecule: Molecule) -> dict[str, Any]:
    """A summary as plain JSON values.

    Works out bonds and secondary structure where that was not done yet.
    """
    heads = first_atoms(molecule)
    kinds = molecule.kind[heads]
    low, high = molecule.bounds
    numbers, counts = np.unique(molecule.element, return_counts=True)
    ligands, ligand_counts = np.unique(molecule.residue_name[kinds == LIGAND], return_counts=True)
    ions, ion_counts = np.unique(molecule.residue_name[kinds == ION], return_counts=True)
    return {
        "type": "molecule",
        "name": molecule.name,
        "source": molecule.source,
        "atoms": len(molecule),
        "bonds": len(molecule.bonds),
        "residues": len(molecule.residue_name),
        "chains": len(molecule.chain_names),
        "chain_names": list(dict.fromkeys(molecule.chain_names)),
        "models": np.unique(molecule.model).tolist(),
        "atoms_by_kind": {
            name: count
            for kind, name in KIND_NAMES.items()
            if (count := int((molecule.kind == kind).sum()))
        },
        "residues_by_kind": {
            name: count
            for kind, name in KIND_NAMES.items()
            if (count := int((kinds == kind).sum()))
        },
        "elements": {SYMBOLS[z]: int(c) for z, c in zip(numbers, counts, strict=True)},
        "entities": list(molecule.entity_names),
        "ligands": dict(
            zip(ligands[:MOST_LIGANDS].tolist(), ligand_counts[:MOST_LIGANDS].tolist(), strict=True)
        ),
        "ions": dict(zip(ions.tolist(), ion_counts.tolist(), strict=True)),
        "secondary_structure": {
            "from": molecule.secondary_from,
            "helix": int((molecule.secondary == HELIX).sum()),
            "strand": int((molecule.secondary == STRAND).sum()),
        },
        "assemblies": {
            key: {
                "operators": sum(len(p.rotations) for p in parts),
                "chain_instances": sum(len(p.rotations) * len(p.chains) for p in parts),
            }
            for key, parts in molecule.assemblies.items()
        },
        "b_factor": [float(molecule.b_factor.min()), float(molecule.b_factor.max())],
        "bounds": [low.tolist(), high.tolist()],
        "unit": "Å",
        "notes": list(molecule.notes),
    }
