"""Instances as the GPU unpacks them: where they stand, how they are turned, what they are."""

from __future__ import annotations

import numpy as np
import pytest
from harness import evaluate, gpu

from scuro.errors import GpuError
from scuro.load import load
from scuro.load.mesoscale_structures import structure_of_molecule
from scuro.render import Renderer
from scuro.scene.clip import Clip
from scuro.scene.generate import GenerateSettings, generate
from scuro.scene.geometry import Body, Frames, Geometry, quaternions, rotation_matrices
from scuro.scene.scene import Scene
from scuro.trace import build_accelerator
from scuro.trace.instances import MOST_OBJECTS, encoding_for
from scuro.trace.support import EDGE, support_table
from scuro.trace.table import table_bytes

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
    rows = np.arange(sum(len(b.positions) for b in bodies) + accelerator.frame_run[1])
    framed = np.repeat([b.frames is not None for b in bodies], [len(b.positions) for b in bodies])
    framed = np.append(framed, np.zeros(len(rows) - len(framed), bool))
    table = np.stack([rows, np.where(framed, 0, 0xFFFFFFFF)], axis=1)
    shared = {"a": np.uint32(table), "resources": resources, "constants": constants}
    index = "bitcast<u32>(a.x)"
    instance = f"instance_in({index}, bitcast<u32>(a.y))"
    placed = evaluate(
        "scene.wgsl", instance, result="vec4f(value.center, f32(value.object))",
        **shared,
    )  # fmt: skip
    radius = evaluate("scene.wgsl", f"reach_of(place_at({index}, NO_FRAME))", **shared)[:, 0]
    x, y, z = point
    turned = evaluate(
        "scene.wgsl",
        f"rotate({instance}.rotation, vec3f({x:f}, {y:f}, {z:f}))",
        result="vec4f(value, 0.0)",
        **shared,
    )[:, :3]
    return placed[:, 3].astype(int), placed[:, :3], radius, turned


def _bodies_of_all_sizes(rng, spread):
    # odd numbers, and more than a row of the table
    counts = (8_193, 0, 1, 30, 5)
    bodies = [
        Body(_ball(radius), _random(n, rng), rng.uniform(-spread, spread, (n, 3)))
        for n, radius in zip(counts, RADII, strict=True)
    ]
    frames = Frames(_random(7, rng), rng.uniform(-spread, spread, (7, 3)))
    bodies[3] = Body(
        bodies[3].geometry, bodies[3].rotations, bodies[3].positions * 0.01, frames=frames
    )
    return bodies, frames


RADII = (1.7, 1, VIRUS, 0.013, 64.2)


@pytest.mark.parametrize(
    ("packed_from", "spread", "place", "turn", "radius"),
    [(1 << 16, 20_000, 0.002, 2e-6, 1.005), (0, 1_000, 0.001, 38e-6, 1.005),
     (0, 10_000, 0.0105, 38e-6, 1.005)],
    ids=["few", "a packed virus", "a packed cell"],
)  # fmt: skip
def test_places_are_kept_within_stated_bounds(
    packed_from, spread, place, turn, radius, monkeypatch
):
    monkeypatch.setattr("scuro.trace.instances.PACKED_FROM", packed_from)
    bodies, frames = _bodies_of_all_sizes(np.random.default_rng(2), spread)
    point = VIRUS * np.array([0.48, -0.64, 0.6])
    number, center, bound, turned = _unpacked(bodies, point)
    rotations = np.concatenate([b.rotations for b in bodies] + [frames.rotations])
    wanted = rotation_matrices(rotations) @ point
    assert np.linalg.norm(turned - wanted, axis=1).max() < turn * VIRUS
    objects = np.repeat(np.arange(6), (*(len(b.positions) for b in bodies), len(frames)))
    assert np.array_equal(number, objects)
    inside, alone = number == 3, np.isin(number, (0, 2, 4))
    positions = np.concatenate([b.positions for b in bodies] + [frames.positions])
    assert np.abs(center - positions)[alone].max() < place
    middle = (bodies[3].own_bounds[0] + bodies[3].own_bounds[1]) / 2
    # a hundredth of the scene's size: an assembly has a finer step of its own
    assert np.abs(center + middle - positions)[inside].max() < 0.02 * place
    radii = np.take(RADII, number[alone])
    assert np.all(bound[alone] >= radii) and np.all(bound[alone] <= radius * radii)


@pytest.mark.parametrize(("packed_from", "off"), [(1 << 16, 1e-5), (0, 1e-4)])
def test_turns_of_a_cube_are_exact_to_rounding(packed_from, off, monkeypatch):
    monkeypatch.setattr("scuro.trace.instances.PACKED_FROM", packed_from)
    turns = _quarter_turns()
    assert len(turns) == 48
    bodies = [Body(_ball(1), turns, np.zeros((48, 3)))]
    *_, turned = _unpacked(bodies, (1, 2, 4))
    np.testing.assert_allclose(turned, rotation_matrices(turns) @ [1, 2, 4], atol=off)
    still = np.abs(turns[:, 3]) == 1
    assert np.array_equal(turned[still], np.tile(np.float32([1, 2, 4]), (still.sum(), 1)))


def test_many_instances_cost_a_copy_of_each_ingredient_and_36_bytes_each():
    structure = structure_of_molecule(load("sample:1tii"))
    model = generate([structure], GenerateSettings(atoms=5e8))
    accelerator = Renderer(gpu=gpu()).accelerator(Scene().add(model))
    ingredients = [accelerator.resources[name] for name in ("slots", "attributes", "walked")]
    each = accelerator.bytes - sum(table_bytes(t) for t in ingredients)
    each -= table_bytes(accelerator.resources["walked"]) // 4  # what their entries refer to
    assert accelerator.instances > 90_000
    assert each <= 36 * accelerator.instances


def test_supports_bound_what_objects_reach():
    rng = np.random.default_rng(5)
    solids = np.float32(rng.normal(size=(40, 4)) * (5, 2, 0.3, 0) + (0, 0, 0, 0.5))
    far = float((np.linalg.norm(solids[:, :3], axis=1) + solids[:, 3]).max())
    table = support_table([solids], far)
    directions = rng.normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    square = evaluate("octahedral.wgsl", "octahedral_square(a.xyz)", result="vec4f(value, 0, 0)",
                      a=np.float32(directions))[:, :2]  # fmt: skip
    x, y = np.minimum(((0.5 * square + 0.5) * EDGE).astype(int), EDGE - 1).T
    true = (directions @ solids[:, :3].T + solids[:, 3]).max(axis=1)
    assert np.all(table[y, x] >= np.minimum(true, far) - 1e-5)
    assert (table[y, x] - true).mean() < 0.2 * true.mean()


def test_more_bodies_than_can_be_numbered_are_refused():
    with pytest.raises(GpuError, match="more than 1,048,576 bodies"):
        encoding_for(MOST_OBJECTS + 1, 1, [1.0], (1.0, 1.0))
    many = encoding_for(4_000, 1 << 20, [1.0], (1.0, 1.0))
    assert not many.packed, "there would be no room for radii"
