"""The lists of nearest spheres against a tree's."""

import numpy as np
from harness import gpu
from scipy.spatial import cKDTree

from scuro.passes.occlusion import neighbours
from scuro.scene.geometry import Body, Geometry
from scuro.steps import finished
from scuro.trace import build_accelerator
from scuro.trace.pack import NO_PRIMITIVE


def _geometry(spheres, rods, triangles, seed, spread):
    rng = np.random.default_rng(seed)
    return Geometry(
        spheres=np.float32(
            np.hstack([rng.normal(size=(spheres, 3)) * spread, np.ones((spheres, 1))])
        ),
        sphere_colors=np.zeros((spheres, 4), np.uint8),
        sphere_ids=np.arange(spheres, dtype=np.int32),
        rods=np.float32(rng.normal(size=(rods, 2, 4)) * 3 + [0, 0, 0, 20]),
        rod_colors=np.zeros((rods, 2, 4), np.uint8),
        rod_ids=np.zeros((rods, 2), np.int32),
        triangles=np.float32(rng.normal(size=(triangles, 3, 3)) * 3),
        triangle_normals=np.zeros((triangles, 3, 3), np.float32) + np.float32([0, 0, 1]),
        triangle_colors=np.zeros((triangles, 3, 4), np.uint8),
        triangle_ids=np.zeros((triangles, 3), np.int32),
    )


def test_lists_hold_the_nearest_spheres_of_their_own_geometry():
    geometries = [
        _geometry(700, 0, 0, 1, (9, 3, 1)),  # denser in the middle than outside
        _geometry(500, 60, 80, 2, (4, 4, 4)),
        _geometry(0, 30, 20, 3, (1, 1, 1)),
        _geometry(11, 5, 0, 4, (0, 0, 5)),  # a line
    ]
    bodies = [Body(g) for g in (*geometries, geometries[1])]
    accelerator = build_accelerator(gpu(), bodies, np.zeros(3))
    for count in (8, 24, 36):
        found = finished(neighbours._search(gpu(), accelerator, count // 4))
        texels = gpu().read_texture(found.table).ravel()
        table = texels[: len(texels) // count * count].reshape(-1, count)
        skipped = gpu().read_buffer(found.skipped, np.uint32)
        assert skipped[1] == skipped[4], "bodies of one geometry share its lists"
        rows = 0
        for number, geometry in enumerate(geometries):
            p = accelerator.packed[id(geometry)]
            first, spheres = accelerator.first_slots[id(geometry)], len(geometry.spheres)
            slots = np.arange(spheres + 2 * len(geometry.rods))
            rows += len(slots)
            listed = table[slots + first - skipped[number]].astype(np.int64)
            most = min(count, max(0, spheres - 1))
            points = p.slots[:, :3].astype(np.float64)
            own = np.where(slots < spheres, slots + first, -1)
            assert not (listed == own[:, None]).any()
            none = listed == NO_PRIMITIVE
            # a rod's end is no sphere, and so has one more to choose from
            wanted = np.where(slots < spheres, most, min(count, spheres))
            assert np.array_equal((~none).sum(axis=1), wanted)
            if not spheres:
                continue
            tree = cKDTree(points[:spheres])
            apart, index = tree.query(points[slots], k=min(count + 1, spheres))
            apart[index == slots[:, None]] = np.inf
            apart = np.sort(apart, axis=1)
            near = points[np.where(none, 0, listed - first)] - points[slots][:, None]
            distance = np.where(none, np.inf, np.linalg.norm(near, axis=2))
            shared = min(count, apart.shape[1])
            both = np.isfinite(apart[:, :shared]) & np.isfinite(distance[:, :shared])
            assert both.any()
            off = np.abs(apart[:, :shared][both] - distance[:, :shared][both])
            assert np.all(off <= 1e-4 * apart[:, :shared][both] + 1e-6)
        assert rows * count <= len(texels) < rows * count + 8192 * 4, "no list is a triangle's"
