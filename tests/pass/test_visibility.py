"""The G-buffer against closed forms in double precision, and its two ways against each other."""

from functools import cache

import closed_form
import numpy as np
import pytest

from scuro.export.buffers import read_buffers
from scuro.gpu import Gpu
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene

SIZE = (96, 72)
AWAY = np.array([480.0, -260.0, 150.0])
"""Far from the world's origin, as structures are."""


def _away(x: float, y: float, z: float) -> tuple[float, float, float]:
    return AWAY[0] + x, AWAY[1] + y, AWAY[2] + z


@cache
def renderer(default_limits: bool = False) -> Renderer:
    return Renderer(gpu=Gpu(default_limits=default_limits))


def random_geometry(seed: int, count: int = 10, *, only_spheres: bool = False) -> Geometry:
    """Spheres, rods, cones and triangles in a ball of radius 4."""
    rng = np.random.default_rng(seed)

    def points(n, *shape, spread=2.2):
        return np.float32(rng.normal(size=(n, *shape, 3)) * spread)

    def paint(*shape):
        return rng.integers(0, 255, (*shape, 4)).astype(np.uint8)

    radii = np.float32(rng.uniform(0.3, 1.1, (count, 1)))
    balls = {
        "spheres": np.hstack([points(count), radii]),
        "sphere_colors": paint(count),
        "sphere_ids": np.arange(count, dtype=np.int32),
    }
    if only_spheres:
        return Geometry(**balls)
    a = points(count)
    b = np.float32(a + rng.normal(size=(count, 3)) * 1.3)
    ra = np.float32(rng.uniform(0.15, 0.5, (count, 1)))
    rb = ra.copy()
    rb[count // 2 :] *= 0.6  # cones
    middle = points(count)
    triangles = np.float32(middle[:, None] + rng.normal(size=(count, 3, 3)))
    flat = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    return Geometry(
        **balls,
        rods=np.stack([np.hstack([a, ra]), np.hstack([b, rb])], 1),
        rod_colors=paint(count, 2),
        rod_ids=np.arange(100, 100 + 2 * count, dtype=np.int32).reshape(-1, 2),
        triangles=triangles,
        triangle_normals=np.float32(np.repeat(flat[:, None], 3, 1)),
        triangle_colors=paint(count, 3),
        triangle_ids=np.arange(200, 200 + 3 * count, dtype=np.int32).reshape(-1, 3),
    )


def placed(geometry: Geometry, copies: int, seed: int, spread=5.0, **options) -> Body:
    rng = np.random.default_rng(seed)
    turns = rng.normal(size=(copies, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return Body(
        geometry, np.float32(turns), AWAY + rng.normal(size=(copies, 3)) * spread, **options
    )


PLANES = Clip(
    (
        Plane(_away(0, 0, 1.0), (0.3, 0.1, -1)),
        Plane(_away(-2, 0, 0), (1, 0.1, 0)),
    )
)


def scenes() -> dict[str, tuple[list[Body], Clip]]:
    one, two, balls = random_geometry(1), random_geometry(2), random_geometry(3, only_spheres=True)
    return {
        "one body": ([placed(one, 1, 4, 0.5)], Clip()),
        "instances": ([placed(one, 4, 5), placed(two, 2, 6), placed(one, 2, 7)], Clip()),
        "clipped": ([placed(one, 3, 8, 3.0), placed(balls, 3, 9, 3.0)], PLANES),
        "spared": ([placed(one, 3, 8, 3.0), placed(balls, 2, 9, 3.0, clipped=False)], PLANES),
        "one clipped": ([placed(two, 1, 10, 0.5)], PLANES),
        "one spared": ([placed(two, 1, 10, 0.5, clipped=False)], PLANES),
    }


CAMERAS = {
    "perspective": Camera(_away(6, 5, 26), tuple(AWAY), fov=35.0),
    "inside": Camera(_away(0.3, 0.2, 0.1), _away(3, 1, -4), fov=90.0),
    "orthographic": Camera(_away(6, 5, 26), tuple(AWAY), height=17.0),
}


def draw(name: str, camera: str, way: str, *, default_limits: bool = False):
    bodies, clip = scenes()[name]
    scene = Scene()
    scene.extra_bodies += bodies
    scene.clip = clip
    settings = Settings(size=SIZE, visibility=way)
    image = renderer(default_limits).render(scene, CAMERAS[camera], settings)
    return read_buffers(image._frame)


def check_truth(name: str, camera: str, found: dict[str, np.ndarray]) -> None:
    bodies, clip = scenes()[name]
    o, d = closed_form.rays(found["view_from_world"], found["clip_from_view"], SIZE)
    truth = closed_form.trace(bodies, clip, o, d)
    shape = SIZE[::-1]
    depth = truth.t * -(d @ found["view_from_world"][2, :3])
    wanted = {
        "atom": truth.element, "instance": truth.instance, "object": truth.object,
    }  # fmt: skip
    same = np.ones(shape, bool)
    for key, values in wanted.items():
        same &= found[key] == values.reshape(shape)
    assert same.mean() > 0.995, f"{(~same).sum()} pixels differ"
    assert _explained(same, depth.reshape(shape), found["depth"])
    hit = same & (found["object"] >= 0)
    assert hit.mean() > 0.03
    error = np.abs(found["depth"][hit] - depth.reshape(shape)[hit])
    # where a ray grazes, an error across it becomes a larger one along it
    facing = np.abs(np.sum(truth.normal * d, axis=1)).reshape(shape)[hit]
    assert np.all(error < 2e-5 * (1 + 1 / np.maximum(facing, 1e-3)))
    agreement = np.sum(found["normal"] * truth.normal.reshape(*shape, 3), axis=2)[hit]
    assert agreement.min() > 0.999 and np.quantile(agreement, 0.02) > 0.99999
    position = (o + np.where(np.isfinite(truth.t), truth.t, 0)[:, None] * d).reshape(*shape, 3)
    off = np.linalg.norm(found["position"] - position, axis=2)[hit]
    assert np.quantile(off, 0.99) < 2e-4
    if len(clip.planes):
        kept = [position[hit] @ p[:3] + p[3] for p in clip.equations()]
        clipped = np.array([b.clipped for b in bodies])[found["object"][hit]]
        assert np.min(kept, axis=0)[clipped].min(initial=0) > -1e-4


def _explained(same, depth, other) -> bool:
    """Whether pixels that differ are ties or lie on an edge of the picture's shapes."""
    with np.errstate(invalid="ignore"):
        tie = np.abs(depth - other) < 1e-3
    padded = np.pad(depth, 1, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3))
    with np.errstate(invalid="ignore"):
        edge = windows.max(axis=(2, 3)) - windows.min(axis=(2, 3)) > 0.02
    return bool(np.all(same | tie | edge | ~np.isfinite(windows).all(axis=(2, 3))))


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("name", list(scenes()))
def test_both_ways_see_what_the_closed_forms_see(name, camera):
    cast, drawn = draw(name, camera, "raycast"), draw(name, camera, "raster")
    check_truth(name, camera, cast)
    check_truth(name, camera, drawn)
    same = np.ones(SIZE[::-1], bool)
    for key in ("atom", "instance", "object"):
        same &= cast[key] == drawn[key]
    assert (~same).mean() < 0.002, f"{(~same).sum()} pixels differ"
    for key in ("depth", "normal", "color"):
        assert np.array_equal(cast[key][same], drawn[key][same])


def test_two_planes_cut_a_corner_from_two_overlapping_atoms_the_same_way():
    """Beyond the corner nothing is kept; on it the atom in which the point lies deeper shows."""
    balls = np.float32([[0, 0, 0, 5], [3, 1, 0, 5]])
    ids = np.arange(2, dtype=np.int32)
    corner = (Plane((0, 0, 1), (0, 0.1, -1)), Plane((1, 0, 0), (-1, 0, 0.4)))
    found = []
    for way in ("raycast", "raster"):
        scene = Scene()
        scene.extra_bodies.append(Body(Geometry(balls, np.full((2, 4), 200, np.uint8), ids)))
        scene.clip = Clip(corner)
        camera = Camera((-12, 5, 20), (0, 0, 0))
        image = renderer().render(scene, camera, Settings(size=SIZE, visibility=way))
        found.append(read_buffers(image._frame)["atom"])
    assert set(np.unique(found[0])) == {-1, 0, 1}
    assert (found[0] != found[1]).sum() <= 4, "but for ties"


def test_a_device_with_webgpus_default_limits_draws_the_same():
    for way in ("raycast", "raster"):
        ours = draw("clipped", "perspective", way)
        theirs = draw("clipped", "perspective", way, default_limits=True)
        for key in ("depth", "normal", "atom", "instance", "object", "color"):
            assert np.array_equal(ours[key], theirs[key]), key


def test_empty_pixels_say_so():
    found = draw("one body", "perspective", "raycast")
    empty = found["object"] < 0
    assert empty.any()
    for key in ("atom", "instance"):
        assert np.all(found[key][empty] == -1) and found[key].dtype == np.int32
    assert np.all(np.isinf(found["depth"][empty]))
    assert np.all(np.isnan(found["position"][empty]))
    assert np.all(found["normal"][empty] == 0)
