"""Reservoir readers: real models, other forms of the same grid, and damaged files."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scuro.errors import LoadError, SettingsError
from scuro.load import load
from scuro.load.reservoir_grdecl import _numbers
from scuro.load.reservoir_records import RecordFile
from scuro.load.source import Source
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.cornerpoint_topology import count_cells, split_faces, vertex_values

resfo = pytest.importorskip("resfo", reason="needs the extra 'reservoir'")

# dimensions, active cells, split faces, connections: the data's README
MODELS = {
    "opm_model2/9_EDITNNC.EGRID": ((13, 22, 11), 2794, 473, 372),
    "reek/REEK.EGRID": ((40, 64, 14), 35838, 3024, 2874),
    "reek/reek_sim.grdecl.gz": ((40, 64, 14), 35812, 3024, 0),
    "brugge/BRUGGE_0000.EGRID": ((139, 48, 9), 43374, 423, 151),
    "spe9/SPE9.EGRID": ((24, 25, 15), 9000, 8625, 0),
    "spe9/SPE9.GRDECL.gz": ((24, 25, 15), 9000, 0, 0),
    "spe10_model1/SPE10MODEL1.GRDECL.gz": ((100, 1, 20), 2000, 0, 0),
}


@pytest.mark.parametrize("name", MODELS)
def test_real_models(shared: Path, name: str) -> None:
    grid = load(shared / "reservoir" / name)
    dimensions, active, split, connections = MODELS[name]
    assert grid.dimensions == dimensions
    assert grid.active_count == active
    assert count_cells(grid).split == split
    assert len(grid.connections) == connections
    assert grid.summary()["active cells"] == active


def test_units_and_orientation(shared: Path) -> None:
    brugge = load(shared / "reservoir/brugge/BRUGGE_0000.EGRID")
    assert (brugge.unit, brugge.unit_system) == ("ft", "FIELD")
    assert brugge.property_unit("PRESSURE") == "psia"
    assert brugge.map_axes is None  # GRIDUNIT says that coordinates already are the map's
    assert brugge.bounds[1, 2] < -4900  # depth 4,949 ft lies below, not above, the datum
    reek = load(shared / "reservoir/reek/REEK.EGRID")
    text = load(shared / "reservoir/reek/reek_sim.grdecl.gz")
    # the binary file is in local axes with MAPAXES, the text in map coordinates: the same place
    assert np.abs(reek.bounds - text.bounds)[:, :2].max() < 2
    assert reek.right_handed and text.right_handed and not brugge.right_handed


def test_steps_are_lazy_and_dated(shared: Path) -> None:
    grid = load(shared / "reservoir/opm_model2/9_EDITNNC.EGRID")
    assert [str(s) for s in grid.steps][::9] == ["2018-11-01", "2021-07-01"]
    first, last = grid.values("SWAT", 0), grid.values("SWAT")
    assert first.shape == (2794,) and np.abs(first - last).max() > 0.1
    assert np.allclose(grid.values("SOIL", 0), 1 - first - grid.values("SGAS", 0), atol=1e-6)
    assert grid.values("poro")[0] == pytest.approx(0.3133)
    brugge = load(shared / "reservoir/brugge/BRUGGE_0000.INIT")
    assert [s.report for s in brugge.steps] == [0, 2, 4, 6, 8, 10]
    assert np.allclose(brugge.values("SOIL"), np.clip(1 - brugge.values("SWAT"), 0, 1))


def test_wells(shared: Path) -> None:
    grid = load(shared / "reservoir/opm_model2/9_EDITNNC.EGRID")
    assert [w.name for w in grid.wells] == ["PROD1", "INJ1", "PROD2", "PROD3", "INJ2"]
    assert grid.wells[0].kind == "producer"
    assert grid.wells[0].cells[0].tolist() == [5, 2, 6]
    assert grid.wells[1].kind == "water injector"


def test_text_siblings_bring_properties(shared: Path) -> None:
    grid = load(shared / "reservoir/reek/reek_sim.grdecl.gz")
    assert grid.properties == ("PORO",)
    assert 0.1 < grid.values("PORO").mean() < 0.35


def test_unknown_names_suggest(shared: Path) -> None:
    grid = load(shared / "reservoir/opm_model2/9_EDITNNC.EGRID")
    with pytest.raises(SettingsError, match="did you mean 'PRESSURE'"):
        grid.values("PRESURE")
    with pytest.raises(SettingsError, match="no time step 99"):
        grid.values("SWAT", 99)


def write_egrid(path: Path, grid, **changes) -> None:
    ni, nj, nk = grid.dimensions
    head = np.zeros(100, np.int32)
    head[:4] = 1, ni, nj, nk
    arrays = {
        "FILEHEAD": np.zeros(100, np.int32),
        "GRIDUNIT": [b"METRES  ", b"        "],
        "GRIDHEAD": head,
        "COORD": grid.coord.astype(np.float32).ravel(),
        "ZCORN": grid.zcorn.ravel(),
        "ACTNUM": grid.active.astype(np.int32).ravel(),
    } | changes
    resfo.write(path, [(f"{k:8}", v) for k, v in arrays.items() if v is not None])


@pytest.fixture
def dome():
    return faulted_dome(8, 7, 6)


def test_round_trip_and_missing_files(tmp_path: Path, dome) -> None:
    write_egrid(tmp_path / "DOME.EGRID", dome)
    grid = load(tmp_path / "DOME.EGRID")
    assert np.array_equal(grid.zcorn, dome.zcorn)
    assert np.array_equal(grid.active, dome.active)
    assert any("no INIT" in note for note in grid.notes)
    assert any("no restart" in note for note in grid.notes)
    with pytest.raises(SettingsError, match="no restart file"):
        grid.step_index(0)


def test_older_grid_form(tmp_path: Path, dome) -> None:
    ni, nj, nk = dome.dimensions
    cells = dome.corners(np.arange(dome.active.size)).astype(np.float32)
    contents = [("DIMENS  ", np.array([ni, nj, nk], np.int32))]
    for n, corners in enumerate(cells):
        k, j, i = np.unravel_index(n, dome.active.shape)
        active = int(dome.active[k, j, i])
        contents.append(("COORDS  ", np.array([i + 1, j + 1, k + 1, n + 1, active], np.int32)))
        contents.append(("CORNERS ", corners.ravel()))
    resfo.write(tmp_path / "OLD.GRID", contents)
    grid = load(tmp_path / "OLD.GRID")
    assert np.array_equal(grid.active, dome.active)
    assert np.abs(grid.corners() - dome.corners()).max() < 0.05


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ZCORN": np.zeros(7, np.float32)}, "ZCORN has 7 values"),
        ({"COORD": None}, "has no COORD"),
        ({"ACTNUM": np.zeros(8 * 7 * 6, np.int32)}, "no cell of the grid is active"),
        ({"ACTNUM": np.ones(3, np.int32)}, "ACTNUM has 3 values"),
        ({"GRIDHEAD": np.zeros(100, np.int32)}, "not corner-point"),
        ({"COORD": np.full(8 * 9 * 6, np.nan, np.float32)}, "not finite"),
    ],
)
def test_wrong_grids_say_why(tmp_path: Path, dome, changes: dict, message: str) -> None:
    write_egrid(tmp_path / "BAD.EGRID", dome, **changes)
    with pytest.raises(LoadError, match=message):
        load(tmp_path / "BAD.EGRID")


@pytest.mark.parametrize("share", [0.0005, 0.2, 0.6, 0.999])
def test_truncated_grid(shared: Path, tmp_path: Path, share: float) -> None:
    data = (shared / "reservoir/reek/REEK.EGRID").read_bytes()
    path = tmp_path / "CUT.EGRID"
    path.write_bytes(data[: int(share * len(data))])
    if share > 0.99:  # only the connections are cut
        assert any("ends within" in n or "no further" in n for n in load(path).notes)
    else:
        with pytest.raises(LoadError):
            load(path)


def test_truncated_restart_keeps_whole_steps(shared: Path, tmp_path: Path) -> None:
    for ending in ("EGRID", "INIT", "UNRST"):
        shutil.copy(shared / f"reservoir/opm_model2/9_EDITNNC.{ending}", tmp_path / f"A.{ending}")
    data = (tmp_path / "A.UNRST").read_bytes()
    (tmp_path / "A.UNRST").write_bytes(data[: len(data) // 2])
    grid = load(tmp_path / "A.EGRID")
    assert 3 <= len(grid.steps) <= 5
    assert any("steps before are used" in note for note in grid.notes)
    assert np.isfinite(grid.values("PRESSURE")).all()


@pytest.mark.parametrize("ending", ["EGRID", "INIT", "UNRST"])
def test_cuts_and_flipped_bytes_never_raise_anything_else(
    shared: Path, tmp_path: Path, ending: str
) -> None:
    """At record boundaries, within records, and anywhere: a grid, or one clear sentence."""
    folder = shared / "reservoir/opm_model2"
    for other in ("EGRID", "INIT", "UNRST"):
        shutil.copy(folder / f"9_EDITNNC.{other}", tmp_path / f"A.{other}")
    path = tmp_path / f"A.{ending}"
    data = path.read_bytes()
    starts = [record.start for record in RecordFile(Source(path.name, path)).records]
    rng = np.random.default_rng(5)
    some = sorted(rng.choice(starts, min(len(starts), 25), replace=False).tolist())
    cuts = [s + o for s in some for o in (0, 1, 20, 24, 40)] + rng.integers(
        0, len(data), 15
    ).tolist()
    broken = [data[:cut] for cut in cuts]
    for n in range(40):
        flipped = bytearray(data)
        near = int(rng.choice(starts)) + int(rng.integers(40))
        flipped[near if n % 2 else int(rng.integers(len(data)))] = int(rng.integers(256))
        broken.append(bytes(flipped))
    loaded = 0
    for content in broken:
        path.write_bytes(content)
        grid = None
        try:
            grid = load(tmp_path / "A.EGRID")
            loaded += 1
            for name in grid.properties:
                grid.values(name)
        except (LoadError, SettingsError) as error:
            assert str(error) and "\n" not in str(error)
            assert ending == "EGRID" or grid, "the geometry is whole: it is shown all the same"
    assert loaded > 10


def test_wrong_property_length_is_told(tmp_path: Path, dome) -> None:
    write_egrid(tmp_path / "A.EGRID", dome)
    resfo.write(tmp_path / "A.INIT", [("PORO    ", np.zeros(17, np.float32))])
    grid = load(tmp_path / "A.EGRID")
    assert "PORO" not in grid.statics
    assert any("PORO has 17 values" in note for note in grid.notes)


def test_nan_property_is_counted(tmp_path: Path, dome) -> None:
    write_egrid(tmp_path / "A.EGRID", dome)
    values = np.full(dome.active_count, 0.2, np.float32)
    values[:3] = np.nan
    resfo.write(tmp_path / "A.INIT", [("PORO    ", values)])
    assert any("PORO has no finite value in 3 cells" in n for n in load(tmp_path / "A.EGRID").notes)


def grdecl(dome, actnum: str) -> str:
    ni, nj, nk = dome.dimensions
    return (
        f"-- a comment / with slash\nSPECGRID\n {ni} {nj} {nk} 1 F /\nCOORD\n"
        + "\n".join(map(str, dome.coord.ravel()))
        + "\n/\nZCORN\n"
        + " ".join(map(str, dome.zcorn.ravel()))
        + f" /\nACTNUM\n{actnum} /\n"
    )


def test_grdecl_repeats_and_includes(tmp_path: Path, dome) -> None:
    (tmp_path / "grid.inc").write_text(grdecl(dome, f"3*0 {dome.active.size - 3}*1"))
    (tmp_path / "A.GRDECL").write_text("INCLUDE\n 'grid.inc' /\n\nFIELD\n\nPORO\n336*0.25 /\n")
    grid = load(tmp_path / "A.GRDECL")
    assert grid.active_count == dome.active.size - 3
    assert np.allclose(grid.values("PORO"), 0.25)
    assert np.allclose(grid.zcorn, dome.zcorn)
    assert grid.unit == "ft"


def test_a_unit_that_the_file_leaves_out_is_told_and_can_be_given(tmp_path: Path, dome) -> None:
    path = tmp_path / "A.GRDECL"
    text = grdecl(dome, f"{dome.active.size}*1") + f"PRESSURE\n{dome.active.size}*100 /\n"
    path.write_text(text)
    grid = load(path)
    assert (grid.unit, grid.property_unit("PRESSURE")) == ("m", "barsa")
    assert any("no unit of length" in n and "--grid-unit" in n for n in grid.notes)
    grid = load(path, grid_unit="feet")
    assert (grid.unit, grid.property_unit("PRESSURE")) == ("ft", "psia")
    assert not any("unit of length" in n for n in grid.notes)
    path.write_text("METRIC\n" + text)
    assert not any("unit of length" in n for n in load(path).notes)
    # a binary grid's INIT may say which system of units it is
    write_egrid(tmp_path / "B.EGRID", dome, GRIDUNIT=None)
    head = np.array([0, 0, 2, *[0] * 92], np.int32)
    resfo.write(tmp_path / "B.INIT", [("INTEHEAD", head)])
    assert load(tmp_path / "B.EGRID").unit == "ft"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("INCLUDE\n 'nowhere.inc' /\n", "includes 'nowhere.inc'"),
        ("INCLUDE\n 'A.GRDECL' /\n", "nest too deep"),
        ("SPECGRID\n 2 2 2 1 F /\nCOORD\n 1 two 3 /\n", "line 3: COORD has words"),
        ("PORO\n 8*0.1 /\n", "has no SPECGRID"),
        ("SPECGRID\n 2 2 2 1 F /\nCOORD\n 54*1 /\nZCORN\n 8*1 /\n", "ZCORN has 8 values"),
        ("1 2 3", "no keywords"),
    ],
)
def test_wrong_text_says_why(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "A.GRDECL").write_text(text)
    with pytest.raises(LoadError, match=message):
        load(tmp_path / "A.GRDECL")


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 9), st.floats(-1e6, 1e6, width=32)), min_size=1))
def test_repeats_are_written_out(pairs: list[tuple[int, float]]) -> None:
    text = " ".join(f"{n}*{v!r}" if n > 1 else repr(v) for n, v in pairs)
    expected = [v for n, v in pairs for _ in range(n)]
    numbers = _numbers(text)
    assert numbers is not None and numbers.tolist() == expected


def test_roff_agrees_with_egrid(shared: Path, tmp_path: Path) -> None:
    xtgeo = pytest.importorskip("xtgeo", reason="xtgeo writes the ROFF file to compare with")
    xtgeo.grid_from_file(shared / "reservoir/reek/REEK.EGRID").to_file(tmp_path / "r.roff")
    binary, roff = load(shared / "reservoir/reek/REEK.EGRID"), load(tmp_path / "r.roff")
    assert np.array_equal(binary.active, roff.active)
    a, b = binary.to_world(binary.corners()), roff.to_world(roff.corners())
    assert np.abs(a - b).max() < 0.5  # ROFF keeps map coordinates in 32 bits


def test_roff_cut_off(tmp_path: Path) -> None:
    (tmp_path / "r.roff").write_bytes(b"roff-bin\0#ROFF file#\0tag\0filedata\0")
    with pytest.raises(LoadError, match="cannot be read as a ROFF grid"):
        load(tmp_path / "r.roff")


def test_gzip_of_a_binary_grid(tmp_path: Path, dome) -> None:
    write_egrid(tmp_path / "A.EGRID", dome)
    (tmp_path / "B.EGRID.gz").write_bytes(gzip.compress((tmp_path / "A.EGRID").read_bytes()))
    assert load(tmp_path / "B.EGRID.gz").active_count == dome.active_count


def test_vertex_values_do_not_bleed_across_faults(dome) -> None:
    # one value on each side of the first fault
    i = np.nonzero(dome.active)[2]
    fault = dome.dimensions[0] // 3
    corners = vertex_values(dome, np.where(i < fault, 1.0, 2.0))
    assert np.nanmax(np.abs(corners[..., :fault, :] - 1)) == 0
    assert np.nanmax(np.abs(corners[..., fault:, :] - 2)) == 0
    assert split_faces(dome, "i")[:, :, fault - 1].all()


def test_vertex_values_average_neighbours() -> None:
    grid = faulted_dome(4, 4, 4, throw=0.0)
    object.__setattr__(grid, "active", np.ones_like(grid.active))
    values = np.arange(64, dtype=np.float32)
    cells = values.reshape(4, 4, 4)
    corners = vertex_values(grid, values)
    assert corners[0, 1, 0, 1, 0, 1] == pytest.approx(cells[:2, :2, :2].mean())
    assert corners[0, 0, 0, 0, 0, 0] == 0
    values[21] = np.nan
    assert np.isfinite(vertex_values(grid, values)).all()
