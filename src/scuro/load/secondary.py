"""Secondary structure: as the file gives it, else assigned by P-SEA (Labesse et al. 1997)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.load.places import Lookup, residue_key, residue_keys
from scuro.load.table import SecondaryRanges
from scuro.scene.molecule import COIL, HELIX, POLYMER_PROTEIN, STRAND, Molecule, first_atoms

GAP = 5.0
"""Å between neighbouring alpha carbons above which the chain is broken."""


def from_ranges(ranges: SecondaryRanges, molecule: Molecule) -> NDArray[np.uint8]:
    """Per residue, from the file's helices and strands; strands win where both claim a residue."""
    count = len(molecule.residue_name)
    secondary = np.full(count, COIL, np.uint8)
    keys, models = residue_keys(molecule)
    lookup = Lookup(keys)
    kind = molecule.kind[first_atoms(molecule)]
    for model in range(models):
        start = residue_key(ranges.chain, ranges.first, ranges.first_insertion, model)
        end = residue_key(ranges.chain, ranges.last, ranges.last_insertion, model)
        first, last = lookup.find(start), lookup.find(end)
        good = (first >= 0) & (last >= first)
        for value in (HELIX, STRAND):
            chosen = good & (ranges.kind == value)
            # +1 where a range begins, -1 behind its end: the running sum counts open ranges
            change = np.zeros(count + 1, np.int64)
            np.add.at(change, first[chosen], 1)
            np.add.at(change, last[chosen] + 1, -1)
            secondary[np.cumsum(change)[:-1] > 0] = value
    secondary[kind != POLYMER_PROTEIN] = COIL
    return secondary


def assign(molecule: Molecule) -> NDArray[np.uint8]:
    """Per residue, from the alpha carbons' geometry by biotite's P-SEA."""
    secondary = np.full(len(molecule.residue_name), COIL, np.uint8)
    alpha = np.flatnonzero((molecule.atom_name == "CA") & (molecule.kind == POLYMER_PROTEIN))
    # one per residue, whatever alternate locations are loaded
    alpha = alpha[np.unique(molecule.residue[alpha], return_index=True)[1]]
    if len(alpha) < 5:
        return secondary
    from biotite.structure import AtomArray, annotate_sse

    position = molecule.positions[alpha]
    broken = np.linalg.norm(np.diff(position, axis=0), axis=1) > GAP
    for column in (molecule.chain, molecule.model):
        broken |= column[alpha][1:] != column[alpha][:-1]
    for segment in np.split(np.arange(len(alpha)), np.flatnonzero(broken) + 1):
        if len(segment) < 5:
            continue  # shorter than the shortest element that P-SEA knows
        atoms = AtomArray(len(segment))
        atoms.coord = position[segment]
        atoms.atom_name[:] = "CA"
        atoms.res_name[:] = "ALA"  # any amino acid: only the geometry counts
        atoms.res_id = np.arange(1, len(segment) + 1)
        atoms.chain_id[:] = "A"
        code = annotate_sse(atoms)
        residue = molecule.residue[alpha[segment]]
        secondary[residue[code == "a"]] = HELIX
        secondary[residue[code == "b"]] = STRAND
    return secondary
