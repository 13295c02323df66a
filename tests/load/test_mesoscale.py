"""Cell-scale models from real files: counts, places, and the same virus from several forms."""

from __future__ import annotations

import numpy as np
import pytest

from scuro.app.output import scene_counts
from scuro.errors import LoadError
from scuro.load import load
from scuro.scene.geometry import rotation_matrices
from scuro.scene.model import MesoscaleModel
from scuro.scene.scene import Scene

CA = ("HIV1_CA_mono_0_1_0", "surf_1__HIV1_CA_mono", "Capsid")
"""What the forms call the capsid's protein."""


@pytest.fixture(scope="module")
def blood(shared) -> MesoscaleModel:
    return load(shared / "mesoscale/hiv_blood_cellpack/BloodHIV1.0_mixed_fixed_nc1.json")


@pytest.fixture(scope="module")
def serialized(shared) -> MesoscaleModel:
    return load(shared / "mesoscale/hiv_blood_cellpack/pack_bloodhiv_serialized.json")


@pytest.fixture(scope="module")
def explorer(shared) -> MesoscaleModel:
    return load(shared / "mesoscale/bcif/HIV_atom_instances.bcif")


def ingredient(model: MesoscaleModel, *names: str):
    return next(i for i in model.ingredients if i.name in names)


def alpha_carbons(model: MesoscaleModel, shared) -> np.ndarray:
    """(chains, residues, 3) world Cα positions of the capsid."""
    part = ingredient(model, *CA).parts[0]
    source = load(shared / "mesoscale/hiv_blood_cellpack/proteins/3j3q_1vu4_A_biomt.pdb")
    local = part.structure.spheres[source.atom_name == "CA", :3]
    turned = np.einsum("kij,nj->kni", rotation_matrices(part.rotations), local)
    return turned + part.positions[:, None]


def contacts(chains: np.ndarray, limit: float = 6.5) -> int:
    """Pairs of Cα atoms of different chains nearer than ``limit``."""
    from scipy.spatial import cKDTree

    n = chains.shape[1]
    pairs = cKDTree(chains.reshape(-1, 3)).query_pairs(limit, output_type="ndarray")
    return int((pairs[:, 0] // n != pairs[:, 1] // n).sum())


def centers(model: MesoscaleModel, *names: str) -> np.ndarray:
    part = ingredient(model, *names).parts[0]
    return rotation_matrices(part.rotations) @ part.structure.centroid + part.positions


def test_counts_are_those_of_the_files(blood, serialized, explorer):
    fibres = sum(len(i.curves) for i in blood.ingredients)
    assert (blood.instances - fibres, fibres, blood.atoms) == (20_502, 5, 65_502_072)
    assert serialized.instances == 18_515
    assert (explorer.instances, explorer.atoms) == (242_958, 21_787_182)


def test_capsid_contacts_need_every_convention_right(blood, serialized, shared):
    # wrong quaternion order, handedness or centring gives 8,000 to 22,000 or none at all
    assert contacts(alpha_carbons(blood, shared)) == pytest.approx(45_918, abs=2)
    assert contacts(alpha_carbons(serialized, shared)) == pytest.approx(45_918, abs=2)


def test_two_forms_of_one_virus_lie_in_the_same_place(blood, serialized):
    one, other = centers(blood, *CA), centers(serialized, *CA)
    np.testing.assert_allclose(one.mean(axis=0), other.mean(axis=0), atol=0.01)
    np.testing.assert_allclose(np.cov(one.T), np.cov(other.T), rtol=1e-3, atol=1.0)


@pytest.mark.parametrize("form", ["blood", "serialized"])
def test_membrane_proteins_lie_at_their_membrane(form, request):
    model = request.getfixturevalue(form)
    env = np.linalg.norm(centers(model, "HIV1_ENV_4nco_0_1_1", "surf_0__HIV1_ENV"), axis=1)
    ma = np.linalg.norm(centers(model, "HIV1_MA_Hyb_0_1_0", "surf_0__HIV1_MA"), axis=1)
    assert env.mean() == pytest.approx(809, abs=4)
    assert ma.mean() == pytest.approx(691, abs=4)


def test_nesting_is_worked_out_from_the_places(blood):
    paths = {i.name: i.path for i in blood.ingredients}
    envelope, outer, inner = (
        "HIV1_envelope_Pack_145_0_2_0",
        "HIV1_capsid_3j3q_PackOuter_0_1_1",
        "HIV1_capsid_3j3q_PackInner_0_1_0",
    )
    assert paths["SerumAlbumin"] == ("BloodHIV", "exterior", "SerumAlbumin")
    assert paths["HIV1_MA_Hyb_0_1_0"][1:3] == (envelope, "surface")
    assert paths["HIV1_CA_mono_0_1_0"][1:4] == (envelope, outer, "surface")
    assert paths["HIV1_TAT_1jfw_0_1_0"][1:4] == (envelope, outer, inner)


def test_an_ingredient_may_be_listed_in_two_places(blood):
    assert len([i for i in blood.ingredients if i.name == "HIV1_RT_3hvt_0_1_0"]) == 2


def test_explorer_expands_odd_operator_ranges_to_nothing(explorer):
    names = {i.name for i in explorer.ingredients}
    assert "gRNA" in names and "gRNA2" not in names
    assert any("gRNA2" in note for note in explorer.notes)
    lipids = [i for i in explorer.ingredients if i.path[2] == "membrane"]
    assert sum(i.instances for i in lipids) == 197_070
    assert max(len(p.structure) for i in lipids for p in i.parts) < 100


def test_missing_structures_are_stood_in_for_by_the_models_own_spheres(shared):
    path = shared / "mesoscale/other_recipes/HIV-1_0.1.6-8_mixed_radii_pdb.json.gz"
    model = load(path)
    assert model.instances == 11_681
    assert all(p.structure.stand_in for i in model.ingredients for p in i.parts)
    assert any("'MA_matrix_G1.pdb'" in note and "24 coarse spheres" in note for note in model.notes)
    with pytest.raises(LoadError, match=r"MA_matrix_G1.*--structures"):
        load(path, strict=True)


def test_structures_may_lie_in_another_folder(shared, blood):
    folder = shared / "mesoscale/hiv_blood_cellpack/proteins"
    path = shared / "mesoscale/other_recipes/HIV-1_0.1.6-8_mixed_radii_pdb.json.gz"
    model = load(path, structures=str(folder), strict=True)
    assert not any(p.structure.stand_in for i in model.ingredients for p in i.parts)
    np.testing.assert_allclose(centers(model, *CA), centers(blood, *CA), atol=1e-3)


def test_fibres_become_tubes(shared):
    model = load(shared / "mesoscale/other_recipes/Mycoplasma1.5_mixed_pdb_fixed.json.gz")
    dna = ingredient(model, "DNA")
    assert len(dna.curves) == 80 and sum(map(len, dna.curves)) == 9_621
    pieces = [b.geometry for b in model.bodies() if b.name == "DNA"]
    assert {int(g.sphere_ids[0]) for g in pieces} == set(range(80))
    for geometry in pieces[:5]:
        gaps = np.linalg.norm(np.diff(geometry.spheres[:, :3], axis=0), axis=1)
        assert gaps.max() <= 0.2 * dna.curve_radius * 1.01


def test_bodies_place_the_same_atoms(blood):
    part = ingredient(blood, "SerumAlbumin").parts[0]
    body = next(b for b in blood.bodies() if b.name == "SerumAlbumin")
    expected = rotation_matrices(part.rotations[5:6])[0] @ part.structure.spheres[7, :3]
    found = rotation_matrices(body.rotations[5:6])[0] @ body.geometry.spheres[7, :3]
    np.testing.assert_allclose(found + body.positions[5], expected + part.positions[5], atol=1e-3)
    assert blood.bodies()[0] is blood.bodies()[0]


def test_tree_adds_up(blood):
    tree = blood.tree
    assert tree.instances == blood.instances and tree.atoms == blood.atoms
    for _, node in tree.walk():
        if node.children:
            assert node.instances == sum(c.instances for c in node.children.values())
    assert blood.compartments == sum(bool(n.children) for _, n in tree.walk()) - 1 == 7
    counts = scene_counts(Scene().add(blood))
    assert counts["atoms"] == blood.atoms > 60_000_000
    assert counts["instances"] == blood.instances and counts["compartments"] == 7
    text = "\n".join(blood.outline())
    assert "SerumAlbumin" in text and "3,698" in text and "17,251,170" in text
