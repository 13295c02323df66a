"""Shadows held to closed forms: shadow discs of a sphere on a plane."""

import math

import numpy as np
import pytest
from scenes import draw, floor, oblique, scene_of, spheres

from scuro.errors import SettingsError
from scuro.render_settings import Settings
from scuro.scene.geometry import Body, Geometry
from scuro.scene.lights import Light, Lighting

DOWN = Light(direction=(0, 0, -1), relative_to="world")


def _plane(image):
    """Distance from the axis and shadow, for the floor's pixels."""
    on_floor = np.abs(image.buffer("position")[..., 2]) < 1e-3
    x, y = np.moveaxis(image.buffer("position")[on_floor][:, :2], -1, 0)
    return np.hypot(x, y), image.buffer("shadow")[on_floor]


def _lit(light, *, height=3.0, size=(128, 96), **changes):
    scene = scene_of(floor(), spheres((0, 0, height, 1)), lighting=Lighting((light,)))
    return _plane(draw(scene, oblique(), size, **changes))


@pytest.mark.parametrize(
    ("light", "radius"),
    [
        (DOWN, 1.0),
        (Light(kind="point", position=(0, 0, 6), relative_to="world"), 6 / math.sqrt(8)),
        (
            Light(kind="spot", position=(0, 0, 6), direction=(0, 0, -1), cone=60,
                  relative_to="world"),
            6 / math.sqrt(8),
        ),
    ],
    ids=["directional", "point", "spot"],
)  # fmt: skip
def test_hard_shadow_of_a_sphere_is_the_disc_that_geometry_says(light, radius):
    distance, lit = _lit(light, shadows__technique="hard")
    assert (lit[distance < radius - 0.02] == 0).all() and (distance < radius).any()
    assert (lit[distance > radius + 0.02] == 1).all()


def test_a_point_lights_ray_ends_at_the_light():
    below = Light(kind="point", position=(0, 0, 1.5), relative_to="world")
    _, lit = _lit(below, shadows__technique="hard")
    assert (lit == 1).all(), "the sphere hangs above the light"


def test_pixels_out_of_reach_or_turned_away_stay_lit():
    light = Light(kind="point", position=(0, 0, 6), reach=6.2, relative_to="world")
    distance, lit = _lit(light, shadows__technique="hard")
    reached = np.hypot(distance, 6) < 6.2
    assert (lit[~reached] == 1).all() and (lit[reached & (distance < 1.4)] == 0).all()


def test_area_light_is_covered_by_the_share_that_the_sphere_hides():
    # on the axis: discs of tangent 1/sqrt(24) and 0.3, one within the other
    light = Light(direction=(0, 0, -1), relative_to="world", size=math.degrees(math.atan(0.3)))
    distance, lit = _lit(
        light, height=5.0, shadows__technique="area", shadows__samples=256, shadows__filter=False
    )
    assert lit[distance < 0.15].mean() == pytest.approx(1 - (1 / 24) / 0.09, abs=0.015)
    assert (lit[distance > 1.02 * (5 * 0.3 + math.sqrt(1 + 0.3**2)) + 0.05] == 1).all()


def test_few_filtered_area_samples_agree_with_many():
    light = Light(direction=(0, 0, -1), relative_to="world", size=8)
    few = _lit(light, shadows__technique="area")[1]
    many = _lit(light, shadows__technique="area", shadows__samples=256)[1]
    assert np.sqrt(np.mean((few - many) ** 2)) < 0.04


def _on_a_ball(technique, **changes):
    """Shadow of a sphere of radius 1 on the flat top of a huge one; light straight down."""
    lighting = Lighting((DOWN.replace(size=4),))
    bodies = spheres((0, 0, -300, 300)), spheres((0, 0, 3, 1))
    image = draw(
        scene_of(*bodies, lighting=lighting), oblique(), (128, 96),
        shadows__technique=technique, **changes,
    )  # fmt: skip
    position = image.buffer("position")
    below = position[..., 2] < 0.1
    return np.hypot(position[..., 0], position[..., 1])[below], image.buffer("shadow")[below]


def test_soft_shadows_are_near_those_of_an_area_light_for_one_ray():
    truth = _on_a_ball("area", shadows__samples=256, shadows__filter=False)[1]

    def error(technique, **changes):
        return np.sqrt(np.mean((_on_a_ball(technique, **changes)[1] - truth) ** 2))

    assert error("soft") < 0.02
    assert error("soft") < 0.5 * error("hard")
    assert error("soft") < 0.5 * error("soft", shadows__ratio=1.4)


def test_parkers_form_fades_between_the_two_spheres_as_printed():
    distance, lit = _on_a_ball("soft", shadows__ratio=2.5)
    s = np.clip((distance - 1) / 1.5, 0, 1)
    assert np.allclose(lit, s * s * (3 - 2 * s), atol=2e-3), "also beyond the solids' own boxes"


def test_soft_shadows_of_rods_and_of_meshes():
    rod = Body(Geometry(
        rods=np.array([[[-3, 0, 3, 0.5], [3, 0, 3, 0.5]]], np.float32),
        rod_colors=np.full((1, 2, 4), 255, np.uint8), rod_ids=np.zeros((1, 2), np.int32),
    ))  # fmt: skip
    for ground in (spheres((0, 0, -300, 300)), floor()):
        scene = scene_of(ground, rod, lighting=Lighting((DOWN.replace(size=4),)))
        image = draw(scene, oblique(), (128, 96), shadows__technique="soft")
        position, lit = image.buffer("position"), image.buffer("shadow")
        x, y, z = np.moveaxis(position, -1, 0)
        below = (z < 0.1) & (np.abs(x) < 2)
        assert (lit[below & (np.abs(y) < 0.25)] < 0.15).all()
        assert (lit[below & (np.abs(y) > 0.75)] > 0.85).all()
        edge = lit[below & (np.abs(np.abs(y) - 0.5) < 0.05)]
        assert 0.3 < edge.mean() < 0.7


def test_instances_cast_the_same_soft_shadow_as_a_body_of_their_own():
    ground, lighting = spheres((0, 0, -300, 300)), Lighting((DOWN.replace(size=4),))
    one = spheres((0, 0, 0, 1))
    placed = Body(
        one.geometry,
        np.array([[0, 0, 0, 1], [0, 0, 0.6, 0.8]], np.float32),
        np.array([[-2.5, 0, 3], [2.5, 0, 3]], np.float64),
    )
    whole = spheres((-2.5, 0, 3, 1), (2.5, 0, 3, 1))
    first, second = (
        draw(scene_of(ground, body, lighting=lighting), oblique(), shadows__technique="soft")
        .buffer("shadow").copy()
        for body in (placed, whole)
    )  # fmt: skip
    assert np.abs(first - second).max() < 1e-2 and first.min() == 0


@pytest.mark.parametrize("light", [
    DOWN,
    Light(kind="point", position=(0, 0, 6), relative_to="world"),
], ids=["directional", "point"])  # fmt: skip
def test_mapped_shadows_agree_with_rays_but_for_the_edges(light):
    mapped = _lit(light, shadows__technique="mapped", shadows__map_size=512)[1]
    hard = _lit(light, shadows__technique="hard")[1]
    assert np.mean(np.abs(mapped - hard)) < 0.01
    assert np.mean(np.abs(mapped - hard) > 0.6) < 0.01, "no acne"


def test_a_sphere_does_not_shade_itself():
    scene = scene_of(spheres((0, 0, 0, 1)), lighting=Lighting((DOWN,)))
    for technique in ("hard", "soft", "area", "mapped"):
        image = draw(scene, oblique(4), shadows__technique=technique, shadows__light_size=0.0)
        # a map's texels are flat: close to the terminator they may shade each other
        seen = image.buffer("normal")[..., 2] > (0.2 if technique == "mapped" else -1)
        assert (image.buffer("shadow")[seen] == 1).all(), technique


def test_each_casting_light_has_its_own_layer_and_others_have_none():
    lights = (
        DOWN.replace(intensity=0.5, shadow=False),
        Light(direction=(0, 1, -1), relative_to="world"),
        Light(direction=(0, -1, -1), relative_to="world"),
    )
    scene = scene_of(floor(), spheres((0, 0, 3, 1)), lighting=Lighting(lights))
    image = draw(scene, oblique(), shadows__technique="hard")
    _, y = np.moveaxis(image.buffer("position")[..., :2], -1, 0)
    shadow = image.buffer("shadow")
    on_floor = np.abs(image.buffer("position")[..., 2]) < 1e-3
    # the lights' mean: each disc is in one light only
    assert set(np.unique(shadow[on_floor])) == {0.5, 1.0}
    shaded = y[on_floor & (shadow == 0.5)]
    assert shaded.min() < -2 and shaded.max() > 2 and not (np.abs(shaded) < 1).any()


def test_wrong_values_are_said():
    with pytest.raises(SettingsError, match=r"known: .*hard"):
        Settings().replace(shadows__technique="sharp")
    with pytest.raises(SettingsError, match="at least 1"):
        Settings().replace(shadows__samples=0)
