"""Opaque parts of reservoirs."""

from __future__ import annotations

import numpy as np
import pytest

from scuro.errors import SettingsError
from scuro.scene.cornerpoint_faces import fault_faces, isosurface, outer_faces
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.cornerpoint_topology import vertex_values
from scuro.scene.reservoir import ReservoirItem
from scuro.style.reservoir_options import ReservoirSettings


@pytest.fixture(scope="module")
def flat():
    """Without throw and holes: every cell between others is covered."""
    grid = faulted_dome(6, 5, 3, throw=0.0)
    object.__setattr__(grid, "active", np.ones_like(grid.active))
    return grid


@pytest.fixture(scope="module")
def dome():
    return faulted_dome(12, 10, 6)


def test_outer_faces_are_those_of_the_block(flat) -> None:
    faces = outer_faces(flat, flat.active, 1.0)
    # the layer that pinches out has sides without area
    assert 2 * 6 * 5 + 2 * 2 * (6 + 5) <= len(faces.cells) <= 2 * (6 * 5 + 5 * 3 + 6 * 3)
    assert len(fault_faces(flat, flat.active, 1.0).cells) == 0


def test_faces_look_outward(dome) -> None:
    chosen = np.zeros_like(dome.active)
    chosen[1, 5, 5] = dome.active[1, 5, 5]
    quads = outer_faces(dome, chosen, 2.0).corners
    normal = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    outward = quads.mean(axis=1) - quads.mean(axis=(0, 1))
    assert len(quads) == 6 and ((normal * outward).sum(axis=1) > 0).all()


def test_faults_are_found(dome) -> None:
    fault = dome.dimensions[0] // 3
    cells = fault_faces(dome, dome.active, 1.0).cells
    i = np.unravel_index(cells, dome.active.shape)[2]
    assert {fault - 1, fault} <= set(i.tolist())


def test_isosurface_lies_at_its_value(dome) -> None:
    depth = dome.cell_depth
    corners = vertex_values(dome, depth)
    iso = float(np.median(depth))
    triangles, cells = isosurface(dome, corners, dome.active, iso, 1.0)
    assert len(triangles) == len(cells) > 50
    # values at vertices are means over cells: within a cell's thickness of the depth itself
    assert np.abs(-triangles[..., 2] - iso).max() < 30
    assert np.isfinite(triangles).all()


@pytest.mark.parametrize("show", ["cells", "slices", "iso"])
def test_bodies(dome, show: str) -> None:
    settings = ReservoirSettings(show=show, lines=True, faults=True)
    bodies = ReservoirItem(dome, settings).bodies()
    names = [body.name.removeprefix("faulted dome ") for body in bodies]
    assert names[1:] == ["faults", "edges", "wells"]
    for body in bodies:
        assert np.isfinite(body.geometry.bounds).all()
    assert set(np.unique(bodies[0].geometry.triangle_ids)) <= set(np.flatnonzero(dome.active))


def test_filters(dome) -> None:
    def count(**changes) -> int:
        return int(ReservoirItem(dome, ReservoirSettings(**changes)).chosen().sum())

    assert count() == dome.active_count
    assert (
        count(property="SWAT", low=0.5) + count(property="SWAT", high=0.4999) <= dome.active_count
    )
    assert count(box="i=3:4 k=1") == int(dome.active[0, :, 2:4].sum())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"slices": "x3"}, "a slice is i, j or k"),
        ({"box": "i=a"}, "a box is like"),
        ({"show": "cels"}, "did you mean 'cells'"),
    ],
)
def test_wrong_words_say_how(changes: dict, message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        ReservoirSettings(**changes)


def test_slices_beyond_the_model(dome) -> None:
    with pytest.raises(SettingsError, match="no slice k99"):
        ReservoirItem(dome, ReservoirSettings(show="slices", slices="k99")).bodies()


def test_opaque_cells_come_first_and_edges_where_they_set_cells_apart() -> None:
    def names(grid, **changes) -> list[str]:
        item = ReservoirItem(grid, ReservoirSettings(wells=False, **changes))
        return [body.name.split()[-1] for body in item.bodies()]

    few, many = faulted_dome(12, 10, 3), faulted_dome(120, 100, 1)
    assert names(few) == ["cells", "edges"] and names(many) == ["cells"]
    assert names(few, show="volume") == [] and names(few, lines=False) == ["cells"]
    assert names(many, lines=True) == ["cells", "edges"]
