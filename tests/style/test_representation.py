"""Representations: lengths by formula, closed surfaces, ribbons that do not twist."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from meshes import assert_closed_and_outward

from scuro.errors import SettingsError
from scuro.scene.molecule import COIL, HELIX, LIGAND, POLYMER_PROTEIN, STRAND, Molecule
from scuro.style.cartoon import protein_rings
from scuro.style.chains import protein_trace
from scuro.style.options import Representation
from scuro.style.radii import atom_radii
from scuro.style.representation import ALIASES, STYLES, build_geometry, style_named
from scuro.style.ribbon import hermite

STRAND_STEP, HELIX_STEP = 3.3, 1.5


def peptide(points, oxygens, secondary, gap_after=()) -> Molecule:
    """A protein of CA and O atoms only; after the residues in ``gap_after`` a new chain begins."""
    count = len(points)
    n = 2 * count
    positions = np.stack([points, points + oxygens], axis=1).reshape(n, 3)
    chain = np.cumsum(np.isin(np.arange(count) - 1, gap_after))
    ones = np.ones(n)
    return Molecule(
        name="peptide",
        positions=positions.astype(np.float32),
        element=np.tile(np.array([6, 8], np.uint8), count),
        atom_name=np.tile(["CA", "O"], count),
        residue=np.repeat(np.arange(count), 2).astype(np.int32),
        chain=np.repeat(chain, 2).astype(np.int32),
        kind=np.full(n, POLYMER_PROTEIN, np.uint8),
        hetero=np.zeros(n, bool),
        b_factor=ones.astype(np.float32),
        occupancy=ones.astype(np.float32),
        altloc=np.full(n, ""),
        formal_charge=np.zeros(n, np.int8),
        serial=np.arange(n, dtype=np.int32),
        model=ones.astype(np.int32),
        residue_name=np.full(count, "ALA"),
        residue_number=np.arange(count, dtype=np.int32),
        insertion_code=np.full(count, ""),
        chain_names=tuple("ABCDEFGH"[: chain[-1] + 1]),
        chain_entity=np.zeros(chain[-1] + 1, np.int32),
        secondary=np.asarray(secondary, np.uint8),
    )


def strand(count, secondary=None) -> Molecule:
    """A pleated strand along x in the plane z = 0: CA atoms up and down, O atoms left and right."""
    i = np.arange(count)
    turn = np.where(i % 2, 1.0, -1.0)
    points = np.stack([STRAND_STEP * i, 0 * i, 0.9 * turn], axis=1)
    oxygens = np.stack([1.9 + 0 * i, 1.3 * turn, -1.0 * turn], axis=1)
    return peptide(points, oxygens, np.full(count, STRAND) if secondary is None else secondary)


def helix_points(count):
    angle = np.radians(100) * np.arange(count)
    return np.stack(
        [2.3 * np.cos(angle), 2.3 * np.sin(angle), HELIX_STEP * np.arange(count)], axis=1
    )


def helix(count) -> Molecule:
    """An ideal alpha helix along z, O atoms pointing along it."""
    return peptide(helix_points(count), np.tile([0.0, 0.3, 2.3], (count, 1)), [HELIX] * count)


def show(molecule, style, **options):
    everything = np.ones(len(molecule), bool)
    colors = np.tile(np.arange(len(molecule), dtype=np.uint8)[:, None], (1, 4))
    return build_geometry(molecule, style, everything, colors, Representation(**options))


def volume(geometry) -> float:
    a, b, c = geometry.triangles.astype(np.float64).transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6)


def test_spacefill_is_van_der_waals(mixture):
    geometry = show(mixture, "spacefill", sphere_scale=0.5)
    assert np.allclose(geometry.spheres[:, 3], 0.5 * atom_radii(mixture))
    assert (geometry.spheres[:, :3] == mixture.positions).all()
    assert (geometry.sphere_ids == np.arange(len(mixture))).all()
    assert (geometry.sphere_colors[:, 0] == geometry.sphere_ids).all()


def test_only_the_chosen_atoms_are_shown(mixture):
    chosen = np.zeros(len(mixture), bool)
    chosen[[0, 1, 3]] = True
    colors = np.zeros((len(mixture), 4), np.uint8)
    for style in ("spacefill", "ball+stick", "licorice"):
        geometry = build_geometry(mixture, style, chosen, colors, Representation())
        assert geometry.sphere_ids.tolist() == [0, 1, 3]
        if style != "spacefill":
            assert geometry.rod_ids.tolist() == [[0, 1]]  # not the bond to atom 2


def test_licorice_joins_are_as_thick_as_the_sticks(mixture):
    geometry = show(mixture, "licorice", licorice_radius=0.4)
    assert (geometry.spheres[:, 3] == np.float32(0.4)).all()
    assert (geometry.rods[:, :, 3] == np.float32(0.4)).all()
    assert (geometry.rods[:, :, :3] == mixture.positions[mixture.bonds]).all()


@pytest.mark.parametrize(("order", "sticks"), [(0, 1), (1, 1), (2, 2), (3, 3), (4, 1)])
def test_bond_orders_show_as_parallel_sticks(mixture, order, sticks):
    bent = mixture.positions.copy()
    bent[::2, 1] += 1.0  # a zigzag in the plane z = 0
    changes = dict(bond_order=np.full(len(mixture.bonds), order, np.uint8), positions=bent)
    molecule = replace(mixture, **changes)
    rods = show(molecule, "ball+stick").rods
    assert len(rods) == sticks * len(mixture.bonds)
    assert len(show(molecule, "ball+stick", bond_orders=False).rods) == len(mixture.bonds)
    bond = np.tile(bent[mixture.bonds], (sticks, 1, 1))
    offset = rods[:, :, :3] - bond
    along = bond[:, 1] - bond[:, 0]
    assert np.allclose(offset[:, 0], offset[:, 1], atol=1e-5)
    assert np.allclose((offset[:, 0] * along).sum(-1), 0, atol=1e-5)
    in_rows_of_three = np.isin(mixture.bonds, np.flatnonzero(mixture.kind != LIGAND)).all(axis=1)
    assert np.allclose(offset[np.tile(in_rows_of_three, sticks)][:, 0, 2], 0, atol=1e-5)


def test_backbone_follows_the_chain_and_stops_at_gaps():
    line = np.arange(6)[:, None] * [3.8, 0.0, 0.0]
    line[3:] += [10.0, 0, 0]
    molecule = peptide(line, np.tile([0.0, 1.2, 0.0], (6, 1)), [COIL] * 6)
    geometry = show(molecule, "backbone")
    assert geometry.rod_ids.tolist() == [[0, 2], [2, 4], [6, 8], [8, 10]]
    assert geometry.sphere_ids.tolist() == [0, 2, 4, 6, 8, 10]
    two_chains = peptide(np.arange(4)[:, None] * [3.8, 0, 0], line[:4], [COIL] * 4, gap_after=[1])
    assert len(show(two_chains, "backbone").rods) == 2


def test_coil_is_a_tube_of_its_radius():
    line = np.arange(5)[:, None] * [3.8, 0.0, 0.0]
    molecule = peptide(line, np.tile([1.0, 1.2, 0.0], (5, 1)), [COIL] * 5)
    geometry = show(molecule, "cartoon", tube_radius=0.5, sides=16, segments=4)
    assert_closed_and_outward(geometry)
    polygon = 16 / 2 * np.sin(2 * np.pi / 16) * 0.5**2
    assert volume(geometry) == pytest.approx(4 * 3.8 * polygon, rel=1e-3)
    assert (geometry.triangle_ids % 2 == 0).all()  # CA atoms
    nearest = np.rint(geometry.triangles[:, :, 0] / 3.8 - 1e-4)
    middle = np.abs(geometry.triangles[:, :, 0] / 3.8 % 1 - 0.5) > 1e-3
    assert (geometry.triangle_ids[middle] == 2 * nearest[middle]).all()


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 12])
@pytest.mark.parametrize("kind", [COIL, HELIX, STRAND])
def test_fragments_of_any_length_are_closed(count, kind):
    geometry = show(strand(count, [kind] * count), "cartoon")
    if count == 1:
        assert len(geometry.spheres) == 1
        assert len(geometry.triangles) == 0
    else:
        assert_closed_and_outward(geometry)
        assert volume(geometry) > 0


@pytest.mark.parametrize("seed", range(4))
def test_any_mixture_of_structures_is_closed(seed):
    kinds = np.repeat(np.random.default_rng(seed).integers(0, 3, 12), [1, 2, 3, 4, 1, 5] * 2)
    assert_closed_and_outward(show(strand(len(kinds), kinds), "cartoon"))


def test_strand_is_a_flat_bar_with_one_arrow_head():
    options = dict(ribbon_width=2.0, ribbon_thickness=0.4, arrow_width=1.5, tube_radius=0.2)
    geometry = show(strand(12), "cartoon", **options)
    x, y, z = geometry.triangles.reshape(-1, 3).T
    head = (12 - 1 - 1.5) * STRAND_STEP
    inside = (x > 2 * STRAND_STEP) & (x < 9 * STRAND_STEP)
    assert np.abs(y[inside]).max() == pytest.approx(1.0, abs=0.03)  # the width lies along y ...
    assert np.abs(z[inside]).max() < 0.2 + 0.25  # ... and the pleats are almost ironed out
    assert np.abs(y).max() == pytest.approx(1.5, abs=0.05)
    assert abs(x[np.abs(y).argmax()] - head) < 0.3
    assert np.abs(y[x > 11 * STRAND_STEP - 0.01]).max() < 0.25  # the tip


def test_coil_behind_a_strand_does_not_twist_its_arrow():
    molecule = strand(9, [STRAND] * 6 + [COIL] * 3)
    turned = molecule.positions.copy()
    turned[13] = turned[12] + [1.9, 0, 1.3]  # the O of the first coil residue points out of plane
    molecule = replace(molecule, positions=turned)
    atoms = np.arange(len(molecule))
    rings = protein_rings(molecule, atoms, protein_trace(molecule, atoms), 8, Representation())
    head = rings.sides[rings.owners == 10]
    assert np.abs(head[:, 1]).min() > 0.95  # the width stays along y


def test_helix_is_a_band_around_its_axis():
    geometry = show(helix(20), "cartoon", ribbon_width=2.4, ribbon_thickness=0.4)
    assert_closed_and_outward(geometry)
    inner = (geometry.triangles[..., 2] > 6) & (geometry.triangles[..., 2] < 22)
    radius = np.linalg.norm(geometry.triangles[..., :2], axis=-1)[inner]
    assert radius.max() < 2.3 + 0.2 + 0.35
    assert radius.min() > 2.3 - 0.2 - 0.35


def test_curves_turn_evenly():
    points = helix_points(12)
    at, t = np.repeat(np.arange(2, 9), 8), np.tile(np.arange(8) / 8, 7)
    starts = np.arange(12) == 0
    curve, slope = hermite(points, starts, at, t)
    assert np.abs(np.linalg.norm(curve[:, :2], axis=1) - 2.3).max() < 0.12
    nearby, _ = hermite(points, starts, at, t + 1e-6)
    assert np.allclose((nearby - curve) / 1e-6, slope, atol=1e-4)


def test_missing_oxygens_and_missing_ca_do_not_matter():
    molecule = strand(10)
    bare = np.flatnonzero(molecule.atom_name == "CA")
    chosen = np.zeros(len(molecule), bool)
    chosen[bare] = True
    chosen[bare[4]] = False
    colors = np.zeros((len(molecule), 4), np.uint8)
    geometry = build_geometry(molecule, "cartoon", chosen, colors, Representation())
    assert_closed_and_outward(geometry)
    middle = geometry.triangles[..., 0] / STRAND_STEP
    assert not ((middle > 3.3) & (middle < 4.7)).any()


def test_nothing_to_show_is_empty(mixture):
    colors = np.zeros((len(mixture), 4), np.uint8)
    for style in STYLES:
        empty = build_geometry(
            mixture, style, np.zeros(len(mixture), bool), colors, Representation()
        )
        assert len(empty) == 0


def test_auto_looks_at_content_and_size(mixture):
    assert style_named("auto", mixture) == "spacefill"
    drug = replace(mixture, kind=np.full(len(mixture), LIGAND, np.uint8))
    assert style_named("auto", drug) == "ball+stick"
    no_bonds = replace(drug, bonds=drug.bonds[:0], bond_order=drug.bond_order[:0])
    assert style_named("auto", no_bonds) == "spacefill"


def test_names_of_styles(mixture):
    assert set(ALIASES.values()) <= set(STYLES)
    assert style_named("Ball-and-Stick", mixture) == "ball+stick"
    with pytest.raises(SettingsError, match="did you mean 'cartoon'"):
        style_named("carton", mixture)
