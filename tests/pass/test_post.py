"""Post passes: known answers on spheres before spheres and on synthetic pictures."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from scuro import Camera, Settings
from scuro.errors import SettingsError
from scuro.passes.part import split
from scuro.render import Renderer
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene

SIZE = (160, 120)
FLAT = {
    "lighting__preset": "flat", "occlusion__technique": "none", "borders__width": 0.0,
    "antialias__method": "none",
}  # fmt: skip


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def spheres(*rows: tuple[float, float, float, float], color=(200, 60, 40, 255)) -> Scene:
    table = np.array(rows, np.float32)
    colors = np.tile(np.array(color, np.uint8), (len(table), 1))
    scene = Scene()
    geometry = Geometry(table, colors, np.arange(len(table), dtype=np.int32))
    scene.extra_bodies.append(Body(geometry, name="balls"))
    return scene


CAMERA = Camera((0, 0, 40), (0, 0, 0), height=12.0)
"""Ten pixels a unit."""


def pixels(renderer, scene, camera=CAMERA, **changes):
    settings = Settings(size=SIZE).replace(**(FLAT | changes))
    return renderer.render(scene, camera, settings).pixels.astype(int)


def dark(row) -> int:
    """Length in pixels of the dark lines in a row of pixels."""
    return int((row[:, :3].max(axis=-1) < 128).sum())


def test_a_border_is_as_wide_as_set_before_the_background(renderer):
    row = pixels(renderer, spheres((0, 0, 0, 3)), borders__width=4.0)[60]
    assert dark(row) == 8  # four pixels on either side
    left = np.flatnonzero(row[:, 0] != 255)[0]
    assert left == 80 - 30 - 4


@pytest.mark.parametrize("width", [6.0, 13.0])
def test_a_wide_border_is_even_all_around(renderer, width):
    from scipy.ndimage import distance_transform_edt

    scene = spheres((0, 0, 0, 3))
    ball = pixels(renderer, scene)[..., 1] < 255
    lined = pixels(renderer, scene, borders__width=width)[..., 0] / 255
    linear = np.where(lined <= 0.04045, lined / 12.92, ((lined + 0.055) / 1.055) ** 2.4)
    exact = np.clip(width + 1 - distance_transform_edt(~ball), 0, 1)
    assert np.abs(1 - linear - exact)[~ball].max() < 0.02


def test_a_border_lies_outside_and_keeps_the_surface(renderer):
    scene = spheres((0, 0, 0, 3))
    plain, lined = pixels(renderer, scene), pixels(renderer, scene, borders__width=3.0)
    inside = plain[..., 1] < 250
    assert (plain[inside] == lined[inside]).all()


def test_borders_grow_with_the_depth_jump(renderer):
    def width(gap: float) -> float:
        scene = spheres((0, 0, 0, 2), (0, 0, -10 - gap, 10))
        lined = pixels(renderer, scene, borders__width=4.0, borders__jump=8.0)
        plain = pixels(renderer, scene)
        return float(np.abs(lined - plain)[60, 40:120].sum()) / np.abs(plain[60, 80]).max()

    near, middle, far = width(0.0), width(2.0), width(7.0)
    assert near < middle < far


def test_one_convex_surface_has_no_borders_within(renderer):
    scene = spheres((0, 0, 0, 5.5))
    lined, plain = pixels(renderer, scene, borders__width=4.0), pixels(renderer, scene)
    surface = plain[..., 1] < 250
    # a handful of pixels on the very rim are steeper than the pass believes
    assert (lined[surface] != plain[surface]).any(axis=-1).mean() < 2e-3


def test_supersampling_keeps_the_width_of_lines(renderer):
    row = pixels(renderer, spheres((0, 0, 0, 3)), borders__width=4.0, antialias__method="2x")[60]
    assert dark(row) == 8


@pytest.mark.parametrize("method", ["2x", "3x", "4x"])
def test_supersampling_gives_each_edge_pixel_its_share(renderer, method):
    """A disc's coverage: the mean over the picture is its area, edges are neither hard nor dark."""
    scene = spheres((0.013, 0.021, 0, 3), color=(0, 0, 0, 255))
    picture = pixels(renderer, scene, antialias__method=method, background="white")
    linear = (picture[..., 0] / 255.0 + 0.055) / 1.055
    linear = np.where(linear > 0.09, linear**2.4, picture[..., 0] / 255 / 12.92)
    assert (1 - linear).sum() == pytest.approx(np.pi * 30**2, rel=0.005)
    assert ((picture[..., 0] > 20) & (picture[..., 0] < 235)).sum() > 100


def test_fxaa_softens_edges_and_nothing_else(renderer):
    scene = spheres((0, 0, 0, 3))
    plain, smooth = pixels(renderer, scene), pixels(renderer, scene, antialias__method="fxaa")
    changed = (plain != smooth).any(axis=-1)
    assert 50 < changed.sum() < 600
    y, x = np.nonzero(changed)
    assert (np.abs(np.hypot(x + 0.5 - 80, y + 0.5 - 60) - 30) < 3).all()


def test_a_halo_fades_with_distance_and_needs_a_jump(renderer):
    scene = spheres((0, 0, 0, 3))
    row = pixels(renderer, scene, halos__width=16.0, halos__opacity=1.0)[60, 112:140, 0]
    assert (np.diff(row) >= 0).all() and row[0] < 170 and row[-1] > 245
    inside = pixels(renderer, scene, halos__width=16.0)[60, 60:100]
    assert (inside == pixels(renderer, scene)[60, 60:100]).all()


def test_a_transparent_picture_carries_lines_and_halos_in_its_alpha(renderer):
    changes = {"background": "transparent", "borders__width": 3.0, "halos__width": 12.0}
    picture = pixels(renderer, spheres((0, 0, 0, 3)), **changes)
    assert (picture[60, 50:110, 3] == 255).all()
    assert (picture[60, 48, :3] == 0).all() and picture[60, 48, 3] == 255
    assert 0 < picture[60, 40, 3] < 255 and picture[0, 0, 3] == 0


def test_fog_begins_at_the_front_and_is_full_at_the_back(renderer):
    scene = spheres((-3, 0, 0, 1), (0, 0, -20, 1), (3, 0, -40, 1), color=(0, 0, 0, 255))
    picture = pixels(renderer, scene, fog__strength=1.0, fog__start=0.0, background="white")
    front, middle, back = picture[60, 50, 0], picture[60, 80, 0], picture[60, 110, 0]
    assert front == 0 and back > 240
    assert middle == pytest.approx(188, abs=8)  # sRGB of half


def test_fog_toward_a_transparent_background_turns_surfaces_transparent(renderer):
    scene = spheres((-3, 0, 0, 1), (3, 0, -40, 1))
    picture = pixels(renderer, scene, fog__strength=1.0, fog__start=0.0, background="transparent")
    assert picture[60, 50, 3] == 255 and picture[60, 110, 3] < 20


def test_toon_shading_has_few_tones(renderer):
    scene = spheres((0, 0, 0, 5), color=(128, 128, 128, 255))
    changes = {"lighting__preset": "simple", "toon__steps": 3}
    inside = pixels(renderer, scene, **changes)[30:90, 50:110]
    counts = np.bincount(inside[..., 0].ravel())
    assert np.sort(counts)[-4:].sum() > 0.85 * counts.sum()


def test_depth_of_field_keeps_what_is_in_focus(renderer):
    scene = spheres((-4, 0, 0, 2), (4, 0, -30, 2))
    plain = pixels(renderer, scene)
    near = pixels(renderer, scene, depth_of_field__blur=6.0, depth_of_field__distance=38.0)
    assert (plain[60, 35:45] == near[60, 35:45]).all()
    edges = np.abs(np.diff(near[60, :, 1]))
    assert edges[:60].max() > 2 * edges[100:].max()


def test_wide_circles_are_smooth_with_few_taps(renderer):
    """Also where bright and dark lie side by side, as many taps have it."""
    table = np.array([(x, y, -30, 1) for x in range(-12, 13, 2) for y in range(-9, 10, 2)])
    tones = np.where(np.arange(len(table)) % 3 > 0, 255, 0)
    colors = np.stack([tones, tones, tones, np.full_like(tones, 255)], axis=1).astype(np.uint8)
    numbers = np.arange(len(table), dtype=np.int32)
    scene = Scene()
    scene.extra_bodies.append(Body(Geometry(table.astype(np.float32), colors, numbers)))
    wide = {"depth_of_field__blur": 20.0, "depth_of_field__distance": 30.0}
    few, many = (
        pixels(renderer, scene, depth_of_field__taps=taps, **wide)[20:100, 20:140, 0]
        for taps in (64, 256)
    )
    assert np.abs(few - many).mean() < 1.3 and many.std() > 3


def test_red_cyan_of_a_grey_scene_is_grey_where_the_eyes_agree(renderer):
    camera = Camera((0, 0, 40), (0, 0, 0), fov=17.0)
    scene = spheres((0, 0, 0, 1), (0, 3, 15, 1), color=(128, 128, 128, 255))
    picture = pixels(renderer, scene, camera, stereo__mode="red-cyan")
    colorful = np.ptp(picture[..., :3], axis=-1)
    assert colorful[5, 5] <= 8  # the background
    assert colorful[55:65].max() <= 12  # the target has no parallax
    assert colorful[5:30].max() > 60  # what is nearer has fringes
    # and lies to the right for the left eye, which sees red
    red, cyan = (np.nonzero(picture[5:30, :, n] < 200)[1].mean() for n in (0, 1))
    assert red > cyan + 2


def test_eyes_agree_at_the_target_and_differ_before_it(renderer):
    camera = Camera((0, 0, 40), (0, 0, 0), fov=17.0)
    both = pixels(renderer, spheres((0, 0, 0, 1), (0, 3, 15, 1)), camera,
                  stereo__mode="side-by-side")  # fmt: skip

    def middle(rows: slice, columns: slice) -> float:
        return float(np.nonzero(both[rows, columns, 1] < 200)[1].mean())

    target = slice(55, 65)
    assert middle(target, slice(0, 80)) == pytest.approx(middle(target, slice(80, 160)), abs=0.5)
    upper = slice(5, 30)
    # what is nearer lies to the right for the left eye
    assert middle(upper, slice(0, 80)) > middle(upper, slice(80, 160)) + 2


def test_an_odd_width_cannot_be_halved(renderer):
    with pytest.raises(SettingsError, match="even width"):
        renderer.render(spheres((0, 0, 0, 1)), CAMERA,
                        Settings(size=(161, 120)).replace(stereo__mode="side-by-side"))  # fmt: skip


def test_parts_cover_the_picture_once():
    parts = split((1000, 700), scale=2, margin=70, max_texture=800, edge=800)
    seen = np.zeros((700, 1000), int)
    for part in parts:
        seen[part.rows, part.columns] += 1
        assert max(part.size) * 2 <= 800
    assert len(parts) > 1 and (seen == 1).all()


def test_parts_join_without_seams(renderer, monkeypatch):
    """Everything on: the picture in parts is the picture drawn at once."""
    rng = np.random.default_rng(4)
    rows = np.c_[rng.normal(size=(80, 3)) * [3, 2.2, 3], rng.uniform(0.6, 1.2, 80)]
    scene = spheres(*map(tuple, rows))
    changes = {
        "lighting__preset": "simple", "occlusion__technique": "ray", "borders__width": 2.0,
        "halos__width": 9.0, "fog__strength": 0.5, "depth_of_field__blur": 2.0,
        "antialias__method": "2x",
    }  # fmt: skip
    settings = Settings(size=(400, 300)).replace(**changes)
    whole = renderer.render(scene, CAMERA, settings).pixels.astype(int)

    def small(size, **options):
        from scuro.passes import part

        monkeypatch.setattr(part, "fits", lambda *a: False)
        return split(size, **{**options, "edge": 768})

    monkeypatch.setattr(sys.modules["scuro.render_parts"], "split", small)
    assert len(renderer.parts(settings)) > 1
    joined = renderer.render(scene, CAMERA, settings).pixels.astype(int)
    assert np.abs(whole - joined).max() <= 1
