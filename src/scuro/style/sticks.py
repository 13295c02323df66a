"""Space-filling, ball-and-stick and licorice: atoms as spheres, bonds as capless cylinders.

Builders take the molecule, the indices (k,) of the atoms to show, a colour (n, 4) for every atom of
the molecule, and the settings.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Geometry
from scuro.scene.molecule import Molecule
from scuro.style.options import Representation
from scuro.style.radii import atom_radii

STICKS = {2: ((-0.95, 0.55), (0.95, 0.55)), 3: ((-1.2, 0.4), (0.0, 0.4), (1.2, 0.4))}
"""Sticks of a bond by its order: distance from the middle and radius, in single-stick radii."""


def spacefill(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], options: Representation
) -> Geometry:
    """Spheres of van der Waals radius."""
    radii = atom_radii(molecule)[atoms] * options.sphere_scale
    return Geometry(**balls(molecule, atoms, colors, radii))


def ball_and_stick(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], options: Representation
) -> Geometry:
    """Small spheres and thin sticks; multiple bonds as parallel sticks where their order is known.

    A ball is never thinner than a stick, so that the capless sticks end inside balls.
    """
    radii = np.maximum(atom_radii(molecule)[atoms] * options.ball_scale, options.stick_radius)
    bonds, order = _bonds_among(molecule, atoms)
    parts = []
    for count in (1, 2, 3):
        multiple = np.isin(order, (2, 3)) & options.bond_orders
        chosen = bonds[(order == count) & multiple if count > 1 else ~multiple]
        side = _sideways(molecule, chosen, bonds) * options.stick_radius if count > 1 else 0.0
        for offset, thickness in STICKS.get(count, ((0.0, 1.0),)):
            rods = _rods(molecule, chosen, thickness * options.stick_radius)
            rods[:, :, :3] += np.reshape(side * offset, (-1, 1, 3)) if offset else 0.0
            parts.append((rods, chosen))
    rods, ends = (np.concatenate(p) for p in zip(*parts, strict=True))
    return Geometry(
        **balls(molecule, atoms, colors, radii),
        rods=rods,
        rod_colors=colors[ends],
        rod_ids=ends.astype(np.int32),
    )


def licorice(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], options: Representation
) -> Geometry:
    """Sticks of one thickness with rounded joints; atoms without bonds are small spheres."""
    bonds, _ = _bonds_among(molecule, atoms)
    radii = np.full(len(atoms), options.licorice_radius, np.float32)
    return Geometry(
        **balls(molecule, atoms, colors, radii),
        rods=_rods(molecule, bonds, options.licorice_radius),
        rod_colors=colors[bonds],
        rod_ids=bonds.astype(np.int32),
    )


def balls(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], radii: NDArray
) -> dict[str, Any]:
    """The sphere fields of a geometry for ``atoms`` (k,) with ``radii`` (k,)."""
    spheres = np.empty((len(atoms), 4), np.float32)
    spheres[:, :3] = molecule.positions[atoms]
    spheres[:, 3] = radii
    return dict(spheres=spheres, sphere_colors=colors[atoms], sphere_ids=atoms.astype(np.int32))


def _bonds_among(molecule: Molecule, atoms: NDArray) -> tuple[NDArray, NDArray]:
    """Bonds (m, 2) with both atoms shown, and their orders (m,)."""
    shown = np.zeros(len(molecule), bool)
    shown[atoms] = True
    kept = shown[molecule.bonds].all(axis=1)
    return molecule.bonds[kept], molecule.bond_order[kept]


def _rods(molecule: Molecule, bonds: NDArray, radius: float) -> NDArray[np.float32]:
    rods = np.empty((len(bonds), 2, 4), np.float32)
    rods[:, :, :3] = molecule.positions[bonds]
    rods[:, :, 3] = radius
    return rods


def _sideways(molecule: Molecule, chosen: NDArray, bonds: NDArray) -> NDArray:
    """Unit vectors (k, 3) across the ``chosen`` bonds, in the plane of a third atom bonded on.

    Without such an atom (O=C=O seen from either O, N≡N) any direction across will do.
    """
    pairs = np.concatenate([bonds, bonds[:, ::-1]])
    one, other = np.full((2, len(molecule)), -1)
    one[pairs[:, 0]] = pairs[:, 1]  # the last neighbour written stays ...
    other[pairs[::-1, 0]] = pairs[::-1, 1]  # ... and here the first

    def third(a: NDArray, b: NDArray) -> NDArray:
        return np.where(one[a] != b, one[a], np.where(other[a] != b, other[a], -1))

    a, b = chosen.T
    neighbor = third(a, b)
    neighbor = np.where(neighbor >= 0, neighbor, third(b, a))
    along = unit(molecule.positions[b] - molecule.positions[a])
    toward = np.where(
        (neighbor >= 0)[:, None], molecule.positions[neighbor] - molecule.positions[a], 0.0
    )
    across = toward - (toward * along).sum(-1, keepdims=True) * along
    straight = np.linalg.norm(across, axis=-1) < 0.05
    return unit(np.where(straight[:, None], any_across(along), across))


def unit(vectors: NDArray) -> NDArray:
    """Vectors (..., 3) at length 1; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, 1e-12)


def any_across(directions: NDArray) -> NDArray:
    """Some unit vector perpendicular to each unit direction (..., 3)."""
    smallest = np.abs(directions).argmin(axis=-1)
    return unit(np.cross(directions, np.eye(3)[smallest]))
