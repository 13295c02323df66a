"""Reservoirs on the GPU: cells as packed, values at vertices, point location, strategies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scuro
from scuro.gpu import Gpu
from scuro.gpu.shader import load_text
from scuro.passes.reservoir.light import bricks_with
from scuro.passes.reservoir.model import ReservoirModel
from scuro.passes.reservoir.pack import RING, PackedReservoir
from scuro.passes.volume.light import LightTexture
from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.cornerpoint_topology import vertex_values
from scuro.scene.geometry import Body, Geometry
from scuro.scene.lights import Light, Lighting
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.style.reservoir_options import ReservoirSettings

SIZE = (72, 56)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


@pytest.fixture(scope="module")
def dome() -> CornerPointGrid:
    return faulted_dome(18, 16, 8)


def box(ni: int = 4, nj: int = 3, nk: int = 2, **changes) -> CornerPointGrid:
    """A block of cubes, 10 units a side, from depth 100 on; the value is that of PORO."""
    x, y = np.meshgrid(np.arange(ni + 1) * 10.0, np.arange(nj + 1) * 10.0)
    ends = [np.stack([x, y, np.full_like(x, d)], -1) for d in (100.0, 200.0)]
    layer = 100 + 10 * np.arange(nk + 1, dtype=np.float32)
    zcorn = np.empty((nk, 2, nj, 2, ni, 2), np.float32)
    zcorn[:, 0], zcorn[:, 1] = (a[:, None, None, None, None] for a in (layer[:-1], layer[1:]))
    active = changes.pop("active", np.ones((nk, nj, ni), bool))
    values = np.full(np.count_nonzero(active), 0.5, np.float32)
    grid = CornerPointGrid(
        np.stack(ends, axis=2), zcorn, active, name="box", statics={"PORO": values}
    )
    return replace(grid, **changes)


def model_of(renderer: Renderer, grid: CornerPointGrid, exaggeration: float = 2.0):
    low, high = grid.bounds * (1, 1, exaggeration)
    return ReservoirModel(renderer.gpu, grid, (low + high) / 2, exaggeration)


def picture(
    renderer: Renderer,
    grid: CornerPointGrid,
    direction=(0.4, -1, 0.7),
    *,
    raw: bool = False,
    **changes,
):
    """The 8-bit picture, or linear color and opacity."""
    scene = Scene().add(grid)
    volume = {"reservoir__show": "volume", "reservoir__wells": False}
    settings = scuro.Settings(size=SIZE).replace(**volume | changes)
    scene.show_reservoirs(settings.reservoir)
    camera = Camera.fitted(
        scene.bounds(), direction=direction, up=(0, 0, 1), aspect=SIZE[0] / SIZE[1]
    )
    frame = renderer.frame(scene, camera, settings)
    frame.recorder.submit()
    return renderer.gpu.read_texture(frame.resources["color" if raw else "picture"]).astype(float)


def test_corners_survive_packing(dome: CornerPointGrid) -> None:
    center, e = dome.bounds.mean(axis=0) * (1, 1, 3), 3.0
    packed = PackedReservoir(dome, center, e)
    cells = np.flatnonzero(dome.active)
    world = dome.to_world(dome.corners(cells), e) - center
    k, j, i = np.unravel_index(cells, dome.active.shape)
    ni = dome.dimensions[0]
    column = packed.columns[j * ni + i]
    surface = column["start"] + packed.top_surface[k] - column["first"]
    for corner, (dj, di) in enumerate(RING):
        pillar = packed.pillars[(j + dj) * (ni + 1) + i + di]
        for side in range(2):
            z = pillar["base"] - pillar["step"] * packed.depths[surface + side, corner]
            place = np.concatenate(
                [pillar["at"] + pillar["slope"] * z[:, None], z[:, None]], axis=1
            )
            # half a step of 1/65535 of the pillar's range of depths, and 32-bit rounding
            assert np.abs(place - world[:, side, dj, di]).max() < 0.01


def test_gaps_between_layers_are_layers(renderer: Renderer) -> None:
    grid = box(nk=3)
    apart = grid.zcorn.copy()
    apart[2] += 4  # the third layer lies lower than the second one's bottom
    gapped = replace(grid, zcorn=apart)
    assert PackedReservoir(grid, np.zeros(3), 1.0).layers == 3
    packed = PackedReservoir(gapped, np.zeros(3), 1.0)
    assert packed.layers == 4
    assert packed.cell_of_layer.tolist() == [0, 1, -1, 2]
    # from the side, the gap is clear and the cells are not
    opaque = {"reservoir__opacity": "0:0.99 1:0.99", "strategy__step": 0.02}
    picture_ = picture(renderer, gapped, (0, -1, 0), raw=True, **opaque)
    column = picture_[:, SIZE[0] // 2, 3]
    runs = np.flatnonzero(np.diff((column > 0.5).astype(int)))
    assert len(runs) == 4  # in, out at the gap, in again, out


def test_vertex_values_agree_with_numpy(renderer: Renderer, dome: CornerPointGrid) -> None:
    model = model_of(renderer, dome)
    values = dome.values("SWAT", 1)
    model.set_values(values, 0.0, 1.0)
    expected = vertex_values(dome, values)
    packed = model.cells
    stored = renderer.gpu.read_texture(model.resources["values"]).reshape(-1, 4)
    for corner, (dj, di) in enumerate(RING):
        for side in range(2):
            want = expected[:, side, :, dj, :, di][dome.active]
            have = stored[packed.slots + side, corner] / 65535
            # numpy does not look through the layer that pinches out
            k = np.nonzero(dome.active)[0]
            close = np.abs(have - want)[np.abs(k - 4) > 1] < 2e-4
            assert close.mean() > 0.999


def located(renderer: Renderer, model: ReservoirModel, columns, layers, at):
    """Parametric coordinates turned to places and back, and the cells located there."""
    source = load_text(
        """
//#include "../passes/reservoir/locate.wgsl"
// parametric coordinates and what is asked, column and layer; the answer takes the first's place
@group(2) @binding(0) var<storage, read_write> rows: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = id.x;
    if (n * 2u >= arrayLength(&rows)) { return; }
    let width = i32(model.columns.x);
    let column = i32(rows[2u * n + 1u].x);
    var frame = frame_of(vec2i(column % width, column / width));
    let layer = i32(rows[2u * n + 1u].y);
    let top = surface_z(frame, layer);
    let bottom = surface_z(frame, layer + 1);
    let at = rows[2u * n].xyz;
    let z = mix(top, bottom, at.z);
    let w = ring_weights(at.xy);
    let x = frame.x + frame.slope_x * z;
    let y = frame.y + frame.slope_y * z;
    let p = vec3f(dot(w, x), dot(w, y), dot(w, z));
    if (rows[2u * n].w > 0.0) {
        rows[2u * n] = vec4f(parametric(frame, top, bottom, p, vec3f(0.5)), 1.0);
        return;
    }
    let found = locate(p, &frame);
    let index = frame.index.y * width + frame.index.x;
    rows[2u * n] = vec4f(f32(index), f32(found.layer), select(0.0, 1.0, found.found), 0.0);
}
""",
        "test_locate.wgsl",
    )
    gpu = renderer.gpu
    out = []
    for flag in (1.0, 0.0):
        rows = np.zeros((len(at), 2, 4), np.float32)
        rows[:, 0, :3], rows[:, 0, 3] = at, flag
        rows[:, 1, 0], rows[:, 1, 1] = columns, layers
        buffer = gpu.buffer(rows)
        gpu.compute(source, "main", (len(at),), {**model.resources, "rows": buffer})
        out.append(gpu.read_buffer(buffer).reshape(-1, 2, 4)[: len(at), 0])
    return out


def round_trip(renderer: Renderer, grid: CornerPointGrid, count: int):
    model = model_of(renderer, grid, 1.0)
    rng = np.random.default_rng(4)
    packed = model.cells
    k, j, i = np.nonzero(grid.active)
    pick = rng.integers(0, len(k), count)
    column = (j * grid.dimensions[0] + i)[pick]
    layer = packed.top_surface[k[pick]] - packed.columns["first"][column]
    at = rng.uniform(0.001, 0.999, (count, 3)).astype(np.float32)
    back, found = located(renderer, model, column, layer, at)
    thick = (grid.zcorn[:, 1] - grid.zcorn[:, 0]).min(axis=(2, 4))[grid.active][pick]
    return np.abs(back[:, :3] - at).max(axis=1), found, column, layer, thick


@pytest.mark.parametrize("name", ["brugge/BRUGGE_0000.EGRID", "reek/REEK.EGRID"])
def test_parametric_round_trip_in_real_cells(renderer: Renderer, shared: Path, name: str) -> None:
    grid = _load(shared, name)
    error, found, column, layer, thick = round_trip(renderer, grid, 1_000_000)
    # half of [-1, 1]: coordinates here run from 0 to 1
    assert np.quantile(error[thick > 1], 0.9999) < 5e-5
    whole = thick > 1
    assert found[whole, 2].mean() > 0.9999
    same = (found[:, 0] == column) & (found[:, 1] == layer)
    assert same[whole].mean() > 0.999


def _load(shared: Path, name: str) -> CornerPointGrid:
    from scuro.load import load

    return load(shared / "reservoir" / name)


def test_location_in_a_faulted_dome(renderer: Renderer, dome: CornerPointGrid) -> None:
    error, found, column, layer, thick = round_trip(renderer, dome, 100_000)
    whole = thick > 0.5
    assert np.quantile(error[whole], 0.999) < 5e-5
    same = (found[:, 0] == column) & (found[:, 1] == layer) & (found[:, 2] > 0)
    assert same[whole].mean() > 0.995


@pytest.mark.parametrize(
    ("technique", "fast"), [("libc", False), ("libc", True), ("plts", False), ("srg", False)]
)
def test_constant_block_has_the_closed_form_opacity(
    renderer: Renderer, technique: str, fast: bool
) -> None:
    grid = box(4, 4, 4)
    color = picture(
        renderer,
        grid,
        (0, -1, 0),
        raw=True,
        reservoir__opacity="0:0.1 1:0.1",
        reservoir__exaggeration=1.0,
        strategy__technique=technique,
        strategy__fast=fast,
        strategy__resample=6.0,
    )
    # four cells of 10 units deep, the opacity is that of one cell's least extent
    opacity = color[SIZE[1] // 2, SIZE[0] // 2, 3]
    assert opacity == pytest.approx(1 - 0.9**4, abs=0.02)
    assert color[0, 0, 3] == 0


def test_strategies_agree(renderer: Renderer, dome: CornerPointGrid) -> None:
    reference = picture(renderer, dome, strategy__technique="plts")
    for limit, changes in (
        (0.6, {"strategy__technique": "libc", "strategy__fast": False}),
        (0.6, {"strategy__technique": "libc", "strategy__fast": True}),
        (1.6, {"strategy__technique": "srg"}),
    ):
        other = picture(renderer, dome, **changes)
        assert np.abs(other - reference).mean() < limit, changes
    assert reference.std() > 5


DIRECTIONS = [(0, 0, 1), (0, -1, 0.001), (1, 0, 0), (0.3, 0.2, -1)] + [
    tuple(np.random.default_rng(n).normal(size=3).tolist()) for n in range(10)
]


@pytest.mark.parametrize("name", ["dome", "opm_model2/9_EDITNNC.EGRID", "spe9/SPE9.EGRID"])
def test_no_pinholes(renderer: Renderer, dome: CornerPointGrid, request, name: str) -> None:
    """No pixel within the silhouette of an opaque model shows the background, from any side."""
    grid = dome if name == "dome" else _load(request.getfixturevalue("shared"), name)
    plain = {
        "occlusion__technique": "none", "shadows__technique": "none", "antialias__method": "none",
        "strategy__occlusion": False,
    }  # fmt: skip
    opaque = {"reservoir__show": "volume", "reservoir__opacity": "-1e9:0.999 1e9:0.999"}
    for direction in DIRECTIONS:
        volume = picture(renderer, grid, direction, raw=True, **opaque, **plain)[..., 3]
        shell = picture(renderer, grid, direction, raw=True, reservoir__show="cells", **plain)
        inside = np.pad(shell[..., 3] > 0.5, 1)
        around = [np.roll(inside, shift, (0, 1)) for shift in np.ndindex(3, 3)]
        inner = np.all(around, axis=0)[2:, 2:]  # not the silhouette itself
        assert inner.sum() > 60
        assert not (inner & (volume < 0.5)).any(), direction


def test_inactive_cells_are_holes(renderer: Renderer) -> None:
    active = np.ones((2, 3, 4), bool)
    active[:, 1, 1] = False
    opaque = {"reservoir__opacity": "0:0.99 1:0.99", "reservoir__exaggeration": 0.1}
    whole = picture(renderer, box(), (0, 0, 1), raw=True, **opaque)[..., 3]
    holed = picture(renderer, box(active=active), (0, 0, 1), raw=True, **opaque)[..., 3]
    share = np.count_nonzero((whole > 0.5) & (holed < 0.5)) / np.count_nonzero(whole > 0.5)
    assert share == pytest.approx(1 / 12, abs=0.03)


def test_collapsed_inverted_and_nan_cells_end(renderer: Renderer) -> None:
    grid = faulted_dome(10, 10, 6)
    zcorn = grid.zcorn.copy()
    zcorn[2, 1] = zcorn[2, 0]  # collapsed
    zcorn[4, 0], zcorn[4, 1] = grid.zcorn[4, 1], grid.zcorn[4, 0]  # inside out
    values = grid.values("PORO").copy()
    values[::7] = np.nan
    bad = replace(grid, zcorn=zcorn, statics={"PORO": values}, steps=())
    for technique in ("libc", "plts", "srg"):
        color = picture(renderer, bad, raw=True, strategy__technique=technique)
        assert np.isfinite(color).all() and color[..., 3].max() > 0.05


def test_time_steps_change_colors_only(renderer: Renderer, dome: CornerPointGrid) -> None:
    scene = Scene().add(dome)
    settings = scuro.Settings(size=SIZE).replace(
        reservoir__show="volume", reservoir__property="SWAT", reservoir__time=0
    )
    renderer.render(scene, None, settings)
    before = renderer.reservoirs.model(scene.reservoirs[0])
    first = np.asarray(renderer.render(scene, None, settings), float)
    changed = settings.replace(reservoir__time=-1)
    last = np.asarray(renderer.render(scene, None, changed), float)
    assert np.abs(first - last).max() > 20
    assert renderer.reservoirs.model(scene.reservoirs[0]) is before


def test_left_handed_models_are_not_mirrored(renderer: Renderer) -> None:
    """j to the north or to the south: the same place in the world looks the same."""
    grid = box(4, 3, 2)
    values = np.zeros((2, 3, 4), np.float32)
    values[:, 0, 3] = 1  # south-east
    plain = replace(grid, statics={"PORO": values.ravel()})
    turned = replace(
        grid,
        coord=grid.coord[::-1].copy(),
        zcorn=grid.zcorn[:, :, ::-1, ::-1].copy(),
        statics={"PORO": values[:, ::-1].ravel().copy()},
    )
    assert plain.right_handed != turned.right_handed
    for show in ("volume", "cells"):
        a, b = (picture(renderer, g, (0.2, -0.5, 1), reservoir__show=show) for g in (plain, turned))
        assert np.abs(a - b).max() <= 3
    flat = picture(renderer, plain, (0, -0.01, 1), reservoir__show="cells")
    # east is right and south is down: the odd cell, dark red on dark blue, is at the lower right
    odd = np.argwhere(flat[..., 0] > flat[..., 2] + 40)
    assert odd[:, 1].mean() > SIZE[0] / 2 and odd[:, 0].mean() > SIZE[1] / 2


def test_occlusion_darkens_only(renderer: Renderer, dome: CornerPointGrid) -> None:
    plain = picture(renderer, dome, raw=True, strategy__occlusion=False)
    dark = picture(renderer, dome, raw=True, strategy__occlusion=True)
    assert (dark[..., :3] <= plain[..., :3] + 0.01).all()
    assert plain[..., :3].sum() - dark[..., :3].sum() > 0.02 * plain[..., :3].sum()
    assert np.abs(dark[..., 3] - plain[..., 3]).max() < 0.01


def test_memory_is_small(renderer: Renderer) -> None:
    grid = faulted_dome(60, 60, 40)
    model = model_of(renderer, grid)
    assert model.bytes_per_cell < 24  # the thesis: 211.5 MB for 6.2 million cells, 34 bytes each


def test_default_limits() -> None:
    gpu = Gpu(default_limits=True)
    color = picture(Renderer(gpu=gpu), faulted_dome(8, 8, 4), raw=True, strategy__occlusion=True)
    assert color[..., 3].max() > 0.05


def ball_at(height: float) -> Body:
    geometry = Geometry(
        spheres=np.array([[0, 0, 0, 9]], np.float32),
        sphere_colors=np.full((1, 4), 255, np.uint8),
        sphere_ids=np.zeros(1, np.int32),
    )
    return Body(geometry, positions=np.array([[30.0, 30.0, height]]))


def test_solids_and_the_model_take_light_from_each_other(renderer: Renderer) -> None:
    """A ball in a block shades what lies below, and gets less light through the block."""
    grid = box(6, 6, 3)
    settings = scuro.Settings(size=SIZE).replace(
        reservoir__show="volume", reservoir__wells=False, reservoir__exaggeration=1.0,
        reservoir__opacity="0:0.3 1:0.3",
        strategy__occlusion=False,
        occlusion__technique="none", shadows__technique="none",
    )  # fmt: skip
    camera = Camera.fitted(
        np.array([[0, 0, -130], [60, 60, -70]]), direction=(0, -1, 0.2), up=(0, 0, 1), aspect=1.3
    )

    def drawn(height: float | None, **changes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        scene = Scene().add(grid)
        scene.extra_bodies = [ball_at(height)] if height is not None else []
        frame = renderer.frame(scene, camera, settings.replace(**changes))
        frame.recorder.submit()
        read = renderer.gpu.read_texture
        names = ("volume_color", "color", "surface")
        return tuple(read(frame.resources[name]).astype(float) for name in names)

    shadow = {"strategy__shadow": True}
    clearer = {**shadow, "reservoir__opacity": "0:0.08 1:0.08"}
    volume, _, surface = drawn(-106.0, **clearer)
    alone, _, _ = drawn(None, **clearer)
    seen = (alone[..., 3] > 0.05) & (surface[..., 3] == 0)
    assert (volume[seen, :3] <= alone[seen, :3] + 1e-2).all()
    share = volume[seen, :3].sum(axis=1) / alone[seen, :3].sum(axis=1)
    assert share.min() < 0.92 and np.median(share) > 0.97
    assert np.abs(volume[seen, 3] - alone[seen, 3]).max() < 1e-3
    left = []
    for changes in ({}, shadow):
        volume, color, surface = drawn(-115.0, **changes)
        ball = surface[..., 3] > 0
        left.append((color - volume)[ball, :3].sum())
    assert left[1] < 0.85 * left[0]


def test_light_is_made_anew_only_where_something_changed(
    dome: CornerPointGrid, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    make = LightTexture.make
    monkeypatch.setattr(LightTexture, "make", lambda *args: (made.append(1), make(*args)))
    renderer, scene = Renderer(), Scene().add(dome)
    settings = scuro.Settings(size=SIZE).replace(
        reservoir__show="volume", strategy__shadow=True, strategy__occlusion=False
    )
    lighting = Lighting((Light(direction=(0.3, -0.4, 1), relative_to="world"),))
    scene.lighting = lighting
    scene.show_reservoirs(settings.reservoir)

    def drawn(azimuth: float, **changes) -> np.ndarray:
        camera = view_camera(scene, ViewSettings(azimuth=azimuth), 1.0)
        return np.asarray(renderer.render(scene, camera, settings.replace(**changes)))

    first = drawn(0)
    np.testing.assert_array_equal(drawn(0), first)
    turned = drawn(25)
    assert len(made) == 1, "the lights stand still"
    np.testing.assert_array_equal(turned, np.asarray(
        Renderer().render(scene, view_camera(scene, ViewSettings(azimuth=25), 1.0), settings)
    ))  # fmt: skip
    made.clear()
    occluded = [drawn(azimuth, strategy__occlusion=True) for azimuth in (0, 0, 25)]
    assert len(made) == 2, "occlusion is toward the eye"
    np.testing.assert_array_equal(occluded[0], occluded[1])
    scene.lighting = replace(lighting, lights=(Light(direction=(-1, 0, 0), relative_to="world"),))
    drawn(25)
    drawn(25, reservoir__opacity="0:0.2 1:0.2")
    assert len(made) == 4


def test_cameras_are_fitted_to_the_cells_that_are_seen() -> None:
    grid = box(20, 6, 2)
    scene = Scene().add(replace(grid, statics={"PORO": np.arange(240, dtype=np.float32)}))

    def outline(**changes) -> np.ndarray:
        scene.show_reservoirs(ReservoirSettings(property="PORO", exaggeration=1.0, **changes))
        points = scene.reservoirs[0].outline
        return np.stack([points.min(axis=0), points.max(axis=0)])

    whole = [[0, 0, -120], [200, 60, -100]]
    np.testing.assert_allclose(outline(show="cells"), whole)
    np.testing.assert_allclose(outline(show="cells", box="i=3:4"), [[20, 0, -120], [40, 60, -100]])
    np.testing.assert_allclose(
        outline(show="slices", slices="j2"), [[0, 10, -120], [200, 20, -100]]
    )
    # the lower layer's values are the greater ones
    upper = outline(show="volume", opacity="0:0 119:0 120:0.5")
    np.testing.assert_allclose(upper, [[0, 0, -120], [200, 60, -110]])
    np.testing.assert_allclose(outline(show="volume", opacity="0:0 1:0"), whole)


def test_light_is_made_where_samples_read_it() -> None:
    matter = np.random.default_rng(3).random((9, 6, 13)) < 0.01
    counts = [3, 2, 4]
    expected = np.zeros(counts, np.uint32)
    for voxel in np.argwhere(matter):
        for offset in np.ndindex(3, 3, 3):
            beside = voxel + offset - 1
            if (beside >= 0).all() and (beside < np.array(counts) * 4).all():
                expected[tuple(beside // 4)] = 1
    assert 0 < expected.mean() < 1
    assert (bricks_with(matter) == expected.ravel()).all()
