"""What colours atoms: one function a scheme, from a molecule to its atoms' colours or values."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import POLYMER_NUCLEIC, POLYMER_PROTEIN, Molecule
from scuro.style import palettes

CARBON, UNKNOWN_ELEMENT = 6, 0
MANY = 5000
"""Atoms of one polymer beyond which colours of elements are noise, not knowledge."""


def by_element(molecule: Molecule) -> NDArray[np.uint8]:
    """Jmol's colours."""
    return palettes.jmol()[molecule.element]


def by_cpk(molecule: Molecule) -> NDArray[np.uint8]:
    """Corey, Pauling and Koltun's colours."""
    return palettes.cpk()[molecule.element]


def by_chain(molecule: Molecule) -> NDArray[np.uint8]:
    """One colour a chain name, so that equal chains of several models agree."""
    _, first, code = np.unique(molecule.chain_names, return_index=True, return_inverse=True)
    order = np.argsort(np.argsort(first))  # palette in order of appearance, not of the alphabet
    return _distinct(order[code][molecule.chain] if len(molecule) else molecule.chain)


def by_entity(molecule: Molecule) -> NDArray[np.uint8]:
    """One colour for all chains of one sequence or substance."""
    return _distinct(molecule.chain_entity[molecule.chain])


def by_model(molecule: Molecule) -> NDArray[np.uint8]:
    """One colour a model."""
    return _distinct(np.unique(molecule.model, return_inverse=True)[1])


def by_residue(molecule: Molecule) -> NDArray[np.uint8]:
    """RasMol's colours of amino acids and bases."""
    return _by_residue_name(molecule, palettes.residues(), palettes.OTHER_RESIDUE)


def by_content(molecule: Molecule) -> NDArray[np.uint8]:
    """What says most at first sight: chains of a complex, elements of all else.

    A small polymer alone keeps its chain's colour on carbon only; ligands, ions and waters show
    elements.
    """
    polymer = polymer_atoms(molecule)
    if len(np.unique(molecule.chain[polymer])) > 1 or np.count_nonzero(polymer) > MANY:
        return by_complex(molecule)
    carbon = polymer & (molecule.element == CARBON)
    return np.where(carbon[:, None], by_chain(molecule), by_element(molecule))


def by_complex(molecule: Molecule) -> NDArray[np.uint8]:
    """Chains of polymers; elements of ligands, ions and waters."""
    return np.where(polymer_atoms(molecule)[:, None], by_chain(molecule), by_element(molecule))


def by_secondary(molecule: Molecule) -> NDArray[np.uint8]:
    """Helix, strand and coil of proteins; nucleic acids in one colour, the rest by element."""
    kind = molecule.kind[:, None]
    rgb = np.where(
        kind == POLYMER_PROTEIN,
        palettes.SECONDARY[molecule.secondary[molecule.residue]],
        by_element(molecule),
    )
    return np.where(kind == POLYMER_NUCLEIC, np.array(palettes.NUCLEIC, np.uint8), rgb)


def by_illustration(molecule: Molecule) -> NDArray[np.uint8]:
    """Goodsell's manner: a pastel for each chain, paler on carbon than on the other elements."""
    count = len(molecule.chain_names)
    carbon = (molecule.element == CARBON)[:, None]
    pale, deep = palettes.pastel(count, 0.86), palettes.pastel(count, 0.77)
    return np.where(carbon, pale[molecule.chain], deep[molecule.chain])


def by_plddt(molecule: Molecule) -> NDArray[np.uint8]:
    """AlphaFold's four bands of confidence, read from the B-factor column."""
    return palettes.PLDDT[np.searchsorted([50.0, 70.0, 90.0], molecule.b_factor, side="right")]


def residue_rank(molecule: Molecule) -> NDArray[np.float32]:
    """Place of each atom's residue along its chain's polymer, 0 to 1; NaN outside polymers."""
    value = np.full(len(molecule), np.nan, np.float32)
    chain_polymer = polymer_atoms(molecule)
    if not chain_polymer.any():
        return value
    residue, chain = molecule.residue[chain_polymer], molecule.chain[chain_polymer]
    first = np.full(len(molecule.chain_names), np.iinfo(np.int32).max)
    last = np.zeros(len(molecule.chain_names), np.int64)
    np.minimum.at(first, chain, residue)
    np.maximum.at(last, chain, residue)
    value[chain_polymer] = (residue - first[chain]) / np.maximum(last - first, 1)[chain]
    return value


def polymer_atoms(molecule: Molecule) -> NDArray[np.bool_]:
    """Which atoms (n,) belong to a protein or a nucleic acid."""
    return (molecule.kind == POLYMER_PROTEIN) | (molecule.kind == POLYMER_NUCLEIC)


def hydropathy(molecule: Molecule) -> NDArray[np.float32]:
    """Kyte and Doolittle's hydropathy of each atom's residue (n,); NaN where it has none."""
    names, code = np.unique(molecule.residue_name, return_inverse=True)
    scale = np.array([palettes.HYDROPATHY.get(n.upper(), np.nan) for n in names], np.float32)
    return scale[code][molecule.residue] if len(molecule) else np.zeros(0, np.float32)


def _distinct(code: NDArray) -> NDArray[np.uint8]:
    return palettes.distinct(int(code.max()) + 1 if len(code) else 0)[code]


def _by_residue_name(
    molecule: Molecule, table: dict[str, tuple[int, int, int]], other: tuple[int, int, int]
) -> NDArray[np.uint8]:
    names, code = np.unique(molecule.residue_name, return_inverse=True)
    colors = np.array([table.get(name.upper(), other) for name in names], np.uint8).reshape(-1, 3)
    return colors[code[molecule.residue]]
