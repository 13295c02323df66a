"""Ray-traced occlusion, the path tracer with one bounce under a constant sky, and the closed form.

All three are the cosine-weighted share of the hemisphere that is open.
"""

import numpy as np
import pytest
from scenes import draw, floor, oblique, scene_of, spheres, walls

from scuro.scene.camera import Camera
from scuro.scene.lights import Lighting

SKY = Lighting((), ambient=1.0)
SAMPLES = 128


def _ray(scene, camera):
    image = draw(
        scene, camera, occlusion__technique="ray", occlusion__samples=SAMPLES,
        occlusion__filter="none",
    )  # fmt: skip
    return image, image.buffer("visibility")


def _path(scene, camera):
    image = draw(
        scene, camera, renderer="path", path__samples=SAMPLES, path__bounces=1,
        path__antialias=False,
    )  # fmt: skip
    return image, image.buffer("linear")[..., 0]


def _sphere_over(position, center, radius):
    """Visibility of floor points below a sphere that is wholly above them: 1 - cos (r/d)^2."""
    to_center = np.asarray(center) - position
    d = np.linalg.norm(to_center, axis=-1)
    return 1 - to_center[..., 2] / d * (radius / d) ** 2


def _square_opening(half, height):
    """Form factor of a centred square seen from below its middle (Siegel & Howell, B-4)."""
    a = half / height
    root = np.sqrt(1 + a * a)
    return 4 / np.pi * a / root * np.arctan(a / root)


def _near_middle(position, reach):
    across = np.hypot(position[..., 0], position[..., 1])
    return (np.abs(position[..., 2]) < 1e-3) & (across < reach)


@pytest.mark.parametrize("way", [_ray, _path], ids=["ray", "path"])
def test_sphere_over_a_plane(way):
    image, found = way(scene_of(floor(half=60), spheres((0, 0, 3, 1)), lighting=SKY), oblique())
    position = image.buffer("position")
    on_floor = np.abs(position[..., 2]) < 1e-3
    error = found[on_floor] - _sphere_over(position[on_floor], (0, 0, 3), 1)
    assert abs(error.mean()) < 0.003
    assert np.sqrt(np.mean(error**2)) < 0.04


@pytest.mark.parametrize("way", [_ray, _path], ids=["ray", "path"])
def test_two_spheres(way):
    # both wholly above the horizon of the pole of the lower one
    scene = scene_of(spheres((0, 0, 0, 2), (0, 0, 4, 1)), lighting=SKY)
    image, found = way(scene, Camera((9, 0, 4.5), (0, 0, 2), (0, 0, 1), fov=20))
    position = image.buffer("position")
    near_pole = (position[..., 2] > 1.99) & (position[..., 2] < 2.01)
    error = found[near_pole] - (1 - (1 / 2) ** 2)
    assert near_pole.sum() > 5 and abs(error.mean()) < 0.015
    facing_away = position[..., 2] > 4.5
    assert np.allclose(found[facing_away], 1, atol=1e-3), "the upper one's top is open"


@pytest.mark.parametrize("way", [_ray, _path], ids=["ray", "path"])
def test_sphere_in_a_pit(way):
    scene = scene_of(floor(half=2), walls(2, 3), spheres((0, 0, 2.5, 0.5)), lighting=SKY)
    image, found = way(scene, Camera((1.6, 0, 2.4), (0, 0, 0), (0, 0, 1), fov=40))
    middle = _near_middle(image.buffer("position"), 0.15)
    expected = _square_opening(2, 3) - (0.5 / 2.5) ** 2
    assert middle.sum() > 5
    assert found[middle].mean() == pytest.approx(expected, abs=0.015)
