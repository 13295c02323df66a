"""Spheres that cannot be met first from any side are left out of fits, and only those."""

import numpy as np
import pytest

from scuro.scene.camera import Camera
from scuro.scene.outermost import outermost


def _ball(rng):
    return rng.normal(size=(60_000, 3))


def _sheet(rng):
    return rng.random((60_000, 3)) * (300, 200, 1e-3)


def _line(rng):
    return np.arange(60_000)[:, None] * np.array([0.3, -0.2, 0.1])


@pytest.mark.parametrize("shape", [_ball, _sheet, _line])
@pytest.mark.parametrize("largest", [[0.0], [0.1, 0.2, 0.5]], ids=["points", "spheres"])
def test_support_in_every_direction_is_that_of_all(shape, largest):
    rng = np.random.default_rng(5)
    centers = shape(rng)
    spheres = np.column_stack([centers, rng.choice(largest, len(centers))])
    kept = outermost(spheres)
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    directions = np.concatenate([directions, np.eye(3), -np.eye(3)])
    for direction in directions:
        assert _reach(kept, direction) == pytest.approx(_reach(spheres, direction), abs=1e-9)


def _reach(spheres, direction):
    return (spheres[:, :3] @ direction + spheres[:, 3]).max()


def test_few_of_a_ball_are_left_and_cameras_are_the_same():
    rng = np.random.default_rng(6)
    centers = rng.normal(size=(400_000, 3))
    centers *= (100 * rng.random(400_000) ** (1 / 3) / np.linalg.norm(centers, axis=1))[:, None]
    spheres = np.column_stack([centers, rng.choice([1.2, 1.7, 1.8], 400_000)])
    kept = outermost(spheres)
    assert len(kept) < 0.05 * len(spheres)
    for direction in rng.normal(size=(50, 3)):
        direction /= np.linalg.norm(direction)
        assert _reach(kept, direction) == pytest.approx(_reach(spheres, direction), abs=1e-9)
    box = np.array([[-102.0] * 3, [102.0] * 3])
    for orthographic in (False, True):
        options = {"direction": (1, 2, 3), "aspect": 1.7, "orthographic": orthographic}
        expected = Camera.fitted(box, points=spheres, **options)
        found = Camera.fitted(box, points=kept, **options)
        assert np.allclose(found.position, expected.position, atol=1e-9)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_large_sphere_below_small_ones_is_not_forgotten(axis, side):
    spheres = np.zeros((60_000, 4))
    spheres[:, :3] = np.random.default_rng(7).random((60_000, 3)) * 100
    large = np.array([50.0, 50.0, 50.0, 20.0])
    large[axis] += 35 * side
    kept = outermost(np.concatenate([spheres, large[None]]))
    assert (kept == large).all(axis=1).any()


def test_few_points_and_spheres_of_any_size_are_left_alone():
    spheres = np.zeros((7, 4))
    assert outermost(spheres) is spheres
    spheres = np.random.default_rng(8).random((60_000, 4))
    assert outermost(spheres) is spheres
