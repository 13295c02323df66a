"""What is under the pointer: from the G-buffer's ids to words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, rotation_matrices
from scuro.scene.items import MoleculeItem
from scuro.scene.molecule import Molecule
from scuro.scene.reservoir import ReservoirItem
from scuro.scene.scene import Scene
from scuro.viewer.drawing import Drawn
from scuro.viewer.eyes import eye_at
from scuro.viewer.navigate import Size

_NOTHING = 0xFFFFFFFF


@dataclass(frozen=True)
class Pick:
    """A place on a surface of the scene."""

    item: Any
    """The scene's item it belongs to; ``None`` for bodies of no item."""
    body: Body
    instance: int
    """Which copy of the body."""
    part: int
    """Which of the item's bodies it is: the body itself is replaced when atoms move."""
    element: int
    """Number of the atom (or cell, …); -1 where the surface has none."""
    position: tuple[float, float, float]
    """World position on the surface, from the picture's depth."""

    @property
    def molecule(self) -> Molecule | None:
        """The molecule that :attr:`element` numbers an atom of."""
        is_atom = isinstance(self.item, MoleculeItem) and self.element >= 0
        return self.item.molecule if is_atom else None

    @property
    def anchor(self) -> NDArray[np.float64]:
        """(3,) world position of the atom's centre; of the surface where there is no atom."""
        if self.molecule is None:
            return np.asarray(self.position)
        local = self.molecule.positions[self.element].astype(np.float64)
        turn = rotation_matrices(self.body.rotations[self.instance][None])[0]
        return turn @ local + self.body.positions[self.instance]

    def same_place(self, other: Pick) -> bool:
        """Whether both name the same atom (or cell) of the same copy."""
        if self.element < 0:
            return self.position == other.position
        return self.item is other.item and (self.part, self.instance, self.element) == (
            other.part,
            other.instance,
            other.element,
        )


def pick(drawn: Drawn, scene: Scene, x: float, y: float) -> Pick | None:
    """What a picture shows at (x, y), each 0 to 1 from the upper left; ``None`` if nothing.

    Args:
        drawn: The picture.
        scene: What it shows.
    """
    width, height = drawn.size
    column, row = min(int(x * width), width - 1), min(int(y * height), height - 1)
    if column < 0 or row < 0:
        return None
    ids = drawn.gpu.read_texel(drawn.resources["ids"], column, row)
    if ids[2] == _NOTHING:
        return None
    depth = float(drawn.gpu.read_texel(drawn.resources["surface"], column, row)[3])
    pixel: Size = (column + 0.5, row + 0.5)
    place = eye_at(drawn.eyes(drawn.size), pixel[0]).unproject(pixel, depth)
    for owner, (item, part, body, first) in enumerate(placed_bodies(scene)):
        if owner == int(ids[2]):
            element = int(ids[0].astype(np.int32))
            return Pick(item, body, int(ids[1]) - first, part, element, _tuple(place))
    return None  # the picture is older than the scene


def placed_bodies(scene: Scene) -> Iterator[tuple[Any, int, Body, int]]:
    """Every body in the order of the ids: its item, its number there, it, its first instance."""
    first = 0
    for item, part, body in scene.owners():
        yield item, part, body, first
        first += body.instances


def instance_number(scene: Scene, found: Pick) -> int | None:
    """Number in the scene of the instance that was picked; ``None`` if it is gone."""
    for item, part, body, first in placed_bodies(scene):
        if item is found.item and part == found.part and found.instance < body.instances:
            return first + found.instance
    return None


def sentence(found: Pick) -> str:
    """One line: the atom, its residue, chain and molecule; or the place in a model's tree."""
    molecule = found.molecule
    copy = f" · copy {found.instance + 1}" if found.body.instances > 1 else ""
    if molecule is not None:
        return f"{atom_name(molecule, found.element)}{copy} · {molecule.name}"
    if hasattr(found.item, "describe"):
        return str(found.item.describe(found.element))
    words = " › ".join(found.body.path or (found.body.name,))
    element = f" · atom {found.element + 1}" if found.element >= 0 else ""
    of_cells = found.body.name.endswith(("cells", "slices"))
    if isinstance(found.item, ReservoirItem) and of_cells and found.element >= 0:
        k, j, i = np.unravel_index(found.element, found.item.grid.active.shape)
        element = f" {i + 1}, {j + 1}, {k + 1}"
    return f"{words}{copy}{element}"


def atom_name(molecule: Molecule, atom: int) -> str:
    """``ALA 42 CA · chain A``."""
    residue = molecule.residue[atom]
    number = f"{molecule.residue_number[residue]}{molecule.insertion_code[residue]}"
    chain = molecule.chain_names[molecule.chain[atom]]
    name = f"{molecule.residue_name[residue]} {number} {str(molecule.atom_name[atom]).strip()}"
    return f"{name} · chain {chain}" if chain.strip() else name


def _tuple(v: NDArray) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return x, y, z
