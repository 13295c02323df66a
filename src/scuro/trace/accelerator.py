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
from scuro.scene.geometry import Body, rotation_matrices
from scuro.trace.pack import PackedGeometry, pack_geometry
from scuro.trace.table import (
    empty_table,
    float_table,
    padded_bytes,
    table,
    table_bytes,
    table_from_buffer,
)

GRID = np.dtype(
    [("origin", np.float32, 3), ("cell", np.float32), ("dims", np.uint32, 3), ("cells", np.uint32)]
)
"""``Grid`` of wgsl/scene_types.wgsl."""

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
    first_slots: dict[int, int] = {}
    slots, attributes, items = [], [], []
    grids = np.zeros(1 + len(packed), GRID)
    grid_of: dict[int, int] = {}
    slot_count, cell_count = 0, 0
    grids[0], cell_count = _top_grid(bodies, center)
    for number, (key, p) in enumerate(packed.items(), start=1):
        first_slots[key], grid_of[key] = slot_count, number
        grids[number] = (p.origin, p.cell, p.dims, cell_count)
        slots.append(p.slots)
        attributes.append(p.attributes)
        item = np.empty((len(p.primitives), 2), np.uint32)
        item[:, 0] = p.primitives + np.uint32(slot_count)
        item[:, 1] = number
        items.append(item)
        slot_count += len(p.slots)
        cell_count += int(np.prod(p.dims, dtype=np.int64))

    instances, spheres = _instances(bodies, center, packed)
    items.insert(0, np.stack([np.arange(len(instances)), np.zeros(len(instances))], 1))
    slot_table = float_table(gpu, _joined(slots, (0, 4), np.float32), "primitives")
    cells, refs, entries = _build_grids(
        gpu, _joined(items, (0, 2), np.uint32), grids, slot_table, spheres, cell_count
    )
    objects = np.zeros(max(1, len(bodies)), OBJECT)
    for index, body in enumerate(bodies):
        objects[index] = _object(body, packed[id(body.geometry)], grids[grid_of[id(body.geometry)]])
    objects = _with_levels(objects, bodies, packed, {k: grids[n] for k, n in grid_of.items()})
    # a single instance needs no grid above it
    top = objects[int(instances[0]["object"])]["grid"] if len(instances) == 1 else grids[0]
    resources = {
        "slots": slot_table,
        "attributes": table(gpu, _joined(attributes, (0, 4), np.uint32), "attributes"),
        "cells": cells,
        "refs": refs,
        "entries": entries,
        "instances": table(gpu, instances.view(np.uint32).reshape(-1, 4), "instances"),
        "objects": table(gpu, objects.view(np.uint32).reshape(-1, 4), "objects"),
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
        _weighted_median(
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
            "HAS_TOP_LEVEL": len(instances) != 1,
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
        first_slots=first_slots,
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


def _joined(arrays: list[NDArray], shape: tuple[int, ...], dtype: Any) -> NDArray:
    return np.concatenate([*arrays, np.zeros(shape, dtype)]).astype(dtype, copy=False)


def _weighted_median(values: Sequence[float], weights: Sequence[int]) -> float:
    order = np.argsort(values)
    cumulative = np.cumsum(np.asarray(weights, float)[order])
    index = min(int(np.searchsorted(cumulative, cumulative[-1] / 2)), len(order) - 1)
    return float(np.asarray(values)[order][index])


def _instances(
    bodies: Sequence[Body], center: NDArray, packed: dict[int, PackedGeometry]
) -> tuple[NDArray, NDArray[np.float32]]:
    """The instance table, and bounding spheres (k, 4) in scene space, in body order."""
    tables, spheres = [np.zeros(0, INSTANCE)], [np.zeros((0, 4), np.float32)]
    for index, body in enumerate(bodies):
        p = packed[id(body.geometry)]
        table = np.zeros(len(body.positions), INSTANCE)
        table["rotation"] = body.rotations
        middle = rotation_matrices(body.rotations) @ p.middle.astype(np.float64)
        table["center"] = body.positions + middle - center
        table["object"] = index
        sphere = np.empty((len(table), 4), np.float32)
        sphere[:, :3] = table["center"]
        sphere[:, 3] = p.radius if len(p.primitives) else 0
        tables.append(table)
        spheres.append(sphere)
    return np.concatenate(tables), np.concatenate(spheres)


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


def _top_grid(bodies: Sequence[Body], center: NDArray) -> tuple[Any, int]:
    """The grid over instances: cells about as large as a typical instance."""
    boxes = [b.bounds for b in bodies if len(b.positions) and len(b.geometry)]
    count = sum(len(b.positions) for b in bodies)
    if not boxes:
        return (np.zeros(3), 1.0, np.ones(3), 0), 1
    radii = [b.radius for b in bodies if len(b.positions)]
    typical = _weighted_median(radii, [len(b.positions) for b in bodies if len(b.positions)])
    # bounding spheres may reach beyond the boxes, but nothing in them does
    low = np.min([b[0] for b in boxes], 0) - center - 1e-3 * typical
    high = np.max([b[1] for b in boxes], 0) - center + 1e-3 * typical
    size = high - low
    cell = max(
        2 * typical, float(np.cbrt(np.prod(size) / (4 * count + 8))), float(size.max()) / 512
    )
    dims = np.maximum(np.ceil(size / cell), 1)
    return (low, cell, dims, 0), int(np.prod(dims))


def _object(body: Body, p: PackedGeometry, grid: Any) -> tuple:
    m = body.material
    return (
        grid,
        p.radius,
        (0 if body.clipped else UNCLIPPED) | (0 if body.closed else OPEN),
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


def _build_grids(
    gpu: Gpu,
    items: NDArray[np.uint32],
    grids: NDArray,
    slots: Any,
    spheres: NDArray[np.float32],
    cell_count: int,
) -> tuple[Any, Any, Any]:
    """The ``cells``, ``refs`` and ``entries`` tables of all grids together."""
    counts = gpu.buffer(4 * cell_count, label="grid counts")
    cells = gpu.buffer(padded_bytes(cell_count), label="grid cells")
    placeholder = gpu.buffer(16)
    resources = {
        "items": gpu.buffer(items, label="primitives to sort"),
        "grids": gpu.buffer(grids, label="grids"),
        "slots": slots,
        "bounds": gpu.buffer(spheres, label="bounding spheres"),
        "counts": counts,
        "cells": cells,
        "refs": placeholder,
    }

    def run(entry: str, threads: int) -> None:
        limit = 65535 * 64
        for first in range(0, threads, limit):
            build = {"primitives": len(items), "cells": cell_count, "first": first}
            share = min(limit, threads - first)
            gpu.compute("trace/build.wgsl", entry, (share,), resources | {"build": build})

    run("count", len(items))
    lengths = gpu.read_buffer(counts, np.uint32)[:cell_count]
    ends = np.cumsum(lengths, dtype=np.int64)
    starts = np.zeros(cell_count, np.uint32)
    starts[1:] = ends[:-1]
    gpu.write_buffer(cells, starts)
    total = int(ends[-1])
    refs = gpu.buffer(padded_bytes(total), label="grid references")
    resources["refs"] = refs
    recorder = gpu.recorder()
    recorder.clear_buffer(counts)
    recorder.submit()
    run("fill", len(items))
    run("finish", cell_count)
    ref_table = table_from_buffer(gpu, refs, total)
    entries = empty_table(gpu, total, "rgba32float", "grid entries")
    for first in range(0, total, 65535 * 64):
        gpu.compute(
            "trace/copy.wgsl",
            "main",
            (min(65535 * 64, total - first),),
            {
                "copying": {"first": first, "count": total},
                "slots": slots,
                "ref_table": ref_table,
                "entry_table": entries,
            },
        )
    return table_from_buffer(gpu, cells, cell_count), ref_table, entries
