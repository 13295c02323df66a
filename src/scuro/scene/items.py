"""What a scene holds: molecules, cell-scale models and volumes, each with how it is shown.

Reservoirs have a file of their own: see :mod:`scuro.scene.reservoir`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.geometry import Body, Material
from scuro.scene.model import MesoscaleModel
from scuro.scene.molecule import Molecule
from scuro.scene.regions import Divided
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction


@dataclass(frozen=True)
class Shown:
    """One representation of some atoms of a molecule."""

    style: str = "auto"
    select: str = "auto"
    color: str = "auto"
    material: Material = field(default_factory=Material)
    clipped: bool = True
    options: tuple[tuple[str, Any], ...] = ()
    """Values of :class:`scuro.style.representation.Representation` that differ from its own."""
    context: bool = False
    """Whether it is drawn in simple light: see :attr:`scuro.scene.geometry.Body.context`."""


@dataclass(eq=False)
class MoleculeItem:
    """A molecule and its representations; placed once, or by a biological assembly."""

    molecule: Molecule
    shown: list[Shown] = field(default_factory=list)
    assembly: str | None = None
    _bodies: dict[tuple, tuple[Body, ...]] = field(default_factory=dict, repr=False)

    def bodies(self) -> list[Body]:
        """One body a representation and assembly part; unchanged ones are the same objects."""
        found: list[Body] = []
        kept: dict[tuple, tuple[Body, ...]] = {}
        for key, shown in self._keys().items():
            made = self._bodies.get(key) or tuple(self._build(shown))
            kept[key] = made
            found += made
        self._bodies = kept
        return found

    def _keys(self) -> dict[tuple, Shown]:
        """Each representation by all that its bodies depend on."""
        shown = self.shown or [Shown()]
        return {(id(self.molecule), one, self.assembly): one for one in shown}

    @property
    def built(self) -> bool:
        """Whether :meth:`bodies` finds all of them made."""
        return all(key in self._bodies for key in self._keys())

    def twin(self) -> MoleculeItem:
        """An item of the same molecule and the same bodies, to be shown otherwise."""
        return MoleculeItem(self.molecule, list(self.shown), self.assembly, dict(self._bodies))

    def take(self, twin: MoleculeItem) -> None:
        """Know the bodies that a twin has made, too, until :meth:`bodies` is called."""
        self._bodies |= twin._bodies

    @property
    def atoms(self) -> int:
        """Atoms with all their copies in the biological assembly."""
        molecule = self.molecule
        if self.assembly is None:
            return len(molecule)
        parts = molecule.assemblies.get(self.assembly, ())
        return sum(len(p.rotations) * int(np.isin(molecule.chain, p.chains).sum()) for p in parts)

    @property
    def left_out(self) -> int:
        """Atoms of water and salt about the structure that no representation asks for."""
        from scuro.style.bath import bath

        if any(shown.select != "auto" for shown in self.shown):
            return 0
        return int(np.count_nonzero(bath(self.molecule)))

    @property
    def unassembled(self) -> tuple[str, int]:
        """Name and copies of the largest biological assembly, where the file's atoms are shown.

        No name and one copy if an assembly is shown or none repeats anything.
        """
        if self.assembly is not None:
            return "", 1
        sizes = {
            name: max((len(part.rotations) for part in parts), default=1)
            for name, parts in self.molecule.assemblies.items()
        }
        name = max(sizes, key=lambda known: sizes[known], default="")
        return (name, sizes[name]) if sizes.get(name, 1) > 1 else ("", 1)

    def divided(self, parts: str = "") -> list[Divided]:
        """The bodies with their division into a tree of parts, chains and residues."""
        from scuro.scene.selection_tree import divisions, parse_tree

        found = tuple(divisions(self.molecule, parse_tree(parts)))
        return [Divided(body, found) for body in self.bodies()]

    def _build(self, shown: Shown) -> list[Body]:
        from scuro.style.color import atom_colors
        from scuro.style.representation import Representation, build_geometry
        from scuro.style.selection import select

        molecule = self.molecule
        mask = select(molecule, shown.select)
        assembled = molecule.assemblies.get(self.assembly or "", ())
        copies = sum(len(part.rotations) for part in assembled)
        colors = atom_colors(molecule, shown.color, copies)
        options = Representation(**dict(shown.options))
        name = molecule.name
        if self.assembly is None:
            geometry = build_geometry(molecule, shown.style, mask, colors, options)
            return [
                Body(geometry, name=name, path=(name,), material=shown.material,
                     clipped=shown.clipped, context=shown.context)
            ]  # fmt: skip
        if self.assembly not in molecule.assemblies:
            known = ", ".join(molecule.assemblies) or "none"
            raise SettingsError(
                f"{name} has no biological assembly '{self.assembly}': known: {known}"
            )
        bodies = []
        for part in molecule.assemblies[self.assembly]:
            here = mask & np.isin(molecule.chain, part.chains)
            if not here.any():
                continue
            geometry = build_geometry(molecule, shown.style, here, colors, options)
            bodies.append(
                Body(geometry, part.rotations, part.positions, name, (name,), shown.material,
                     shown.clipped, context=shown.context)
            )  # fmt: skip
        return bodies


@dataclass(eq=False)
class MesoscaleItem:
    """A cell-scale model; its ingredients are coloured by their place in the hierarchy."""

    model: MesoscaleModel
    _colored: MesoscaleModel | None = field(default=None, repr=False)

    @property
    def colored(self) -> MesoscaleModel:
        """The model with a colour for each ingredient."""
        if self._colored is None:
            from scuro.style.hierarchy import hierarchy_colors

            paths = [i.path for i in self.model.ingredients]
            self._colored = self.model.painted(hierarchy_colors(paths))
        return self._colored

    def bodies(self) -> list[Body]:
        """One body a structure and ingredient; the same objects every time."""
        return list(self.colored.bodies())

    def divided(self, parts: str = "") -> tuple[Divided, ...]:
        """The bodies with their division into chains; ``parts`` are those of molecules."""
        return self.colored.divided


@dataclass(eq=False)
class VolumeItem:
    """A scalar volume and its transfer function."""

    volume: Volume
    shown: TransferFunction | None = None
    """Colour and opacity; those of the settings if None."""
    seen: NDArray[np.float64] | None = None
    """(8, 3) corners of the box in which it shows; all of it if None. Cameras are fitted to it."""

    @property
    def outline(self) -> NDArray[np.float64]:
        """(8, 3) world corners of what is seen of it."""
        if self.seen is not None:
            return self.seen
        return np.stack(np.meshgrid(*self.volume.bounds.T, indexing="ij"), -1).reshape(-1, 3)
