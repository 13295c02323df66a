"""Plausible cell-scale scenes of any size, for tests and for scaling.

Nested spherical compartments: each has a membrane of lipids with proteins in it, an interior
filled without overlaps of the structures' bounding spheres (on a lattice), and one fibre
that wanders inside. Seeded: the same call gives the same scene.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure
from scuro.scene.sphere import fibonacci_sphere
from scuro.settings import SettingsGroup, setting

LIPID_AREA = 65.0
"""Å² of membrane for each lipid of a leaflet."""
LEAFLET = 25.0
"""Å: thickness of one of the membrane's two leaflets."""
PATCH_RADIUS = 48.0
"""Å: membranes are tiled with round patches of this size, which overlap a little."""
PATCH_AREA = 0.72 * np.pi * PATCH_RADIUS**2
"""Å² of membrane for each patch: a round patch must reach the corners of its cell."""
PROTEIN_SHARE = 0.15
"""Proteins in a membrane, as a share of those that would just fit side by side."""
FIBRE_STEP = 34.0
"""Å: one turn of a double helix."""


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
            ingredients.append(_fibre((*place, "interior"), reach, rng))
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
    density = settings.filling * np.mean([len(s) for s in structures]) / spacing**3
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
    points = _shell_lattice(low, high, _spacing(structures), rng)
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
    low: float, high: float, spacing: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Points (n, 3) of a cubic lattice with a random offset, between two radii, slab by slab."""
    offset = rng.random(3) * spacing
    axis = np.arange(-np.ceil(high / spacing) - 1, np.ceil(high / spacing) + 1) * spacing
    slabs = []
    for z in axis + offset[2]:
        reach2 = high**2 - z**2
        if reach2 <= 0:
            continue
        y, x = np.meshgrid(axis + offset[1], axis + offset[0], indexing="ij")
        flat2 = x**2 + y**2
        keep = (flat2 <= reach2) & (flat2 + z**2 >= low**2)
        slabs.append(np.stack([x[keep], y[keep], np.full(keep.sum(), z)], axis=1))
    return np.concatenate(slabs) if slabs else np.zeros((0, 3))


def _part(structure: Structure, positions: NDArray[np.float64], rng: np.random.Generator) -> Part:
    """Instances turned at random, uniformly over all rotations."""
    q = rng.standard_normal((len(positions), 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    return Part(structure, q.astype(np.float32), positions)


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


def lipid_patch(rng: np.random.Generator) -> Structure:
    """A round, flat piece of bilayer across z = 0, each lipid a chain of 22 coarse spheres."""
    side = np.sqrt(LIPID_AREA)
    axis = np.arange(-np.ceil(PATCH_RADIUS / side), np.ceil(PATCH_RADIUS / side) + 1) * side
    x, y = (a.ravel() for a in np.meshgrid(axis, axis))
    seats = np.stack([x, y], axis=1)[x**2 + y**2 <= PATCH_RADIUS**2]
    shape = _lipid()
    atoms = []
    for sign in (1.0, -1.0):
        places = seats + rng.normal(0, 0.15 * side, seats.shape)
        turn = rng.random(len(places)) * 2 * np.pi
        c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
        copies = np.empty((len(places), len(shape), 4))
        copies[..., 0] = c * shape[:, 0] - s * shape[:, 1] + places[:, :1]
        copies[..., 1] = s * shape[:, 0] + c * shape[:, 1] + places[:, 1:]
        copies[..., 2] = sign * shape[:, 2] + rng.normal(0, 0.8, (len(places), 1))
        copies[..., 3] = shape[:, 3]
        atoms.append(copies)
    lipids = np.concatenate(atoms)
    chain = np.repeat(np.arange(len(lipids), dtype=np.int32), len(shape))
    return Structure(
        "lipid patch",
        lipids.reshape(-1, 4).astype(np.float32),
        np.zeros(len(chain), np.uint8),
        chain,
        chain,
        tuple(f"lipid {i + 1}" for i in range(len(lipids))),
    ).centered


def _lipid() -> NDArray[np.float64]:
    """(22, 4): head group and two tails of a lipid of the upper leaflet."""
    head = [[0, 0, z, 2.4] for z in (LEAFLET - 2.4, LEAFLET - 5.0)]
    tails = [
        [x + 0.6 * (-1) ** i, 0, LEAFLET - 7.5 - 1.7 * i, 1.9]
        for x in (-2.2, 2.2)
        for i in range(10)
    ]
    return np.array(head + tails)


def upright(normals: NDArray, rng: np.random.Generator) -> NDArray[np.float32]:
    """Quaternions (n, 4) that turn z to the normals (n, 3), with a random turn about z first."""
    n = np.asarray(normals, np.float64)
    # half-way quaternion from z to n; opposite vectors turn about x
    q = np.stack([-n[:, 1], n[:, 0], np.zeros(len(n)), 1 + n[:, 2]], axis=1)
    q[1 + n[:, 2] < 1e-6] = 1, 0, 0, 0
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    half = rng.random(len(n)) * np.pi
    s, c = np.sin(half), np.cos(half)
    x, y, z, w = q.T
    return np.stack([x * c + y * s, y * c - x * s, w * s + z * c, w * c - z * s], axis=1).astype(
        np.float32
    )


def _fibre(place: tuple[str, ...], reach: float, rng: np.random.Generator) -> Ingredient:
    """A double helix along a random walk: one instance for each turn of it."""
    points = _wander(reach, rng)
    along = np.diff(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    part = Part(_helix_turn(), upright(along, rng), (points[:-1] + points[1:]) / 2)
    return Ingredient((*place, "fibre"), (part,))


def _helix_turn() -> Structure:
    """Ten base pairs of a coarse double helix along z: two strands and a core."""
    step = np.arange(10)
    z = FIBRE_STEP * ((step + 0.5) / 10 - 0.5)
    turn = 2 * np.pi * step / 10
    strands = [
        np.stack([9 * np.cos(turn + a), 9 * np.sin(turn + a), z, np.full(10, 3.6)], axis=1)
        for a in (0.0, 2.4)
    ]
    core = np.stack([0 * z, 0 * z, z, np.full(10, 6.0)], axis=1)
    return Structure.of_spheres("fibre", np.concatenate([*strands, core]))


def _wander(reach: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Points (m, 3) of a walk with random turns that stays within ``reach`` of the origin."""
    points = max(8, min(4000, int(8 * reach / FIBRE_STEP)))
    kicks = rng.standard_normal((points, 3))
    place, heading = np.zeros(3), np.array([1.0, 0.0, 0.0])
    curve = np.empty((points, 3))
    for i in range(points):
        home = -2 * place / reach * (np.linalg.norm(place) / reach) ** 4
        heading = heading + 0.45 * kicks[i] + home
        heading /= np.linalg.norm(heading)
        place = place + FIBRE_STEP * heading
        place *= min(1.0, reach / np.linalg.norm(place))
        curve[i] = place
    return curve
