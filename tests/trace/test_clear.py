"""Where rays may end early: cells and directions in which nothing lies ahead."""

import numpy as np

import scuro
from scuro.passes.occlusion import ray
from scuro.trace.clear import clear_directions


def _bins(d):
    axis = np.abs(d).argmax(axis=1)
    return 8 * axis + (d < 0) @ np.array([1, 2, 4])


def test_rays_in_clear_directions_meet_only_empty_cells():
    rng = np.random.default_rng(4)
    shape = np.array([9, 11, 13])  # z, y, x
    empty = np.ones(shape, bool)
    empty[4:6, 4:7, 5:8] = rng.random((2, 3, 3)) < 0.6
    empty[1, 2, 10] = False
    bits = clear_directions(empty)
    assert np.all(bits[~empty] == 0)
    n = 20_000
    origin = rng.random((n, 3)) * shape[::-1]
    d = rng.normal(size=(n, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    cell = tuple(origin.astype(int).T[::-1])
    clear = (bits[cell] >> _bins(d).astype(np.uint32)) & 1
    steps = np.arange(0, 25, 0.02)
    blocked = np.zeros(n, bool)
    for t in steps:
        p = np.floor(origin + t * d).astype(int)
        inside = np.all((p >= 0) & (p < shape[::-1]), axis=1)
        p = np.where(inside[:, None], p, 0)
        blocked |= inside & ~empty[tuple(p.T[::-1])]
    assert not np.any(blocked & (clear == 1))
    assert (clear == 1).sum() > 0.5 * (~blocked).sum(), "most free rays are known to be free"


def test_an_empty_grid_is_clear_all_around():
    assert np.all(clear_directions(np.ones((3, 4, 5), bool)) == (1 << 24) - 1)


def test_rays_tested_at_once_in_their_first_cell_see_what_single_rays_see(monkeypatch):
    scene = scuro.load("sample:1hpv").show("spacefill")
    options = {"occlusion__technique": "ray", "occlusion__samples": 21, "occlusion__filter": "none"}

    def visibility():
        return scuro.render(scene, size=(120, 90), **options).buffer("visibility")

    together = visibility()
    constants = ray.fan_constants
    monkeypatch.setattr(
        ray, "fan_constants", lambda *a: constants(*a) | {"FIRST_CELL_AT_ONCE": False}
    )
    apart = visibility()
    assert apart.min() < 0.5
    assert (together != apart).mean() < 1e-3
