"""Models within models: placed one by one while they are few, as assemblies when they are many."""

from __future__ import annotations

import numpy as np
import pytest

from scuro.load import load, mesoscale_table
from scuro.scene.geometry import rotation_matrices
from scuro.scene.scene import Scene


@pytest.fixture
def cell(tmp_path):
    """A cell of two viruses of three balls each, one of them turned a quarter about z."""
    np.array([[0, 0, 0, 2]], "<f4").tofile(tmp_path / "ball.bin")
    (tmp_path / "virus.csv").write_text(
        "ingredient,compartment,structure,x,y,z\n"
        "ball,shell,ball.bin,10,0,0\nball,shell,ball.bin,0,20,0\ncore,inside,ball.bin,0,0,5\n"
    )
    half = np.sqrt(0.5)
    (tmp_path / "cell.csv").write_text(
        "ingredient,compartment,structure,x,y,z,qx,qy,qz,qw\n"
        f"virus,plasma,virus.csv,0,0,0,0,0,0,1\nvirus,plasma,virus.csv,100,0,0,0,0,{half},{half}\n"
    )
    return tmp_path / "cell.csv"


EXPECTED = {(10, 0, 0), (0, 20, 0), (0, 0, 5), (100, 10, 0), (80, 0, 0), (100, 0, 5)}


def world_centers(model) -> set[tuple[int, ...]]:
    found = []
    for body in Scene().add(model).bodies():
        middle = body.geometry.spheres[0, :3]
        own = rotation_matrices(body.rotations) @ middle + body.positions
        if body.frames is not None:
            outer = rotation_matrices(body.frames.rotations)
            own = (outer @ own.T).transpose(0, 2, 1) + body.frames.positions[:, None]
        found.append(np.reshape(own, (-1, 3)))
    return {tuple(row) for row in np.round(np.concatenate(found)).astype(int).tolist()}


@pytest.mark.parametrize("most", [100, 1])
def test_both_forms_place_the_same_balls(cell, monkeypatch, most):
    monkeypatch.setattr(mesoscale_table, "MOST_SINGLE", most)
    model = load(cell)
    assert (model.instances, model.atoms) == (6, 6)
    assert world_centers(model) == EXPECTED
    assert {i.frames is None for i in model.ingredients} == {most == 100}
    np.testing.assert_allclose(model.bounds, [[-2, -2, -2], [112, 22, 7]], atol=12)


def test_depth_multiplies_places_and_keeps_one_copy_of_each(cell, monkeypatch):
    monkeypatch.setattr(mesoscale_table, "MOST_SINGLE", 1)
    tissue = cell.with_name("tissue.csv")
    rows = "".join(f"cell,,cell.csv,{1000 * i},0,0\n" for i in range(5))
    tissue.write_text("ingredient,compartment,structure,x,y,z\n" + rows)
    model = load(tissue)
    assert model.atoms == 30 and len({id(i.frames) for i in model.ingredients}) == 1
    expected = {(x + 1000 * i, y, z) for x, y, z in EXPECTED for i in range(5)}
    assert world_centers(model) == expected


def test_too_many_places_are_refused(cell, monkeypatch):
    from scuro.errors import LoadError

    monkeypatch.setattr(mesoscale_table, "MOST_SINGLE", 1)
    monkeypatch.setattr(mesoscale_table, "MOST_FRAMES", 3)
    tissue = cell.with_name("tissue.csv")
    tissue.write_text("ingredient,structure,x,y,z\ncell,cell.csv,0,0,0\ncell,cell.csv,500,0,0\n")
    with pytest.raises(LoadError, match="more than 3 do not fit into memory"):
        load(tissue)
