"""What generated cells are made of besides the given structures: lipids and a fibre."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.model import Ingredient, Part, Structure

LIPID_AREA = 65.0
"""Å² of membrane for each lipid of a leaflet."""
LEAFLET = 25.0
"""Å: thickness of one of the membrane's two leaflets."""
PATCH_RADIUS = 48.0
"""Å: membranes are tiled with round patches of this size, which overlap a little."""
PATCH_AREA = 0.55 * np.pi * PATCH_RADIUS**2
"""Å² of membrane for each patch: a round patch must reach the corners of its cell."""
FIBRE_STEP = 34.0
"""Å: one turn of a double helix."""


def lipid_patch(rng: np.random.Generator) -> Structure:
    """A round, flat piece of bilayer across z = 0, each lipid a chain of 15 coarse spheres."""
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
    """(15, 4): head group and two tails of a lipid of the upper leaflet, as united atoms.

    They are as wide as a lipid's area, or one would look through the membrane.
    """
    head = [[2.6 * np.cos(a), 2.6 * np.sin(a), LEAFLET - 3.2, 3.2] for a in (0.5, 2.6, 4.7)]
    tails = [
        [x + 0.8 * (-1) ** i, 0.8 * (-1) ** (i // 2), LEAFLET - 8.0 - 2.9 * i, 2.7]
        for x in (-2.3, 2.3)
        for i in range(6)
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


def fibre(place: tuple[str, ...], reach: float, rng: np.random.Generator) -> Ingredient:
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
