"""Plausible cell-scale scenes of any size, for tests and for scaling.

Nested spherical compartments: each has a membrane of lipids with proteins in it, an interior
filled without overlaps of the structures' bounding spheres (on a turned and shaken lattice of the
densest packing), and one fibre
that wanders inside. Seeded: the same call gives the same scene.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.generate_parts import (
    FIBRE_STEP,
    LEAFLET,
    PATCH_AREA,
    fibre,
    lipid_patch,
    upright,
)
from scuro.scene.geometry import rotation_matrices
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure
from scuro.scene.sphere import fibonacci_sphere
from scuro.settings import SettingsGroup, setting

PROTEIN_SHARE = 0.15
"""Proteins in a membrane, as a share of those that would just fit side by side."""


ROOM = 1.08
"""Distance of lattice places, in diameters of the largest structure: the rest is for shaking."""


class GenerateSettings(SettingsGroup):
    """What ``scuro make-mesoscale`` builds."""

    atoms: float = setting(1e6, "atoms in view to aim for", low=1e3, high=1e13)
    compartments: int = setting(2, "nested compartments", low=1, high=8)
    filling: float = setting(
        0.6, "share of the lattice places in each interior that are taken", low=0.01, high=1.0
    )
    lipids: bool = setting(True, "cover the membranes with lipids")
    fibre: bool = setting(True, "put a fibre into the innermost compartment")
    seed: int = setting(1, "seed of the random numbers", low=0, high=2**31 - 1)


def generate(
    structures: Sequence[Structure], settings: GenerateSettings | None = None
) -> MesoscaleModel:
    """Build a scene with about ``settings.atoms`` atoms out of copies of ``structures``.

    Args:
        structures: What fills the compartments; the first goes into the membranes too.

    Raises:
        SettingsError: No structure has atoms.
    """
    settings = settings or GenerateSettings()
    usable = [s.centered for s in structures if len(s)]
    if not usable:
        raise SettingsError("a generated scene needs at least one structure with atoms")
    radius = _radius_for(usable, settings)
    rng = np.random.default_rng(settings.seed)
    ingredients: list[Ingredient] = []
    place: tuple[str, ...] = ("generated",)
    spacing = _spacing(usable)
    for shell in range(settings.compartments):
        low, high = _filled_shell(radius, shell, settings, spacing)
        place = (*place, f"compartment {shell + 1}")
        ingredients += _membrane(place, usable[0], radius * _shrink(shell), settings, rng)
        ingredients += _interior(place, usable, low, high, settings, rng)
    if settings.fibre:
        reach = radius * _shrink(settings.compartments - 1) - 3 * LEAFLET
        if reach > FIBRE_STEP:
            ingredients.append(fibre((*place, "interior"), reach, rng))
    return MesoscaleModel("generated", tuple(ingredients))


def _shrink(shell: int) -> float:
    """Radius of a compartment as a share of the outermost one's."""
    return 0.55**shell


def _filled_shell(
    radius: float, shell: int, settings: GenerateSettings, spacing: float
) -> tuple[float, float]:
    """Inner and outer radius of the places for structures between two membranes."""
    margin = 2 * LEAFLET + spacing / 2
    inner = radius * _shrink(shell + 1) + margin if shell + 1 < settings.compartments else 0.0
    return inner, max(radius * _shrink(shell) - margin, 0.0)


def _spacing(structures: Sequence[Structure]) -> float:
    """Lattice constant at which any two structures just fit side by side."""
    return 2 * max(_reach(s) for s in structures)


def _reach(structure: Structure) -> float:
    spheres = structure.spheres
    return float((np.linalg.norm(spheres[:, :3], axis=1) + spheres[:, 3]).max())


def _radius_for(structures: Sequence[Structure], settings: GenerateSettings) -> float:
    """Radius of the outermost compartment for the number of atoms wanted, by bisection."""
    spacing = _spacing(structures)
    seats = np.sqrt(2) / (ROOM * spacing) ** 3
    density = float(settings.filling * seats * np.mean([len(s) for s in structures]))
    area = 0.0
    if settings.lipids:
        patch = lipid_patch(np.random.default_rng(settings.seed))
        area = 4 * np.pi * len(patch) / PATCH_AREA
    proteins = 4 * np.pi * PROTEIN_SHARE * len(structures[0]) / _spacing(structures[:1]) ** 2

    def atoms(radius: float) -> float:
        total = 0.0
        for shell in range(settings.compartments):
            low, high = _filled_shell(radius, shell, settings, spacing)
            total += density * 4 / 3 * np.pi * max(high**3 - low**3, 0.0)
            total += (area + proteins) * (radius * _shrink(shell)) ** 2
        return total

    low, high = 0.0, 1e7
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if atoms(middle) < settings.atoms else (low, middle)
    return max(high, 1.5 * spacing + 4 * LEAFLET)


def _interior(
    place: tuple[str, ...],
    structures: Sequence[Structure],
    low: float,
    high: float,
    settings: GenerateSettings,
    rng: np.random.Generator,
) -> list[Ingredient]:
    """Structures on a lattice with a random offset, between two radii."""
    spacing = _spacing(structures)
    points = _shell_lattice(low, high, ROOM * spacing, rng)
    points += (ROOM - 1) / 2 * spacing * _in_ball(len(points), rng)
    points = points[rng.random(len(points)) < settings.filling]
    which = rng.integers(0, len(structures), len(points))
    return [
        Ingredient((*place, "interior", _name(structures, k)), (_part(s, points[which == k], rng),))
        for k, s in enumerate(structures)
        if (which == k).any()
    ]


def _name(structures: Sequence[Structure], k: int) -> str:
    """The structure's name; numbered where two share it."""
    name = structures[k].name or f"structure {k + 1}"
    return name if [s.name for s in structures].count(name) == 1 else f"{name} {k + 1}"


def _shell_lattice(
    low: float, high: float, nearest: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Points (n, 3) of a face-centred cubic lattice, turned at random, between two radii.

    Layer by layer: three squares of points, shifted by half a cell each way.
    """
    turn = rotation_matrices(_random_turns(1, rng))[0].T
    cell = np.sqrt(2) * nearest
    offset = rng.random(3) * cell
    axis = np.arange(-np.ceil(high / cell) - 1, np.ceil(high / cell) + 1) * cell
    layers = []
    for half in range(2 * len(axis)):
        z = axis[0] + half * cell / 2 + offset[2]
        if z**2 >= high**2:
            continue
        flat = []
        for shift in ((0.0, 0.0), (0.5, 0.5)) if half % 2 == 0 else ((0.5, 0.0), (0.0, 0.5)):
            x, y = np.meshgrid(
                axis + offset[0] + shift[0] * cell, axis + offset[1] + shift[1] * cell
            )
            flat.append(np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1))
        points = np.concatenate(flat)
        square = (points**2).sum(axis=1)
        layers.append(points[(square <= high**2) & (square >= low**2)])
    return np.concatenate(layers) @ turn if layers else np.zeros((0, 3))


def _in_ball(count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Points (count, 3) spread evenly over the unit ball."""
    directions = rng.standard_normal((count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * np.cbrt(rng.random((count, 1)))


def _random_turns(count: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """Quaternions (count, 4), uniform over all rotations."""
    q = rng.standard_normal((count, 4))
    return (q / np.linalg.norm(q, axis=1, keepdims=True)).astype(np.float32)


def _part(structure: Structure, positions: NDArray[np.float64], rng: np.random.Generator) -> Part:
    """Instances turned at random, uniformly over all rotations."""
    return Part(structure, _random_turns(len(positions), rng), positions)


def _membrane(
    place: tuple[str, ...],
    protein: Structure,
    radius: float,
    settings: GenerateSettings,
    rng: np.random.Generator,
) -> list[Ingredient]:
    """Two leaflets of lipids, heads out and heads in, pierced by proteins."""
    count = max(4, int(4 * np.pi * radius**2 / _spacing([protein]) ** 2 * PROTEIN_SHARE))
    spots = fibonacci_sphere(count)
    turns = upright(spots, rng)
    made = [
        Ingredient((*place, "surface", protein.name or "protein"),
                   (Part(protein, turns, spots * radius),))
    ]  # fmt: skip
    if settings.lipids:
        patch = lipid_patch(rng)
        # a gap about as wide as the protein: its radius of gyration
        gap = np.sqrt((protein.spheres[:, :3].astype(np.float64) ** 2).sum(axis=1).mean())
        seats = fibonacci_sphere(max(4, int(4 * np.pi * radius**2 / PATCH_AREA)))
        seats = seats[_farther_than(seats, spots, gap / radius)]
        part = Part(patch, upright(seats, rng), seats * radius)
        made.append(Ingredient((*place, "membrane", "lipids"), (part,)))
    return made


def _farther_than(points: NDArray, centers: NDArray, distance: float) -> NDArray[np.bool_]:
    """(n,) which points (n, 3) of the unit sphere are farther than this from all centres (m, 3).

    In chunks of points, so that the table of distances stays small.
    """
    limit = 1 - distance**2 / 2
    rows = max(1, 4_000_000 // max(len(centers), 1))
    return np.concatenate(
        [
            (points[i : i + rows] @ centers.T).max(axis=1) < limit
            for i in range(0, len(points), rows)
        ]
    )
