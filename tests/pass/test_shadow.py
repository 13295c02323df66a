"""Shadows held to closed forms: shadow discs of a sphere on a plane."""

import math

import numpy as np
import pytest
from scenes import draw, floor, oblique, scene_of, spheres

from scuro.errors import SettingsError
from scuro.render_settings import Settings
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


def test_a_sphere_does_not_shade_itself():
    scene = scene_of(spheres((0, 0, 0, 1)), lighting=Lighting((DOWN,)))
    for technique in ("hard", "area"):
        image = draw(scene, oblique(4), shadows__technique=technique, shadows__light_size=0.0)
        assert (image.buffer("shadow") == 1).all(), technique


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
