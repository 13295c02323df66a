"""A cell-scale (mesoscale) model: few structures, placed many times, in a tree.

The tree runs root → compartment → … → ingredient → instance → chain and residue → atom. Everything
above the instances is spelled out by each ingredient's ``path``; instances are rows of the
placement arrays; chains, residues and atoms are those of the shared structure.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, Frames, placed_box
from scuro.scene.lod import Level, levels_of_detail
from scuro.scene.regions import Divided

COUNTS = ("instances", "chains", "residues", "atoms")
"""What is counted of every node of the tree."""
DEFAULT_COLOR = (180, 180, 180)
"""sRGB of ingredients nobody has coloured."""


@dataclass(frozen=True, eq=False)
class Structure:
    """The atoms of one ingredient in its own frame (compared and cached by identity)."""

    name: str
    spheres: NDArray[np.float32]
    """(n, 4): centre x, y, z and radius, ångström."""
    element: NDArray[np.uint8]
    """(n,) atomic numbers, 0 where the spheres are not atoms."""
    residue: NDArray[np.int32]
    """(n,) zero-based residue of each atom; residues are not shared between chains."""
    chain: NDArray[np.int32]
    """(n,) zero-based index into ``chain_names``."""
    chain_names: tuple[str, ...] = ("",)
    source: str = ""
    stand_in: bool = False
    """Whether the file was missing and spheres stand for it."""

    def __len__(self) -> int:
        """Number of atoms."""
        return len(self.spheres)

    @classmethod
    def of_spheres(
        cls, name: str, spheres: NDArray, source: str = "", stand_in: bool = False
    ) -> Structure:
        """A structure without chemistry: one chain of one residue. ``spheres`` is (n, 4)."""
        n = len(spheres)
        zeros = np.zeros(n, np.int32)
        return cls(
            name, np.ascontiguousarray(spheres, np.float32), np.zeros(n, np.uint8), zeros, zeros,
            ("",), source, stand_in,
        )  # fmt: skip

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """The structure at full and at ever coarser detail."""
        return levels_of_detail(self.spheres)

    def moved(self, rotation: NDArray, offset: NDArray) -> Structure:
        """Turned by a (3, 3) matrix and then shifted."""
        spheres = self.spheres.copy()
        centers = spheres[:, :3].astype(np.float64) @ np.asarray(rotation, np.float64).T
        spheres[:, :3] = centers + np.asarray(offset, np.float64)
        return replace(self, spheres=spheres)

    @cached_property
    def centroid(self) -> NDArray[np.float64]:
        """(3,) unweighted mean of the atoms' centres."""
        if len(self) == 0:
            return np.zeros(3)
        return self.spheres[:, :3].mean(axis=0, dtype=np.float64)

    @cached_property
    def centered(self) -> Structure:
        """Moved so that the centroid is the origin."""
        return self.moved(np.eye(3), -self.centroid)


@dataclass(frozen=True, eq=False)
class Part:
    """A structure and where its instances are.

    Most ingredients have one part; a lipid membrane has one for each conformation of a lipid.
    """

    structure: Structure
    rotations: NDArray[np.float32]
    """(k, 4) unit quaternions x, y, z, w."""
    positions: NDArray[np.float64]
    """(k, 3) world positions of the structure's origin, ångström."""

    def __len__(self) -> int:
        """Number of instances."""
        return len(self.positions)


@dataclass(frozen=True, eq=False)
class Ingredient:
    """One kind of molecule in one compartment."""

    path: tuple[str, ...]
    """Root first, the ingredient's own name last."""
    parts: tuple[Part, ...] = ()
    curves: tuple[NDArray[np.float32], ...] = ()
    """Fibres: (m, 3) points each, drawn as tubes."""
    curve_radius: float = 10.0
    """Radius of the tubes, ångström."""
    description: str = ""
    color: tuple[int, int, int] = DEFAULT_COLOR
    """sRGB."""
    frames: Frames | None = None
    """Where the model that this is a part of stands, if it is itself placed often: a virus in a
    cell. Parts and curves are then in that model's own space."""

    @property
    def copies(self) -> int:
        """How often the whole ingredient stands in the world."""
        return 1 if self.frames is None else len(self.frames)

    @property
    def name(self) -> str:
        return self.path[-1]

    @property
    def instances(self) -> int:
        """Placed copies; every curve counts as one."""
        return self.copies * (sum(map(len, self.parts)) + len(self.curves))

    @property
    def chains(self) -> int:
        """Chains in view."""
        return self.copies * sum(
            len(part) * len(np.unique(part.structure.chain)) for part in self.parts
        )

    @property
    def residues(self) -> int:
        """Residues in view; those of a structure are numbered without gaps."""
        return self.copies * sum(
            len(part) * (int(part.structure.residue.max()) + 1)
            for part in self.parts
            if len(part.structure)
        )

    @property
    def atoms(self) -> int:
        """Atoms in view: stored atoms times copies."""
        return self.copies * sum(len(part) * len(part.structure) for part in self.parts)


@dataclass
class Node:
    """A node of the tree above the instances, with the counts of all that is below it."""

    name: str
    children: dict[str, Node] = field(default_factory=dict)
    ingredient: Ingredient | None = None
    instances: int = 0
    chains: int = 0
    residues: int = 0
    atoms: int = 0

    def walk(self, depth: int = 0) -> Iterator[tuple[int, Node]]:
        """Depth and node, parents first."""
        yield depth, self
        for child in self.children.values():
            yield from child.walk(depth + 1)


@dataclass(frozen=True, eq=False)
class MesoscaleModel:
    """Ingredients and their places. Ångström, right-handed."""

    name: str
    ingredients: tuple[Ingredient, ...]
    source: str = ""
    notes: tuple[str, ...] = ()
    """What the reader mended, dropped or could not find, one sentence each."""

    @property
    def instances(self) -> int:
        return sum(i.instances for i in self.ingredients)

    @property
    def atoms(self) -> int:
        return sum(i.atoms for i in self.ingredients)

    @property
    def stored_atoms(self) -> int:
        """Atoms kept in memory: each structure once."""
        seen = {id(p.structure): len(p.structure) for i in self.ingredients for p in i.parts}
        return sum(seen.values())

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) box around the instances' origins and the curves' points, widened by each
        structure's reach."""
        boxes: list[NDArray] = []
        for ingredient in self.ingredients:
            first = len(boxes)
            for part in ingredient.parts:
                if len(part) and len(part.structure):
                    spheres = part.structure.spheres
                    reach = (np.linalg.norm(spheres[:, :3], axis=1) + spheres[:, 3]).max()
                    boxes.append(part.positions.min(axis=0) - reach)
                    boxes.append(part.positions.max(axis=0) + reach)
            for curve in ingredient.curves:
                boxes.append(curve.min(axis=0) - ingredient.curve_radius)
                boxes.append(curve.max(axis=0) + ingredient.curve_radius)
            if ingredient.frames is not None and len(boxes) > first:
                own = np.stack([np.min(boxes[first:], axis=0), np.max(boxes[first:], axis=0)])
                frames = ingredient.frames
                boxes[first:] = list(placed_box(own, frames.rotations, frames.positions))
        if not boxes:
            return np.zeros((2, 3))
        return np.stack([np.min(boxes, axis=0), np.max(boxes, axis=0)])

    @property
    def compartments(self) -> int:
        """Inner nodes of the tree below the root."""
        return sum(bool(node.children) for depth, node in self.tree.walk() if depth)

    @cached_property
    def tree(self) -> Node:
        """The hierarchy from the root to the ingredients."""
        root = Node(self.name)
        for ingredient in self.ingredients:
            node = root
            for name in ("", *ingredient.path[1:]):
                node = node.children.setdefault(name, Node(name)) if name else root
                for count in COUNTS:
                    setattr(node, count, getattr(node, count) + getattr(ingredient, count))
            node.ingredient = ingredient
        return root

    def outline(self) -> list[str]:
        """The tree with counts, a line a node."""
        rows = [
            ("  " * depth + node.name, *(f"{getattr(node, count):,}" for count in COUNTS))
            for depth, node in self.tree.walk()
        ]
        rows.insert(0, ("", *COUNTS))
        wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return [
            "  ".join([label.ljust(wide[0]), *map(str.rjust, counts, wide[1:])])
            for label, *counts in rows
        ]

    def summary(self) -> dict[str, Any]:
        """What ``scuro info`` prints: counts, size, the tree, notes."""
        return {
            "name": self.name,
            "instances": self.instances,
            "atoms": self.atoms,
            "stored_atoms": self.stored_atoms,
            "ingredients": len(self.ingredients),
            "compartments": self.compartments,
            "fibres": sum(len(i.curves) for i in self.ingredients),
            "bounds": np.round(self.bounds, 2).tolist(),
            "hierarchy": self.outline(),
            "notes": list(self.notes),
        }

    def painted(self, colors: NDArray[np.uint8]) -> MesoscaleModel:
        """The same model with other colours, sRGB (ingredients, 3)."""
        return replace(
            self,
            ingredients=tuple(
                replace(ingredient, color=tuple(color))
                for ingredient, color in zip(self.ingredients, colors.tolist(), strict=True)
            ),
        )

    def bodies(self) -> tuple[Body, ...]:
        """One body for each part, and one for each piece of a curve; made once.

        The atom ids of a body number the atoms of its structure; a tube's ids number its curve.
        """
        return tuple(d.body for d in self.divided)

    @cached_property
    def divided(self) -> tuple[Divided, ...]:
        """The bodies, and their division into chains, in the tree's order: every subtree is a run
        of objects."""
        from scuro.scene.model_bodies import divided_bodies

        return divided_bodies(self)
