"""Instances as the GPU unpacks them: where they stand, how they are turned, what they are."""

from __future__ import annotations

import numpy as np
import pytest
from harness import evaluate, gpu

from scuro.errors import GpuError
from scuro.scene.clip import Clip
from scuro.scene.geometry import Body, Frames, Geometry, quaternions, rotation_matrices
from scuro.trace import build_accelerator
from scuro.trace.instances import MOST_OBJECTS, place_words

VIRUS = 600.0
"""Ångström: as large as ingredients are."""


def _ball(radius):
    return Geometry(
        np.float32([[0, 0, 0, radius]]), np.zeros((1, 4), np.uint8), np.zeros(1, np.int32)
    )


def _quarter_turns():
    """The 24 turns of a cube, each as both of its quaternions."""
    axes = np.eye(3)[[[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]]]
    signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    matrices = (axes[:, None] * signs[None, :, :, None]).reshape(-1, 3, 3)
    turns = quaternions(matrices[np.linalg.det(matrices) > 0])
    return np.concatenate([turns, -turns])


def _random(count, rng):
    q = rng.normal(size=(count, 4))
    return np.float32(q / np.linalg.norm(q, axis=1, keepdims=True))


def _unpacked(bodies, point):
    """Of every row of the table: object, centre, bounding radius and a turned point."""
    accelerator = build_accelerator(gpu(), bodies, np.zeros(3))
    resources, constants = accelerator.clipped(Clip())
    rows = np.arange(accelerator.scene["instances"])
    shared = {"a": np.uint32(rows), "resources": resources, "constants": constants}
    index = "bitcast<u32>(a.x)"
    placed = evaluate(
        "scene.wgsl", f"instance_at({index})", result="vec4f(value.center, f32(value.object))",
        **shared,
    )  # fmt: skip
    radius = evaluate("scene.wgsl", f"bound_of({index}).w", **shared)[:, 0]
    x, y, z = point
    turned = evaluate(
        "scene.wgsl",
        f"rotate(instance_at({index}).rotation, vec3f({x:f}, {y:f}, {z:f}))",
        result="vec4f(value, 0.0)",
        **shared,
    )[:, :3]
    return placed[:, 3].astype(int), placed[:, :3], radius, turned


def test_places_are_kept_to_a_hundredth_of_an_angstrom_at_the_surface_of_a_virus():
    rng = np.random.default_rng(2)
    # odd numbers, and more than a row of the table: rotations of two bodies share texels
    counts = (8_193, 0, 1, 30, 5)
    bodies = [
        Body(_ball(radius), _random(n, rng), rng.uniform(-20_000, 20_000, (n, 3)))
        for n, radius in zip(counts, (1.7, 1, 600, 0.013, 64.2), strict=True)
    ]
    frames = Frames(_random(7, rng), rng.uniform(-20_000, 20_000, (7, 3)))
    bodies[3] = Body(
        bodies[3].geometry, bodies[3].rotations, bodies[3].positions * 0.01, frames=frames
    )
    point = VIRUS * np.array([0.48, -0.64, 0.6])
    number, center, radius, turned = _unpacked(bodies, point)
    rotations = np.concatenate([b.rotations for b in bodies] + [frames.rotations])
    wanted = rotation_matrices(rotations) @ point
    off = np.linalg.norm(turned - wanted, axis=1)
    assert off.max() < 0.005 and off.mean() < 0.001
    objects = np.repeat(np.arange(6), (*counts, len(frames)))
    assert np.array_equal(number, objects)
    alone = np.isin(number, (0, 2, 4))
    positions = np.concatenate([b.positions for b in bodies] + [frames.positions])
    assert np.abs(center - positions)[alone].max() < 0.002  # those of single precision
    radii = np.take([1.7, 1, 600, 0.013, 64.2], number[alone])
    assert np.all(radius[alone] >= radii) and np.all(radius[alone] <= 1.035 * radii)


def test_turns_of_a_cube_are_exact_to_rounding():
    turns = _quarter_turns()
    assert len(turns) == 48
    bodies = [Body(_ball(1), turns, np.zeros((48, 3)))]
    *_, turned = _unpacked(bodies, (1, 2, 4))
    np.testing.assert_allclose(turned, rotation_matrices(turns) @ [1, 2, 4], atol=1e-5)
    still = np.abs(turns[:, 3]) == 1
    assert np.array_equal(turned[still], np.tile(np.float32([1, 2, 4]), (still.sum(), 1)))


def test_more_bodies_than_can_be_numbered_are_refused():
    with pytest.raises(GpuError, match="more than 1,048,576 bodies"):
        place_words(np.zeros((1, 3)), MOST_OBJECTS, 1.0)
