"""Cell-scale models that are damaged, odd or our own tables."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scuro.errors import LoadError, SaveError
from scuro.load import load
from scuro.load.mesoscale_bcif import expand_operators
from scuro.load.mesoscale_structures import unit_quaternions
from scuro.load.mesoscale_table import save_table
from scuro.scene.generate import GenerateSettings, generate
from scuro.scene.generate_parts import upright
from scuro.scene.geometry import rotation_matrices
from scuro.scene.model import Structure
from scuro.scene.sphere import fibonacci_sphere

BALL = np.array([[0, 0, 0, 4], [6, 0, 0, 3], [0, 7, 0, 2]], np.float32)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "ball.bin").write_bytes(BALL.astype("<f4").tobytes())
    return tmp_path


ONE_BALL = {
    "Compartments": [],
    "IngredientGroups": [
        {"name": "g", "Ingredients": [{"ingredient_id": 0, "name": "ball", "nbMol": 1}]}
    ],
}


def recipe(results: list, **more) -> dict:
    entry = {"name": "ball", "source": {"pdb": None}, "results": results} | more
    return {
        "recipe": {"name": "test", "version": "1.0"},
        "cytoplasme": {"ingredients": {"ball": entry}},
    }


def write(path: Path, content: dict) -> Path:
    path.write_text(json.dumps(content))
    return path


def test_result_quaternions_are_w_first_and_right_handed(folder):
    half = np.sqrt(0.5)
    path = write(folder / "a.json", recipe([[[10, 0, 0], [half, 0, 0, half]]]))
    part = load(path).ingredients[0].parts[0]
    # a quarter turn about z takes x to y
    np.testing.assert_allclose(
        rotation_matrices(part.rotations)[0] @ [1, 0, 0], [0, 1, 0], atol=1e-6
    )


def test_odd_quaternions_are_normalised_and_counted(folder):
    path = write(
        folder / "a.json",
        recipe([[[0, 0, 0], [2, 0, 0, 0]], [[9, 0, 0], [0, 0, 0, 0]], [[20, 0, 0], [1, 0, 0, 0]]]),
    )
    model = load(path)
    np.testing.assert_allclose(model.ingredients[0].parts[0].rotations, [[0, 0, 0, 1]] * 3)
    assert any("1 quaternions were not of unit length" in n for n in model.notes)
    assert any("1 quaternions were zero" in n for n in model.notes)


@given(st.lists(st.floats(-1e3, 1e3), min_size=4, max_size=4))
def test_unit_quaternions_are_always_unit(q):
    found = unit_quaternions(np.array([q]), [], "x")
    assert np.linalg.norm(found) == pytest.approx(1, abs=1e-5)


def test_positions_that_are_not_finite_are_dropped(folder):
    path = folder / "a.json"
    path.write_text(json.dumps(recipe([[[0, 0, 0], [1, 0, 0, 0]], [[1, 1, 1], [1, 0, 0, 0]]]))
                    .replace("[1, 1, 1]", "[NaN, 1, 1]"))  # fmt: skip
    model = load(path)
    assert model.instances == 1
    assert any("no finite position" in n for n in model.notes)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ({"recipe": {"version": "9.1"}, "compartments": {}}, "version '9.1'"),
        ({"recipe": {"version": "1.0"}, "compartments": {}}, "places no ingredient"),
        ({"recipe": {"version": "1.0"}, "compartments": []}, "not a packing result|places no"),
        ({"something": 1}, "neither a 'recipe' nor 'Compartments'"),
        (recipe([[1, 2, 3]]), "results must be pairs"),
        (recipe([[["a", "b", "c"], [1, 0, 0, 0]]]), "not numbers"),
        ({"Compartments": [], "IngredientGroups": []}, r"a\.bin"),
    ],
)
def test_wrong_content_is_said_in_a_sentence(folder, content, says):
    with pytest.raises(LoadError, match=says) as caught:
        load(write(folder / "a.json", content))
    assert "a.json" in str(caught.value)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 255))
def test_damaged_bytes_never_crash(tmp_path_factory, at, byte):
    folder = tmp_path_factory.mktemp("damaged")
    data = bytearray(json.dumps(recipe([[[0, 0, 0], [1, 0, 0, 0]]] * 3)).encode())
    data[at % len(data)] = byte
    path = folder / "a.json"
    path.write_bytes(bytes(data))
    try:
        load(path)
    except LoadError as error:
        assert "a.json" in str(error)


def test_missing_binary_and_wrong_size(folder):
    path = write(folder / "a.json", ONE_BALL)
    with pytest.raises(LoadError, match="without its placements"):
        load(path)
    (folder / "aLH.bin").write_bytes(b"123")
    with pytest.raises(LoadError, match="multiple of 32"):
        load(path)


def test_left_handed_placements_are_mirrored_in_x(folder):
    path = write(folder / "a.json", ONE_BALL)
    half = np.sqrt(0.5)
    rows = np.array([[5, 6, 7, 0], [0, 0, half, half]], "<f4")
    (folder / "aLH.bin").write_bytes(rows.tobytes())
    part = load(path).ingredients[0].parts[0]
    np.testing.assert_allclose(part.positions, [[-5, 6, 7]])
    np.testing.assert_allclose(part.rotations, [[0, 0, -half, half]], atol=1e-6)


def test_backward_operator_ranges_are_empty():
    assert expand_operators("(3-5)") == [3, 4, 5]
    assert expand_operators("(46660-46659)") == []
    assert expand_operators("(7)") == [7]
    assert expand_operators("(1,4-5)") == [1, 4, 5]


def test_table_in_any_order_of_columns(folder):
    path = folder / "model.tsv"
    path.write_text("# note\nx\ty\tz\tcompartment\tingredient\n1\t2\t3\tcell/nucleus\tball\n\n")
    model = load(path)
    only = model.ingredients[0]
    assert only.path == ("model", "cell", "nucleus", "ball")
    np.testing.assert_allclose(only.parts[0].positions, [[1, 2, 3]])
    np.testing.assert_allclose(only.parts[0].structure.centroid, 0, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("ingredient,x,y\nball,1,2\n", "line 1: has no column 'z'"),
        ("ingredient,x,y,z\nball,1,2\n", "line 2: has 3 values"),
        ("ingredient,x,y,z\nball,1,2,3\nball,1,two,3\n", "line 3: 'two' in column y"),
        ("ingredient,x,y,z,qx\nball,1,2,3,0\n", "all of qx, qy, qz, qw"),
        ("# nothing\n", "empty table"),
    ],
)
def test_table_errors_name_the_line(folder, text, says):
    path = folder / "m.csv"
    path.write_text(text)
    with pytest.raises(LoadError, match=says):
        load(path)


def test_a_table_inside_a_table_is_placed_as_a_whole(folder):
    (folder / "virus.csv").write_text("ingredient,compartment,x,y,z\nball,shell,10,0,0\n")
    half = np.sqrt(0.5)
    (folder / "cell.csv").write_text(
        "ingredient,structure,x,y,z,qx,qy,qz,qw\n"
        f"virus,virus.csv,100,0,0,0,0,{half},{half}\nvirus,virus.csv,200,0,0,0,0,0,1\n"
    )
    only = load(folder / "cell.csv").ingredients[0]
    assert only.path == ("cell", "virus", "shell", "ball")
    np.testing.assert_allclose(only.parts[0].positions, [[100, 10, 0], [210, 0, 0]], atol=1e-5)


def test_tables_that_contain_each_other_are_refused(folder):
    (folder / "a.csv").write_text("ingredient,structure,x,y,z\nb,b.csv,0,0,0\n")
    (folder / "b.csv").write_text("ingredient,structure,x,y,z\na,a.csv,0,0,0\n")
    with pytest.raises(LoadError, match=r"a\.csv → b\.csv → a\.csv"):
        load(folder / "a.csv")


@pytest.mark.parametrize("suffix", [".csv", ".tsv", ".meso"])
def test_generated_models_survive_a_round_trip(folder, suffix):
    made = generate([Structure.of_spheres("ball", BALL)], GenerateSettings(atoms=2e5))
    save_table(folder / f"cell{suffix}", made)
    read = load(folder / f"cell{suffix}")
    assert (read.instances, read.atoms) == (made.instances, made.atoms)
    np.testing.assert_allclose(read.bounds, made.bounds, rtol=1e-3)
    assert {i.path[1:] for i in read.ingredients} == {i.path[1:] for i in made.ingredients}


def test_saving_elsewhere_is_refused(folder):
    made = generate([Structure.of_spheres("ball", BALL)], GenerateSettings(atoms=5e4))
    with pytest.raises(SaveError, match=r"\.xlsx"):
        save_table(folder / "cell.xlsx", made)


def test_generator_is_seeded_and_meets_its_count():
    ball = Structure.of_spheres("ball", np.tile(BALL, (40, 1)))
    one, two = (generate([ball], GenerateSettings(atoms=3e6, seed=5)) for _ in range(2))
    assert one.atoms == two.atoms
    np.testing.assert_array_equal(
        one.ingredients[0].parts[0].positions, two.ingredients[0].parts[0].positions
    )
    assert one.atoms == pytest.approx(3e6, rel=0.35)
    depths = {i.path[1:-1] for i in one.ingredients}
    assert ("compartment 1", "compartment 2", "interior") in depths


def test_generated_proteins_do_not_overlap():
    ball = Structure.of_spheres("ball", BALL)
    made = generate([ball], GenerateSettings(atoms=1e5, lipids=False, fibre=False))
    inside = [i for i in made.ingredients if i.path[-2] == "interior"]
    points = np.concatenate([p.positions for i in inside for p in i.parts])
    from scipy.spatial import cKDTree

    reach = (np.linalg.norm(ball.centered.spheres[:, :3], axis=1) + BALL[:, 3]).max()
    distances = cKDTree(points).query(points, k=2)[0][:, 1]
    assert distances.min() >= 2 * reach * 0.999


def test_upright_turns_z_to_the_normal():
    normals = np.concatenate([fibonacci_sphere(50), [[0, 0, -1], [0, 0, 1]]])
    q = upright(normals, np.random.default_rng(0))
    np.testing.assert_allclose(rotation_matrices(q) @ [0, 0, 1], normals, atol=1e-5)
