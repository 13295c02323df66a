"""The grids against brute force: every primitive is found, by trace_nearest and trace_any alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from harness import evaluate, gpu

from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, Plane
from scuro.scene.geometry import Body, Frames, Geometry, quaternions, rotation_matrices
from scuro.scene.scene import Scene
from scuro.trace import build_accelerator


def _balls(n, seed, spread, radius, anisotropy=(1, 1, 1)):
    rng = np.random.default_rng(seed)
    table = np.float32(
        np.hstack([rng.normal(size=(n, 3)) * spread * anisotropy, rng.uniform(*radius, (n, 1))])
    )
    return Geometry(table, np.zeros((n, 4), np.uint8), np.arange(n, dtype=np.int32))


def _poses(copies, seed, spread):
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(copies, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    return np.float32(q), rng.normal(size=(copies, 3)) * spread


def _turned(geometry, copies, seed, spread, frames=None):
    return Body(geometry, *_poses(copies, seed, spread), frames=frames)


def _assemblies():
    """Two kinds of assemblies, one of two bodies; a body of its own; an assembly without frames."""
    viruses, cells = Frames(*_poses(7, 20, 60)), Frames(*_poses(3, 21, 90))
    return [
        _turned(_balls(20, 22, 2, (0.5, 1)), 15, 23, 10, viruses),
        _turned(_balls(40, 24, 5, (0.5, 1)), 3, 25, 60),
        Body(_balls(30, 26, 4, (0.5, 1.5)), frames=viruses),
        _turned(_balls(50, 27, 3, (0.5, 1)), 10, 28, 15, cells),
        Body(_balls(5, 29, 1, (1, 2)), frames=Frames(np.zeros((0, 4)), np.zeros((0, 3)))),
    ]


SCENES = {
    "one": [Body(_balls(300, 1, 10, (0.5, 2)))],
    "a single sphere": [Body(_balls(1, 2, 1, (1, 1)))],
    "a line": [Body(_balls(200, 3, 10, (0.3, 0.6), (1, 0, 0)))],
    "a plane": [Body(_balls(200, 4, 10, (0.3, 0.6), (1, 1, 0)))],
    "one giant among dwarfs": [
        Body(_balls(200, 5, 10, (0.05, 0.1))), Body(_balls(1, 6, 1, (6, 6)))
    ],
    "instances": [_turned(_balls(50, 7, 3, (0.5, 1)), 40, 8, 30)],
    "splinters": [_turned(_balls(50, 33, 6, (0.2, 0.4), (1, 0.2, 0.03)), 40, 34, 30)],
    "assemblies": _assemblies(),
    "a single assembly": [
        _turned(_balls(20, 31, 2, (0.5, 1)), 30, 32, 12, Frames(*_poses(1, 33, 40)))
    ],
    "distant instances": [_turned(_balls(20, 9, 2, (0.5, 1)), 3, 10, 2000)],
}  # fmt: skip


def _copies(body):
    """Matrices and positions in the world: frame by frame, and in each instance by instance."""
    own = list(zip(rotation_matrices(body.rotations), body.positions, strict=True))
    if body.frames is None:
        return own
    outer = zip(rotation_matrices(body.frames.rotations), body.frames.positions, strict=True)
    return [(f @ m, f @ p + q) for f, q in outer for m, p in own]


def _world(bodies):
    """All spheres of all instances (n, 4)."""
    return np.concatenate(
        [
            np.hstack([body.geometry.spheres[:, :3] @ m.T + p, body.geometry.spheres[:, 3:]])
            for body in bodies
            for m, p in _copies(body)
        ]
    ).astype(np.float64)


def _numbers(bodies):
    """The number of the instance to which each sphere in the world belongs."""
    counts = [len(body.geometry) for body in bodies for _ in _copies(body)]
    return np.repeat(np.arange(len(counts)), counts)


def _rays(spheres, count, seed):
    """At spheres, along axes, and past everything."""
    rng = np.random.default_rng(seed)
    low, high = spheres[:, :3].min(axis=0), spheres[:, :3].max(axis=0)
    size = max(float((high - low).max()), float(spheres[:, 3].max()))
    aim = spheres[rng.integers(0, len(spheres), count)]
    d = rng.normal(size=(count, 3))
    d[: count // 4] = np.eye(3)[rng.integers(0, 3, count // 4)] * rng.choice(
        [-1, 1], (count // 4, 1)
    )
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    target = aim[:, :3] + rng.normal(size=(count, 3)) * aim[:, 3:] * 0.6
    target[-count // 8 :] += size
    return np.float32(target - d * size * rng.uniform(0, 2, (count, 1))), np.float32(d)


def _entries(o, d, spheres):
    """(rays, spheres) entry distances, infinite for misses; and how clear of grazing each is."""
    o, d = o.astype(np.float64), d.astype(np.float64)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    to = spheres[None, :, :3] - o[:, None]
    along = np.einsum("nkj,nj->nk", to, d)
    square = spheres[:, 3] ** 2 - np.sum((to - along[..., None] * d[:, None]) ** 2, axis=2)
    t = np.where(square >= 0, along - np.sqrt(np.maximum(square, 0)), np.inf)
    return t, np.abs(square) / spheres[:, 3] ** 2


def _traced(bodies, o, d, clip=None):
    accelerator = build_accelerator(gpu(), bodies, np.zeros(3))
    resources, constants = accelerator.clipped(clip or Clip())
    shared = {"a": o, "b": d, "resources": resources, "constants": constants}
    nearest = evaluate("trace.wgsl", "trace_nearest(Ray(a.xyz, b.xyz), a.w, NOTHING)",
                       result="vec4f(value.t, f32(leaf_number(value.instance, value.frame, "
                       "instance_at(value.instance).object)), f32(slot_of(value.primitive)), "
                       "f32(value.cap))", **shared)  # fmt: skip
    some = evaluate("trace.wgsl", "select(0.0, 1.0, trace_any(Ray(a.xyz, b.xyz), a.w, NOTHING))",
                    **shared)  # fmt: skip
    return nearest, some[:, 0] > 0


@pytest.fixture
def as_if_large(monkeypatch):
    """Tables as those of scenes of very many instances."""
    monkeypatch.setattr("scuro.trace.instances.PACKED_FROM", 0)
    monkeypatch.setattr("scuro.trace.support.FROM", 0)


@pytest.mark.parametrize("name", SCENES)
def test_every_sphere_is_found(name):
    _check_all_spheres(name)


@pytest.mark.parametrize("name", ["one giant among dwarfs", "instances", "splinters", "assemblies"])
def test_every_sphere_is_found_in_packed_tables(name, as_if_large):
    _check_all_spheres(name)


def _check_all_spheres(name):
    spheres = _world(SCENES[name])
    o, d = _rays(spheres, 4000, 3)
    t, margin = _entries(o, d, spheres)
    nearest, some = _traced(SCENES[name], o, d)
    ahead = np.where(t >= 0, t, np.inf)
    scale = np.linalg.norm(o, axis=1) + np.abs(spheres).max()
    # not those that graze, or start within rounding of a surface
    close = (np.abs(t) < 1e-5 * scale[:, None]) & np.isfinite(t)
    clear = (margin > 1e-3).all(axis=1) & ~close.any(axis=1)
    assert clear.mean() > 0.5
    wanted = ahead.min(axis=1)
    hit = np.isfinite(wanted)
    found = nearest[:, 0] < 1e38
    assert np.array_equal(found[clear], hit[clear])
    assert np.array_equal(some[clear], hit[clear]), "trace_any and trace_nearest must agree"
    both = clear & hit
    assert both.any()
    assert np.all(np.abs(nearest[:, 0] - wanted)[both] < 3e-5 * scale[both])


def _many_objects():
    """Some hundred objects, each in a place of its own, so that most cells list few of them."""
    places = np.random.default_rng(40).permutation(120)
    bodies = []
    for n, place in enumerate(places):
        rotations, positions = _poses(12, 300 + n, 4)
        positions = positions + 30.0 * np.array([place % 5, place // 5 % 5, place // 25])
        bodies.append(Body(_balls(12, 100 + n, 1.5, (0.5, 1)), rotations, positions))
    return bodies


@pytest.mark.parametrize("bits", [31, 20, 15])
@pytest.mark.parametrize("name", ["instances", "many objects", "assemblies"])
def test_rays_pass_ranges_of_objects_as_if_they_were_not_there(name, bits, monkeypatch):
    monkeypatch.setattr("scuro.trace.build._CELL_BITS", bits)
    bodies = _many_objects() if name == "many objects" else SCENES[name]
    first, end = {"instances": (0, 1), "many objects": (16, 96), "assemblies": (0, 3)}[name]
    spheres = _world(bodies)
    owner = np.repeat(
        np.arange(len(bodies)), [len(_world([b])) if b.instances else 0 for b in bodies]
    )
    o, d = _rays(spheres, 3000, 9)
    t, margin = _entries(o, d, spheres)
    kept = (owner < first) | (owner >= end)
    hit = ((t >= 0) & np.isfinite(t) & kept).any(axis=1)
    clear = (margin > 1e-3).all(axis=1) & ~((np.abs(t) < 1e-3) & np.isfinite(t)).any(axis=1)
    accelerator = build_accelerator(gpu(), bodies, np.zeros(3))
    resources, constants = accelerator.clipped(Clip())
    found = evaluate(
        "trace.wgsl", f"passing(Ray(a.xyz, b.xyz), vec4u({first}u, {end}u, 0u, 0u))",
        result="vec4f(select(0.0, 1.0, value))", a=o, b=d, resources=resources,
        constants=constants | {"HAS_SKIPS": True},
        functions="fn passing(ray: Ray, range: vec4u) -> bool "
        "{ skipped = range; return trace_any(ray, 0.0, NOTHING); }",
    )[:, 0] > 0  # fmt: skip
    assert clear.mean() > 0.3 and (name == "instances" or hit[clear].any())
    assert np.array_equal(found[clear], hit[clear])


def test_cells_over_instances_tell_the_objects_that_they_list():
    bodies = _many_objects()
    accelerator = build_accelerator(gpu(), bodies, np.zeros(3))
    scene = accelerator.scene
    refs = gpu().read_texture(accelerator.resources["refs"]).ravel()
    words = refs[: int(np.prod(scene["top"]["dims"]))]
    words = words[words < 0x80000000]
    bits = scene["span_bits"]
    assert bits == 7 and scene["span_shift"] == 0
    rows = np.repeat(np.arange(len(bodies)), [len(b.positions) for b in bodies])
    for word in words:
        index = int(word) & (0x7FFFFFFF >> (2 * bits))
        listed = []
        while not listed or refs[index - 1] < 0x80000000:
            listed.append(rows[refs[index] & 0x7FFFFFFF])
            index += 1
        span = word >> (31 - 2 * bits) & 127, word >> (31 - bits) & 127
        assert span == (min(listed), max(listed))


@pytest.mark.parametrize("name", ["instances", "assemblies"])
def test_a_hit_names_its_instance(name):
    bodies = SCENES[name]
    spheres = _world(bodies)
    o, d = _rays(spheres, 3000, 5)
    t, _ = _entries(o, d, spheres)
    t = np.where(t >= 0, t, np.inf)
    order = np.sort(t, axis=1)
    lone = order[:, 0] + 1e-2 < order[:, 1]
    nearest, _ = _traced(bodies, o, d)
    assert lone.sum() > 500
    same = nearest[lone, 1] == _numbers(bodies)[t.argmin(axis=1)][lone]
    assert same.mean() > 0.998


def test_any_and_nearest_agree_on_rays_that_planes_cut():
    clip = Clip((Plane((1, 0, 0), (1, 0.2, 0)), Plane((0, 0, 2), (0.1, 0, -1))))
    for spared in (False, True):
        bodies = [
            SCENES["one"][0],
            Body(_balls(100, 11, 8, (0.5, 1)), clipped=not spared),
        ]
        o, d = _rays(_world(bodies), 4000, 7)
        nearest, some = _traced(bodies, o, d, clip)
        assert ((nearest[:, 0] < 1e38) == some).mean() > 0.999
        assert (nearest[:, 3] > 0).sum() > 50, "some hits are caps"


def test_nothing_traces_to_nothing():
    o, d = np.zeros((4, 3), np.float32), np.float32([[1, 0, 0]] * 4)
    for bodies in ([], [Body(Geometry())], [Body(SCENES["one"][0].geometry, np.zeros((0, 4)),
                                                 np.zeros((0, 3)))]):  # fmt: skip
        nearest, some = _traced(bodies, o, d)
        assert np.all(nearest[:, 0] > 1e38) and not some.any()


def test_the_picture_of_assemblies_is_that_of_all_their_instances():
    """Atoms, instances and objects, depths, occlusion and soft shadows."""
    bodies = _assemblies()
    flat = [
        Body(
            body.geometry,
            quaternions(np.reshape([m for m, _ in _copies(body)], (-1, 3, 3))),
            np.reshape([p for _, p in _copies(body)], (-1, 3)),
        )
        for body in bodies
    ]
    settings = Settings(size=(160, 120)).replace(
        occlusion__technique="ray", occlusion__samples=8, occlusion__filter="none",
        shadows__technique="soft",
    )  # fmt: skip
    found = []
    camera = None
    for shown in (bodies, flat):
        scene = Scene()
        scene.extra_bodies += shown
        renderer = Renderer(gpu=gpu())
        camera = camera or replace(renderer.fitted(scene, settings), fov=8)
        image = renderer.render(scene, camera, settings)
        names = ("instance", "object", "atom", "depth", "visibility")
        found.append({name: image.buffer(name) for name in names} | {"picture": image.pixels})
    a, b = found
    assert (a["object"] >= 0).sum() > 1000
    for name in ("instance", "object", "atom"):
        assert (a[name] == b[name]).mean() > 0.998, name
    same = (a["instance"] == b["instance"]) & (a["object"] >= 0)
    assert np.allclose(a["depth"][same], b["depth"][same], rtol=1e-4)
    assert abs(a["visibility"] - b["visibility"])[same].mean() < 0.01
    difference = abs(a["picture"].astype(int) - b["picture"]).max(axis=2)
    assert (difference > 8).mean() < 0.02


def test_wide_penumbras_of_instances_are_those_of_one_geometry():
    """Parker's outer spheres reach beyond the bounding spheres by which instances are listed."""
    body = _turned(_balls(1, 40, 0.1, (0.4, 0.4)), 500, 41, 3)
    spheres = np.float32(_world([body]))
    ids = np.arange(len(spheres), dtype=np.int32)
    whole = Body(Geometry(spheres, np.zeros((len(spheres), 4), np.uint8), ids))
    settings = Settings(size=(128, 96)).replace(
        shadows__technique="soft", shadows__ratio=4.0, occlusion__technique="none"
    )
    found = []
    camera = None
    for shown in (whole, body):
        scene = Scene()
        scene.extra_bodies.append(shown)
        renderer = Renderer(gpu=gpu())
        camera = camera or renderer.fitted(scene, settings)
        found.append(renderer.render(scene, camera, settings).buffer("shadow"))
    off = np.abs(found[0] - found[1])
    assert ((found[0] > 0.02) & (found[0] < 0.98)).sum() > 200
    assert off.max() < 0.01
