"""The chains that traces and cartoons follow: one point a residue, broken where the chain is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import POLYMER_NUCLEIC, POLYMER_PROTEIN, Molecule
from scuro.style.ribbon import ends_of

PROTEIN_STEP, NUCLEIC_STEP = 5.0, 9.0
"""Å. CA atoms of joined residues are 2.9 to 3.9 apart, P atoms 5 to 7.5; more is a gap."""


@dataclass(frozen=True)
class Trace:
    """One atom for each of k residues, in the order of the chains.

    ``starts`` marks the first residue of every run without a gap.
    """

    atoms: NDArray[np.intp]
    """(k,) index of the atom that stands for the residue: CA, or P."""
    residues: NDArray[np.intp]
    """(k,) residue index."""
    starts: NDArray[np.bool_]
    """(k,)"""

    def __len__(self) -> int:
        """Number of residues."""
        return len(self.atoms)

    @property
    def joined(self) -> NDArray[np.intp]:
        """(m,) places i such that residues i and i + 1 are joined."""
        return np.flatnonzero(~self.starts[1:])

    @property
    def ends(self) -> NDArray[np.bool_]:
        """(k,) the last residue of every run."""
        return ends_of(self.starts)


def protein_trace(molecule: Molecule, atoms: NDArray) -> Trace:
    """Runs of CA atoms among the chosen ``atoms``."""
    return _trace(molecule, atoms, POLYMER_PROTEIN, ("CA",), PROTEIN_STEP)


def nucleic_trace(molecule: Molecule, atoms: NDArray) -> Trace:
    """Runs of P atoms; where a 5' end has none, of what comes next along the chain."""
    names = ("P", "O5'", "O5*", "C5'", "C5*", "C4'", "C4*")
    return _trace(molecule, atoms, POLYMER_NUCLEIC, names, NUCLEIC_STEP)


def atom_of_residue(molecule: Molecule, atoms: NDArray, names: tuple[str, ...]) -> NDArray[np.intp]:
    """Per residue of the molecule, the first of ``atoms`` with the earliest of ``names``, or -1."""
    found = np.full(len(molecule.residue_name), -1)
    atom_name = molecule.atom_name[atoms]
    for name in reversed(names):
        matching = atoms[atom_name == name][::-1]  # written last is the first alternate location
        found[molecule.residue[matching]] = matching
    return found


def _trace(
    molecule: Molecule, atoms: NDArray, kind: int, names: tuple[str, ...], step: float
) -> Trace:
    atoms = atoms[molecule.kind[atoms] == kind]
    per_residue = atom_of_residue(molecule, atoms, names)
    residues = np.flatnonzero(per_residue >= 0)
    trace = per_residue[residues]
    starts = np.ones(len(trace), bool)
    if len(trace) > 1:
        a, b = trace[:-1], trace[1:]
        gap = np.linalg.norm(molecule.positions[b] - molecule.positions[a], axis=-1) > step
        other = (molecule.chain[a] != molecule.chain[b]) | (molecule.model[a] != molecule.model[b])
        starts[1:] = gap | other
    return Trace(trace, residues, starts)
