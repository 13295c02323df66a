"""The path tracer: furnaces, energy, lights, and sums that go on."""

import time

import numpy as np
import pytest
from scenes import draw, floor, oblique, renderer, scene_of, spheres, walls

from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.lights import Light, Lighting

SKY = Lighting((), ambient=1.0)
FRONT = Camera((0, 0, 9), (0, 0, 0))
PAIR = ((-0.8, 0, 0, 1), (0.8, 0, 0, 1))


def _linear(scene, camera=FRONT, size=(48, 36), **changes):
    path = {"path__samples": 64, "path__bounces": 64, "path__antialias": False}
    image = draw(scene, camera, size, renderer="path", **path, **changes)
    return image.buffer("linear")[image.buffer("object") >= 0][:, :3]


@pytest.mark.parametrize(
    "material",
    [
        {"kind": "diffuse"},
        {"kind": "mirror"},
        {"kind": "glass"},
        {"kind": "metal", "roughness": 0.05},
    ],
    ids=lambda m: m["kind"],
)
def test_white_things_vanish_in_a_white_furnace(material):
    light = _linear(scene_of(spheres(*PAIR, **material), lighting=SKY))
    assert light.mean() == pytest.approx(1, abs=0.01)


def test_a_white_pit_vanishes_too_after_many_bounces():
    pit = scene_of(floor(half=2), walls(2, 6), lighting=SKY)
    light = _linear(pit, Camera((0, 0, 9), (0, 0, 0), (0, 1, 0), fov=20))
    assert light.mean() == pytest.approx(1, abs=0.02)


def test_glossy_and_rough_surfaces_make_no_light():
    # microfacets that scatter once lose what others would have reflected further
    for material, least in (({"kind": "glossy"}, 0.8), ({"kind": "metal", "roughness": 0.8}, 0.5)):
        light = _linear(scene_of(spheres(*PAIR, **material), lighting=SKY))
        assert least < light.mean() < 1.005, material


def test_a_convex_body_returns_its_albedo_of_the_sky():
    grey = (128, 128, 128, 255)
    albedo = ((128 / 255 + 0.055) / 1.055) ** 2.4
    light = _linear(scene_of(spheres((0, 0, 0, 2), color=grey), lighting=SKY))
    assert np.allclose(light, albedo, rtol=2e-3)


def test_without_light_it_is_dark():
    assert _linear(scene_of(spheres(*PAIR), lighting=Lighting((), ambient=0.0))).max() == 0


def test_direct_light_is_lamberts_and_shadowed_as_by_the_area_technique():
    light = Light(direction=(0, 0.3, -1), relative_to="world", size=6)
    scene = scene_of(floor(), spheres((0, 0, 3, 1)), lighting=Lighting((light,), ambient=0.0))
    changes = {"shadows__technique": "area", "shadows__samples": 256, "shadows__filter": False}
    deferred = draw(scene, oblique(), (64, 48), **changes).buffer("linear")[..., 0]
    path = draw(
        scene, oblique(), (64, 48), renderer="path", path__samples=128, path__bounces=1,
        path__antialias=False,
    ).buffer("linear")[..., 0]  # fmt: skip
    assert np.sqrt(np.mean((path - deferred) ** 2)) < 0.02
    assert abs(path.mean() - deferred.mean()) < 0.001


def test_smooth_metal_reflects_as_a_mirror():
    over = spheres((0, 0, 3, 1), color=(255, 0, 0, 255))
    mirror = _linear(scene_of(over, spheres((0, 0, -2, 2), kind="mirror"), lighting=SKY), oblique())
    metal = _linear(
        scene_of(over, spheres((0, 0, -2, 2), kind="metal", roughness=0.02), lighting=SKY),
        oblique(),
    )
    assert np.abs(mirror.mean(axis=0) - metal.mean(axis=0)).max() < 0.01


def test_glass_shows_what_is_behind_it_and_bends_its_rays():
    behind = spheres((0, 0, -6, 3), color=(255, 0, 0, 255))
    plain = _linear(scene_of(behind, spheres((0, 0, 2, 1), kind="glass", ior=1.0), lighting=SKY))
    glass = _linear(scene_of(behind, spheres((0, 0, 2, 1), kind="glass", ior=1.5), lighting=SKY))
    bare = _linear(scene_of(behind, lighting=SKY))
    assert plain.mean(axis=0) == pytest.approx(bare.mean(axis=0), abs=0.02)
    assert np.abs(glass - plain).max() > 0.3


def test_glass_bends_rays_as_snell_says():
    ball = scene_of(spheres((0, 0, 0, 1), kind="glass", ior=1.5), lighting=SKY)
    camera = Camera((0, 0, 9), (0, 0, 0), height=2.4)
    image = draw(
        ball, camera, (96, 96), renderer="path", path__samples=64, path__bounces=16,
        path__environment="gradient", path__antialias=False,
    )  # fmt: skip
    x, y, _ = np.moveaxis(image.buffer("position"), -1, 0)
    here = (np.abs(y - 0.5) < 0.02) & (np.abs(x) < 0.06)
    # of a ray at half the radius 8 percent are reflected up on entry, as many within
    turned = 2 * (np.arcsin(0.5) - np.arcsin(0.5 / 1.5))
    through = 1 - 0.7 * np.sin(turned)
    assert image.buffer("linear")[here][:, 0].mean() == pytest.approx(through, abs=0.06)


def test_the_same_seed_gives_the_same_bits_and_another_seed_others():
    scene = scene_of(floor(), spheres((0, 0, 1, 1)), lighting=SKY)
    change = {"renderer": "path", "path__samples": 3, "size": (32, 24)}

    def pixels(seed):
        renderer().restart()
        return draw(scene, oblique(), seed=seed, **change).buffer("linear").copy()

    assert (pixels(5) == pixels(5)).all()
    assert (pixels(5) != pixels(6)).any()


def test_sums_go_on_where_they_stopped():
    scene = scene_of(floor(), spheres((0, 0, 1, 1)), lighting=SKY)
    at_once = draw(scene, oblique(), (32, 24), renderer="path", path__samples=8, seed=1)
    whole = at_once.buffer("linear").copy()
    draw(scene, oblique(), (32, 24), renderer="path", path__samples=2, seed=1)
    assert renderer()._paths.samples == 2
    gone_on = draw(scene, oblique(), (32, 24), renderer="path", path__samples=8, seed=1)
    assert (gone_on.buffer("linear") == whole).all()


def test_a_time_budget_ends_it_after_at_least_one_sample():
    scene = scene_of(spheres((0, 0, 0, 1)), lighting=SKY)
    start = time.perf_counter()
    draw(scene, FRONT, (32, 24), renderer="path", path__samples=60_000, path__seconds=0.2)
    assert time.perf_counter() - start < 5 and renderer()._paths.samples >= 1


def test_settings_are_checked():
    for changes in ({"path__samples": 0}, {"path__bounces": 0}, {"path__seconds": float("nan")}):
        with pytest.raises(Exception, match=r"must be at least|finite"):
            Settings().replace(**changes)
