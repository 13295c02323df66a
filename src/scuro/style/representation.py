"""Representations: a molecule becomes spheres, rods and triangles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.geometry import Geometry
from scuro.scene.molecule import SOLVENT, Molecule
from scuro.settings import unknown
from scuro.style.backbone import backbone
from scuro.style.cartoon import cartoon
from scuro.style.color_by import polymer_atoms
from scuro.style.options import Representation
from scuro.style.sticks import ball_and_stick, licorice, spacefill
from scuro.style.surface import surface

SMALL_MOLECULE = 500
"""Atoms, water apart, up to which a molecule without polymers is shown as ball-and-stick."""

Builder = Callable[[Molecule, NDArray, NDArray[np.uint8], Representation], Geometry]

STYLES: dict[str, Builder] = {
    "spacefill": spacefill,
    "ball+stick": ball_and_stick,
    "licorice": licorice,
    "backbone": backbone,
    "cartoon": cartoon,
    "surface": surface,
}
ALIASES = {
    "space-filling": "spacefill", "spacefilling": "spacefill", "vdw": "spacefill",
    "spheres": "spacefill", "sphere": "spacefill", "cpk": "spacefill",
    "ball-and-stick": "ball+stick", "ball&stick": "ball+stick", "ballandstick": "ball+stick",
    "sticks": "licorice", "stick": "licorice", "trace": "backbone", "ribbon": "cartoon",
    "ribbons": "cartoon", "ses": "surface", "molecular-surface": "surface", "msms": "surface",
}  # fmt: skip
"""Names that other programs give the same styles."""


def build_geometry(
    molecule: Molecule,
    style: str,
    atoms: NDArray[np.bool_],
    colors: NDArray[np.uint8],
    options: Representation,
) -> Geometry:
    """What a molecule looks like in one style, in the molecule's own coordinates.

    Args:
        molecule: The molecule, n atoms.
        style: ``auto``, one of :data:`STYLES` or one of its :data:`ALIASES`.
        atoms: (n,) which atoms to show.
        colors: (n, 4) sRGB of every atom, shown or not.
        options: Sizes.

    Returns:
        The geometry; its ids are indices of atoms of ``molecule``. Empty where the style has
        nothing to show (a cartoon of water).
    """
    chosen = np.flatnonzero(atoms)
    return STYLES[style_named(style, molecule)](molecule, chosen, colors, options)


def style_named(style: str, molecule: Molecule) -> str:
    """The style that a user's word means for this molecule.

    Raises:
        SettingsError: There is no such style.
    """
    key = style.strip().lower()
    key = ALIASES.get(key, key)
    if key == "auto":
        return auto_style(molecule)
    if key not in STYLES:
        raise SettingsError(unknown("style", style, ["auto", *STYLES]))
    return key


def auto_style(molecule: Molecule) -> str:
    """Ball-and-stick for small molecules with bonds; space-filling for everything else."""
    size = np.count_nonzero(molecule.kind != SOLVENT)
    small = size <= SMALL_MOLECULE and not polymer_atoms(molecule).any()
    return "ball+stick" if small and len(molecule.bonds) else "spacefill"
