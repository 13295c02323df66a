"""What a picture leaves out unless it is asked for: the water about a structure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import ION, SOLVENT, Molecule
from scuro.style.color_by import polymer_atoms
from scuro.style.elements import NUMBER_OF

_SALT = ("NA", "K", "CL")
"""Ions that neutralise a simulated system."""


def bath(molecule: Molecule) -> NDArray[np.bool_]:
    """Atoms (n,) that hide what a structure is about: water about a polymer or a solute.

    In crystals only where there is a polymer; in simulated systems, most of whose atoms are water,
    with the salt that is dissolved in it.
    """
    water = molecule.kind == SOLVENT
    if 2 * np.count_nonzero(water) > len(molecule):
        salt = [NUMBER_OF[symbol] for symbol in _SALT]
        water |= (molecule.kind == ION) & np.isin(molecule.element, salt)
        return water & ~water.all()
    return water & polymer_atoms(molecule).any()
