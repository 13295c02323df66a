"""What is drawn of a cell-scale model: bodies of its structures, and tubes of its curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, Geometry, Material
from scuro.scene.model import Ingredient, MesoscaleModel, Structure
from scuro.scene.regions import Divided, Division

PIECE = 24
"""Curves are traced in pieces of so many segments, whose bounding spheres are small."""
BEADS = 0.2
"""Spacing of the balls along a curve, in radii."""
MATTE = Material(specular=0.0)
"""Highlights on atoms smaller than a pixel would sparkle."""


def divided_bodies(model: MesoscaleModel) -> tuple[Divided, ...]:
    """One body for each part, and one for each piece of a curve, in the tree's order.

    The atom ids of a body number the atoms of its structure; a tube's ids number its curve.
    Nothing is copied: millions of instances are kept once, in the model.
    """
    made = []
    prefixes = (i.path[:k] for i in model.ingredients for k in range(1, len(i.path) + 1))
    first = {prefix: number for number, prefix in enumerate(dict.fromkeys(prefixes))}

    def place(ingredient: Ingredient) -> list[int]:
        return [first[ingredient.path[:k]] for k in range(1, len(ingredient.path) + 1)]

    for ingredient in sorted(model.ingredients, key=place):
        name, path = ingredient.name, ingredient.path
        for part in ingredient.parts:
            if len(part) == 0 or len(part.structure) == 0:
                continue
            geometry = _geometry(part.structure, ingredient.color)
            rotations = np.asarray(part.rotations, np.float32)
            frames = ingredient.frames
            body = Body(geometry, rotations, part.positions, name, path, MATTE, frames=frames)
            chains = Division("chain", part.structure.chain, part.structure.chain_names)
            made.append(Divided(body, (chains,), painted=True))
        for number, curve in enumerate(ingredient.curves):
            for start in range(0, max(len(curve) - 1, 1), PIECE):
                piece = curve[start : start + PIECE + 1]
                tube = _tube(piece, number, ingredient)
                body = Body(tube, name=name, path=path, material=MATTE, frames=ingredient.frames)
                made.append(Divided(body, fibre=True, painted=True))
    return tuple(made)


def _geometry(structure: Structure, color: tuple[int, int, int]) -> Geometry:
    """The structure's spheres and its coarser levels in one colour."""
    full, *coarser = structure.levels
    ids = np.arange(len(structure), dtype=np.int32)
    levels = tuple(
        Geometry(
            spheres=level.spheres,
            sphere_colors=_repeated(color, len(level.spheres)),
            sphere_ids=level.member_of_each,
        )
        for level in coarser
    )
    return Geometry(
        spheres=full.spheres,
        sphere_colors=_repeated(color, len(structure)),
        sphere_ids=ids,
        levels=levels,
    )


def _repeated(color: tuple[int, int, int], count: int) -> NDArray[np.uint8]:
    return np.tile(np.array([*color, 255], np.uint8), (count, 1))


def _tube(points: NDArray[np.float32], number: int, ingredient: Ingredient) -> Geometry:
    """Closely spaced balls along a piece of a curve.

    Balls, not cylinders: a scene of nothing but spheres is traced several times as fast.
    """
    radius = ingredient.curve_radius
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.linspace(0.0, along[-1], int(along[-1] / (BEADS * radius)) + 2)
    spheres = np.full((len(places), 4), radius, np.float32)
    for axis in range(3):
        spheres[:, axis] = np.interp(places, along, points[:, axis])
    return Geometry(
        spheres=spheres,
        sphere_colors=_repeated(ingredient.color, len(spheres)),
        sphere_ids=np.full(len(spheres), number, np.int32),
    )
