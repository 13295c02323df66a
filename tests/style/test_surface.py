"""The solvent-excluded surface against closed forms of one, two and three spheres."""

from __future__ import annotations

import numpy as np
import pytest
from meshes import assert_closed_and_outward

from scuro.errors import SettingsError
from scuro.scene.molecule import LIGAND, Molecule
from scuro.style.options import Representation
from scuro.style.surface import surface, usual_spacing

R, P = 1.7, 1.4


def of(centers, **options):
    """The surface of carbon atoms."""
    centers = np.array(centers, float)
    n = len(centers)
    ones, zeros = np.ones(n), np.zeros(n, np.int32)
    molecule = Molecule(
        name="carbons",
        positions=centers.reshape(n, 3).astype(np.float32),
        element=np.full(n, 6, np.uint8),
        atom_name=np.full(n, "C"),
        residue=zeros,
        chain=zeros,
        kind=np.full(n, LIGAND, np.uint8),
        hetero=np.ones(n, bool),
        b_factor=ones.astype(np.float32),
        occupancy=ones.astype(np.float32),
        altloc=np.full(n, ""),
        formal_charge=np.zeros(n, np.int8),
        serial=zeros,
        model=ones.astype(np.int32),
        residue_name=np.array(["UNK"]),
        residue_number=np.array([1], np.int32),
        insertion_code=np.array([""]),
        chain_names=("A",),
        chain_entity=np.zeros(1, np.int32),
        secondary=np.zeros(1, np.uint8),
    )
    colors = np.tile(np.uint8([10, 20, 30, 255]), (len(centers), 1))
    colors[:, 0] += np.arange(len(centers), dtype=np.uint8)
    return surface(molecule, np.arange(len(centers)), colors, Representation(**options))


def area(geometry):
    a, b, c = geometry.triangles.astype(float).transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def test_of_one_atom_it_is_the_atom():
    found = of([[3.1, -2.2, 0.4]])
    apart = found.triangles - np.float32([3.1, -2.2, 0.4])
    assert np.allclose(np.linalg.norm(apart, axis=-1), R, atol=1e-3)
    assert np.allclose(apart / R, found.triangle_normals, atol=1e-3)
    assert area(found) == pytest.approx(4 * np.pi * R**2, rel=0.02)
    assert_closed_and_outward(found)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1])
def test_between_two_atoms_it_is_the_inside_of_a_torus(turn):
    half = 1.8
    axis = np.array([np.cos(turn), np.sin(turn), 0.0])
    found = of([-half * axis, half * axis], surface_spacing=0.3)
    assert_closed_and_outward(found)
    points = found.triangles.reshape(-1, 3).astype(float)
    along = points @ axis
    across = np.linalg.norm(points - along[:, None] * axis, axis=1)
    far = np.sqrt((R + P) ** 2 - half**2)  # where the probe's centre can touch both
    neck = np.abs(along) < half * P / (R + P)
    assert neck.sum() > 500
    away = np.abs(np.hypot(along[neck], far - across[neck]) - P)
    assert away.max() < 0.4 * 0.3 and away.mean() < 0.05
    ends = np.abs(np.hypot(np.abs(along[~neck]) - half, across[~neck]) - R)
    assert ends.max() < 0.04
    # each side in its own atom's colour
    assert (np.sign(along) == np.where(found.triangle_ids.ravel() == 1, 1, -1))[
        np.abs(along) > 0.1
    ].all()
    assert (found.triangle_colors[..., 0] == 10 + found.triangle_ids).all()


def test_a_probe_that_passes_between_atoms_leaves_them_apart():
    apart = 2 * (R + P) + 0.2
    found = of([[0, 0, 0], [apart, 0, 0]])
    assert area(found) == pytest.approx(2 * 4 * np.pi * R**2, rel=0.02)


def test_a_probe_that_cannot_fall_through_three_atoms_closes_the_hole():
    side = 4.2
    corners = [[0, 0, 0], [side, 0, 0], [side / 2, side * np.sqrt(3) / 2, 0]]
    found = of(corners, surface_spacing=0.3)
    middle = np.mean(corners, axis=0)
    points = found.triangles.reshape(-1, 3) - middle
    near = np.hypot(points[:, 0], points[:, 1]) < 0.25
    height = np.sqrt((R + P) ** 2 - side**2 / 3) - P  # below the ball that rests on all three
    assert near.any()
    assert np.abs(np.abs(points[near, 2]) - height).max() < 0.3
    small = of(corners, surface_spacing=0.3, surface_probe=0.2)
    points = small.triangles.reshape(-1, 3) - middle
    assert np.hypot(points[:, 0], points[:, 1]).min() > 0.3  # a smaller one does fall through


def test_nothing_has_no_surface_and_large_molecules_wider_grids():
    assert len(of(np.zeros((0, 3)))) == 0
    spacings = [usual_spacing(n) for n in (1, 8000, 60_000, 10**7)]
    assert spacings == sorted(spacings) and spacings[0] == spacings[1] == 0.4
    with pytest.raises(SettingsError, match=r"set surface_spacing to .* or more"):
        of([[0, 0, 0], [900, 900, 900]], surface_spacing=0.1)
