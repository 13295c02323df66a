"""The acceleration structure: uniform grids over primitives, under one over instances.

All grids of a scene are built together on the GPU (a counting sort in three kernels, see
``build.wgsl``); only the prefix sum between them is numpy's. A geometry that several bodies share
is kept once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.scene.camera import Camera
from scuro.scene.clip import MAX_PLANES, Clip
from scuro.scene.geometry import Body, turned
from scuro.trace.grids import (
    GRID,
    GridPlan,
    Growth,
    build_grids,
    joined,
    plan_grids,
    weighted_median,
)
from scuro.trace.pack import PackedGeometry, pack_geometry
from scuro.trace.table import float_table, table, table_bytes

INSTANCE = np.dtype([("rotation", np.float32, 4), ("center", np.float32, 3), ("object", np.uint32)])
"""``Instance`` of wgsl/scene.wgsl: 32 bytes."""

OBJECT = np.dtype(
    [
        ("grid", GRID),
        ("radius", np.float32),
        ("flags", np.uint32),
        ("coarser", np.uint32),
        ("detail", np.float32),
        ("diffuse", np.float32),
        ("specular", np.float32),
        ("shininess", np.float32),
        ("opacity", np.float32),
        ("roughness", np.float32),
        ("ior", np.float32),
        ("kind", np.uint32),
        ("pad2", np.uint32),
    ]
)
"""``Traced`` and ``Material`` of wgsl/scene.wgsl: OBJECT_TEXELS texels."""

MATERIAL_KINDS = ("diffuse", "glossy", "metal", "mirror", "glass")
UNCLIPPED, OPEN = 1, 2
"""As in wgsl/scene.wgsl."""
OPACITY_SHIFT = 24
"""The flags' highest byte is the opacity (wgsl/opacity.wgsl)."""


@dataclass(eq=False)
class Accelerator:
    """A scene on the GPU, ready to be traced: resources and constants of ``wgsl/scene.wgsl``."""

    resources: dict[str, Any]
    constants: dict[str, float]
    bytes: int
    """GPU memory held."""
    instances: int
    primitives: int
    """Primitives stored (each geometry once)."""
    spheres: int
    """Spheres drawn, instances counted."""
    center: NDArray[np.float64]
    extent: float
    """Radius of the scene: half the diagonal of its box."""
    primitive_radius: float
    """Median radius of spheres and rods: the scale of occlusion distances and penumbras."""
    bodies: tuple[Body, ...]
    packed: dict[int, PackedGeometry]
    """By ``id(geometry)``."""
    first_slots: dict[int, int]
    """By ``id(geometry)``: its first slot in ``slots``."""
    cluster_runs: tuple[tuple[int, int, int, int], ...]
    """For each body: first instance, instances, first cluster, clusters."""
    scene: dict[str, Any]
    """Field values of the ``scene`` uniform, but for the clipping planes."""
    _grown: tuple[Growth, dict[str, Any]] | None = None

    @property
    def cluster_instances(self) -> int:
        """Clusters drawn, instances counted."""
        return sum(copies * clusters for _, copies, _, clusters in self.cluster_runs)

    def detail_for(self, camera: Camera, height: int, pixels: float) -> dict[str, Any]:
        """Fields of the ``scene`` uniform that choose levels of detail.

        Args:
            camera: Where distances are measured from.
            height: Of the picture, in pixels.
            pixels: Largest diameter of a merged sphere on the picture; 0 for single atoms always.
        """
        radius = pixels * camera.half_height() / height
        slope, floor = (0.0, radius) if camera.orthographic else (radius, 0.0)
        eye = np.asarray(camera.position) - self.center
        return {"eye": eye, "detail_slope": slope, "detail_floor": floor}

    def clipped(self, clip: Clip) -> tuple[dict[str, Any], dict[str, float]]:
        """Resources and constants with a clip's planes in place: nothing is rebuilt."""
        planes = clip.equations()
        planes[:, 3] += planes[:, :3] @ self.center
        spared = any(not body.clipped for body in self.bodies)
        uniform = self.scene | {
            "planes": planes if len(planes) else np.zeros((MAX_PLANES, 4)),
            "plane_count": len(planes),
            "spared": int(spared),
        }
        return self.resources | {"scene": uniform}, self.constants | {"CLIPPED": bool(len(planes))}

    def grown(self, gpu: Gpu, growth: Growth) -> dict[str, Any]:
        """Resources with grids that list all solids as if they were larger.

        For queries of what a ray passes closely. Built when first asked for, kept until another
        growth is; ``scene`` holds only the field that differs.
        """
        if self._grown is None or self._grown[0] != growth:
            self._grown = None  # frees the old ones first
            plan = plan_grids(self.bodies, self.packed, self.center, growth)
            instances, spheres = _instances(self.bodies, self.center, self.packed)
            spheres[:, 3] += np.repeat(
                [plan.reach[id(b.geometry)] for b in self.bodies],
                [len(b.positions) for b in self.bodies],
            )
            objects = _objects(self.bodies, self.packed, plan)
            alone = _alone(self.bodies)
            top = objects[int(instances[0]["object"])]["grid"] if alone else plan.grids[0]
            resources = build_grids(gpu, plan, self.resources["slots"], spheres)
            resources["objects"] = table(gpu, objects.view(np.uint32).reshape(-1, 4), "objects")
            resources["scene"] = {"top": {name: top[name] for name in GRID.names or ()}}
            self._grown = (growth, resources)
        return self._grown[1]


def build_accelerator(
    gpu: Gpu, bodies: Sequence[Body], center: NDArray, *, bounds: NDArray | None = None
) -> Accelerator:
    """Upload bodies and build their grids.

    Args:
        gpu: Where to.
        bodies: What is to be traced; empty ones are allowed.
        center: World position that becomes the origin of scene space.
        bounds: (2, 3) world box of the whole scene, other data included; the bodies' by default.
    """
    packed = _packed_with_levels(bodies)
    instances, spheres = _instances(bodies, center, packed)
    slots = joined([p.slots for p in packed.values()], (0, 4), np.float32)
    attributes = joined([p.attributes for p in packed.values()], (0, 4), np.uint32)
    slot_table = float_table(gpu, slots, "primitives")
    plan = plan_grids(bodies, packed, center)
    objects = _objects(bodies, packed, plan)
    # a single instance needs no grid above it
    top = objects[int(instances[0]["object"])]["grid"] if _alone(bodies) else plan.grids[0]
    resources = {
        "slots": slot_table,
        "attributes": table(gpu, attributes, "attributes"),
        "instances": table(gpu, instances.view(np.uint32).reshape(-1, 4), "instances"),
        "objects": table(gpu, objects.view(np.uint32).reshape(-1, 4), "objects"),
        **build_grids(gpu, plan, slot_table, spheres),
    }
    clusters, runs = _clusters(bodies, packed)
    resources["clusters"] = gpu.buffer(clusters, label="clusters")
    if bounds is None:
        boxes = [b.bounds for b in bodies if len(b.positions) and len(b.geometry)]
        bounds = (
            np.stack([np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)])
            if boxes
            else np.zeros((2, 3))
        )
    extent = float(np.linalg.norm(bounds[1] - bounds[0]) / 2)
    # triangles have no radius: a cartoon takes its scale from the sticks and spheres beside it
    sized = [b for b in bodies if packed[id(b.geometry)].median_radius > 0]
    primitive_radius = (
        weighted_median(
            [packed[id(b.geometry)].median_radius for b in sized],
            [len(packed[id(b.geometry)].primitives) * len(b.positions) for b in sized],
        )
        if sized
        else extent / 100
    )
    return Accelerator(
        resources=resources,
        constants={
            "HAS_RODS": any(p.has_rods for p in packed.values()),
            "HAS_TRIANGLES": any(p.has_triangles for p in packed.values()),
            "HAS_TOP_LEVEL": not _alone(bodies),
            "HAS_OPACITY": any(b.material.opacity < 1 for b in bodies),
            "HAS_LEVELS": any(b.geometry.levels for b in bodies),
        },
        bytes=sum(table_bytes(t) for n, t in resources.items() if n != "clusters"),
        instances=sum(len(b.positions) for b in bodies),
        primitives=sum(len(p.primitives) for p in packed.values()),
        spheres=sum(len(b.geometry.spheres) * len(b.positions) for b in bodies),
        center=np.asarray(center, np.float64),
        extent=extent,
        primitive_radius=primitive_radius,
        bodies=tuple(bodies),
        packed=packed,
        first_slots=plan.first_slots,
        cluster_runs=runs,
        scene={
            "top": {name: top[name] for name in GRID.names or ()},
            "rotation": instances[0]["rotation"] if len(instances) else (0, 0, 0, 1),
            "center": instances[0]["center"] if len(instances) else (0, 0, 0),
            "instance_count": sum(len(b.positions) for b in bodies),
            "extent": extent,
            "primitive_radius": primitive_radius,
            "eye": (0.0, 0.0, 0.0),
            "detail_slope": 0.0,
            "detail_floor": 0.0,
        },
    )


def _alone(bodies: Sequence[Body]) -> bool:
    """Whether all is one opaque instance, which needs no grid above it."""
    return sum(len(b.positions) for b in bodies) == 1 and all(
        b.material.opacity == 1 for b in bodies
    )


def _packed_with_levels(bodies: Sequence[Body]) -> dict[int, PackedGeometry]:
    """All geometries and their levels, by ``id``; a geometry's radius holds its levels too."""
    packed: dict[int, PackedGeometry] = {}
    for geometry in {id(b.geometry): b.geometry for b in bodies}.values():
        full = pack_geometry(geometry)
        levels = {id(level): pack_geometry(level, full.middle) for level in geometry.levels}
        radius = max([full.radius, *(p.radius for p in levels.values())])
        packed[id(geometry)] = replace(full, radius=radius)
        packed |= levels
    return packed


def _with_levels(
    objects: NDArray, bodies: Sequence[Body], packed: dict[int, PackedGeometry], grids: dict
) -> NDArray:
    """The object table with a row for each coarser level, and links from each to the next."""
    first: dict[int, int] = {}
    rows = []
    for index, body in enumerate(bodies):
        levels = body.geometry.levels
        if not levels:
            continue
        key = id(body.geometry)
        if key not in first:
            first[key] = len(objects) + len(rows)
            for level in levels:
                row = np.zeros(1, OBJECT)
                row["grid"] = grids[id(level)]
                row["detail"] = packed[id(level)].median_radius
                row["coarser"] = len(objects) + len(rows) + 1
                rows.append(row)
            rows[-1]["coarser"] = 0
        objects[index]["coarser"] = first[key]
    return np.concatenate([objects, *rows]) if rows else objects


def _instances(
    bodies: Sequence[Body], center: NDArray, packed: dict[int, PackedGeometry]
) -> tuple[NDArray, NDArray[np.float32]]:
    """The instance table, and bounding spheres (k, 4) in scene space, in body order."""
    count = sum(len(body.positions) for body in bodies)
    tables, spheres = np.zeros(count, INSTANCE), np.empty((count, 4), np.float32)
    first = 0
    for index, body in enumerate(bodies):
        p = packed[id(body.geometry)]
        rows = slice(first, first + len(body.positions))
        first = rows.stop
        table = tables[rows]
        table["rotation"] = body.rotations
        table["center"] = body.positions + turned(body.rotations, p.middle) - center
        table["object"] = index
        spheres[rows, :3] = table["center"]
        spheres[rows, 3] = p.radius if len(p.primitives) else 0
    return tables, spheres


def _clusters(
    bodies: Sequence[Body], packed: dict[int, PackedGeometry]
) -> tuple[NDArray[np.float32], tuple[tuple[int, int, int, int], ...]]:
    """Bounding spheres of all geometries' clusters, and where each body finds its own."""
    firsts: dict[int, int] = {}
    tables, total = [np.zeros((1, 4), np.float32)], 1
    runs, instance = [], 0
    for body in bodies:
        key = id(body.geometry)
        clusters = packed[key].clusters
        if key not in firsts:
            firsts[key] = total
            tables.append(clusters)
            total += len(clusters)
        if len(clusters) and len(body.positions):
            runs.append((instance, len(body.positions), firsts[key], len(clusters)))
        instance += len(body.positions)
    return np.concatenate(tables), tuple(runs)


def _objects(bodies: Sequence[Body], packed: dict[int, PackedGeometry], plan: GridPlan) -> NDArray:
    """The object table, one row at least."""
    objects = np.zeros(max(1, len(bodies)), OBJECT)
    for index, body in enumerate(bodies):
        key = id(body.geometry)
        objects[index] = _object(body, packed[key], plan.grids[plan.grid_of[key]])
        objects[index]["radius"] += plan.reach[key]
    grids = {key: plan.grids[number] for key, number in plan.grid_of.items()}
    return _with_levels(objects, bodies, packed, grids)


def _object(body: Body, p: PackedGeometry, grid: Any) -> tuple:
    m = body.material
    return (
        grid,
        p.radius,
        (0 if body.clipped else UNCLIPPED)
        | (0 if body.closed else OPEN)
        | (round(255 * m.opacity) << OPACITY_SHIFT),
        0,
        p.median_radius,
        m.diffuse,
        m.specular,
        m.shininess,
        m.opacity,
        m.roughness,
        m.ior,
        MATERIAL_KINDS.index(m.kind),
        0,
    )
