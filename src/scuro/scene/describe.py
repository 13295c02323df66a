"""What a molecule holds, in plain numbers and words, as ``scuro info`` prints it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.scene import molecule as kinds

if TYPE_CHECKING:
    from scuro.scene.molecule import Molecule

_KIND_NAMES = {
    kinds.POLYMER_PROTEIN: "protein",
    kinds.POLYMER_NUCLEIC: "nucleic",
    kinds.LIGAND: "ligand",
    kinds.SOLVENT: "solvent",
    kinds.ION: "ion",
    kinds.OTHER_POLYMER: "other polymer",
}
_SECONDARY_NAMES = {kinds.COIL: "coil", kinds.HELIX: "helix", kinds.STRAND: "strand"}


def describe(molecule: Molecule) -> dict[str, Any]:
    """Counts, chains, ligands, assemblies, extent and the reader's notes."""
    first_atom = np.unique(molecule.residue, return_index=True)[1]
    residue_kind = molecule.kind[first_atom]
    low, high = molecule.bounds.astype(float)
    return {
        "name": molecule.name,
        "atoms": len(molecule),
        "bonds": len(molecule.bonds),
        "residues": len(molecule.residue_name),
        "chains": list(dict.fromkeys(molecule.chain_names)),
        "models": np.unique(molecule.model).tolist(),
        "elements": _elements(molecule),
        "atoms_by_kind": _named(molecule.kind, _KIND_NAMES),
        "residues_by_structure": _named(
            molecule.secondary[residue_kind == kinds.POLYMER_PROTEIN], _SECONDARY_NAMES
        ),
        "secondary_structure_from": molecule.secondary_from,
        "ligands": dict(
            Counter(molecule.residue_name[residue_kind == kinds.LIGAND].tolist()).most_common()
        ),
        "entities": list(molecule.entity_names),
        "assemblies": {name: _assembly(molecule, name) for name in molecule.assemblies},
        "b_factor_range": [float(molecule.b_factor.min()), float(molecule.b_factor.max())]
        if len(molecule)
        else [],
        "bounds": np.round([low, high], 3).tolist(),
        "extent": np.round(high - low, 1).tolist(),
        "unit": "Å",
        "notes": list(molecule.notes),
    }


def _named(values: np.ndarray, names: dict[int, str]) -> dict[str, int]:
    found, counts = np.unique(values, return_counts=True)
    return {names[int(v)]: int(n) for v, n in zip(found, counts, strict=True)}


def _elements(molecule: Molecule) -> dict[str, int]:
    """Atoms of each element, the most frequent first."""
    import gemmi

    found, counts = np.unique(molecule.element, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return {
        gemmi.Element(int(z)).name if z else "unknown": int(n)
        for z, n in zip(found[order], counts[order], strict=True)
    }


def _assembly(molecule: Molecule, name: str) -> dict[str, int]:
    """How many copies of chains an assembly places, and how many atoms that makes."""
    instances = atoms = 0
    for part in molecule.assemblies[name]:
        instances += len(part.positions)
        atoms += len(part.positions) * int(np.isin(molecule.chain, part.chains).sum())
    return {"instances": instances, "atoms": atoms}
