"""The uniform grids of a scene: over each geometry's primitives, over instances and assemblies.

All are built together on the GPU (a counting sort in three kernels, see ``build.wgsl``); only the
prefix sum between them is numpy's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.scene.geometry import Body
from scuro.trace.clear import clear_directions
from scuro.trace.pack import PackedGeometry
from scuro.trace.placement import Placement
from scuro.trace.table import empty_table, padded_bytes, table_from_buffer

GRID = np.dtype(
    [("origin", np.float32, 3), ("cell", np.float32), ("dims", np.uint32, 3), ("cells", np.uint32)]
)
"""``Grid`` of wgsl/scene_types.wgsl."""


_CLEARED = 256
"""In so many grids at most rays are told where nothing lies ahead: each takes milliseconds."""


@dataclass(frozen=True)
class Growth:
    """Radii r count as ``factor`` r + ``margin`` when solids are sorted into cells."""

    factor: float = 1.0
    margin: float = 0.0

    def reach(self, geometry: PackedGeometry) -> float:
        """How far beyond its surfaces a geometry's solids are listed at most."""
        largest = float(geometry.slots[:, 3].max(initial=0.0))
        return (self.factor - 1) * largest + self.margin


@dataclass(frozen=True, eq=False)
class GridPlan:
    """Where all grids of a scene lie and what is sorted into them."""

    grids: NDArray
    """GRID records: over instances (the scene's, the assemblies'), then one a geometry."""
    over: int
    """How many of them are over instances."""
    grid_of: dict[int, int]
    """By ``id(geometry)``: its grid."""
    first_slots: dict[int, int]
    """By ``id(geometry)``: its first slot in the table of primitives."""
    items: NDArray[np.uint32]
    """(n, 2) a primitive (kind and slot) or an instance, and its grid."""
    cells: int
    """Cells of all grids."""
    growth: Growth
    reach: dict[int, float]
    """By ``id(geometry)``: how far beyond their surfaces its solids are listed at most."""


def plan_grids(
    bodies: Sequence[Body],
    packed: dict[int, PackedGeometry],
    placement: Placement,
    center: NDArray,
    growth: Growth = Growth(),
) -> GridPlan:
    """Lay out the grids of bodies whose geometries are packed, around a scene's centre."""
    over = len(placement.listed)
    grids = np.zeros(over + len(packed), GRID)
    grid_of: dict[int, int] = {}
    first_slots: dict[int, int] = {}
    reach = {key: growth.reach(p) for key, p in packed.items()}
    for geometry in (body.geometry for body in bodies):
        reach[id(geometry)] = max(reach[id(g)] for g in (geometry, *geometry.levels))
    margin = max(reach.values(), default=0.0)
    cells = 0
    items: list[NDArray] = []
    for number, listed in enumerate(placement.listed):
        boxes, radii, counts = _contents(bodies, placement, center, number)
        grids[number] = _grid_over(boxes, radii, counts, margin)
        grids[number]["cells"] = cells
        cells += int(np.prod(grids[number]["dims"], dtype=np.int64))
        items.append(np.stack([listed, np.full(len(listed), number)], 1))
    slots = 0
    for number, (key, p) in enumerate(packed.items(), start=over):
        first_slots[key], grid_of[key] = slots, number
        border = int(np.ceil(reach[key] / p.cell))
        dims = p.dims + 2 * border
        grids[number] = (p.origin - border * p.cell, p.cell, dims, cells)
        item = np.empty((len(p.primitives), 2), np.uint32)
        item[:, 0] = p.primitives + np.uint32(slots)
        item[:, 1] = number
        items.append(item)
        slots += len(p.slots)
        cells += int(np.prod(dims, dtype=np.int64))
    sorted_items = joined(items, (0, 2), np.uint32)
    return GridPlan(grids, over, grid_of, first_slots, sorted_items, cells, growth, reach)


def _contents(
    bodies: Sequence[Body], placement: Placement, center: NDArray, number: int
) -> tuple[list[NDArray], list[float], list[int]]:
    """What a grid over instances holds: boxes in its space; radii, and how often each occurs."""
    if number:
        assembly = placement.assemblies[number - 1]
        inside = [bodies[i] for i in assembly.bodies if len(bodies[i].geometry)]
        boxes = [b.own_bounds - assembly.middle for b in inside]
        return boxes, [b.radius for b in inside], [len(b.positions) for b in inside]
    shown = [b for b in bodies if b.instances and len(b.geometry)]
    single = [b for b in shown if b.frames is None]
    radii = [b.radius for b in single] + [a.radius for a in placement.assemblies]
    counts = [len(b.positions) for b in single]
    counts += [len(a.frames.positions) for a in placement.assemblies]
    return [b.bounds - center for b in shown], radii, counts


def _grid_over(
    boxes: list[NDArray], radii: Sequence[float], counts: Sequence[int], margin: float
) -> tuple[Any, ...]:
    """A grid over instances: cells about as large as a typical one."""
    if not boxes:
        return np.zeros(3), 1.0, np.ones(3), 0
    typical = weighted_median(radii, counts)
    # bounding spheres may reach beyond the boxes, but nothing in them does
    border = margin + 1e-3 * typical
    low = np.min([b[0] for b in boxes], 0) - border
    high = np.max([b[1] for b in boxes], 0) + border
    size = high - low
    cell = max(
        2 * typical, float(np.cbrt(np.prod(size) / (4 * sum(counts) + 8))), float(size.max()) / 512
    )
    return low, cell, np.maximum(np.ceil(size / cell), 1), 0


def build_grids(
    gpu: Gpu, plan: GridPlan, slots: Any, spheres: NDArray[np.float32]
) -> dict[str, Any]:
    """The ``walked`` and ``refs`` tables of all grids together (wgsl/scene.wgsl).

    Args:
        gpu: Where to.
        plan: The grids.
        slots: Table of the primitives.
        spheres: (k, 4) bounding spheres of the instances, in scene space.
    """
    items, cell_count = plan.items, plan.cells
    counts = gpu.buffer(4 * cell_count, label="grid counts")
    cells = gpu.buffer(4 * cell_count, label="grid cells")
    placeholder = gpu.buffer(16)
    resources = {
        "items": gpu.buffer(items, label="primitives to sort"),
        "grids": gpu.buffer(plan.grids, label="grids"),
        "slots": slots,
        "bounds": gpu.buffer(spheres, label="bounding spheres"),
        "counts": counts,
        "cells": cells,
        "refs": placeholder,
    }

    def run(entry: str, threads: int) -> None:
        limit = 65535 * 64
        for first in range(0, threads, limit):
            build = {
                "primitives": len(items),
                "over": plan.over,
                "cells": cell_count,
                "first": first,
                "factor": plan.growth.factor,
                "margin": plan.growth.margin,
            }
            share = min(limit, threads - first)
            gpu.compute("trace/build.wgsl", entry, (share,), resources | {"build": build})

    run("count", len(items))
    lengths = gpu.read_buffer(counts, np.uint32)[:cell_count]
    ends = np.cumsum(lengths, dtype=np.int64)
    # references and what they refer to are numbered alike, after the cells
    starts = np.full(cell_count, cell_count, np.uint32)
    starts[1:] += ends[:-1].astype(np.uint32)
    gpu.write_buffer(cells, starts)
    total = cell_count + int(ends[-1])
    refs = gpu.buffer(padded_bytes(total), label="grid references")
    resources["refs"] = refs
    recorder = gpu.recorder()
    recorder.clear_buffer(counts)
    recorder.submit()
    run("fill", len(items))
    run("finish", cell_count)
    # entries before this are instances
    geometry_cells = plan.grids["cells"][plan.over] if plan.over < len(plan.grids) else cell_count
    top = cell_count + int(ends[int(geometry_cells) - 1])
    clear = gpu.buffer(_clear_directions(plan, lengths == 0), label="clear directions")
    walked = empty_table(gpu, total, "rgba32uint", "grid entries")
    for first in range(0, total, 65535 * 64):
        gpu.compute(
            "trace/copy.wgsl",
            "main",
            (min(65535 * 64, total - first),),
            {
                "copying": {"first": first, "cells": cell_count, "total": total, "top": top},
                "bounds": resources["bounds"],
                "slots": slots,
                "cells": cells,
                "refs": refs,
                "walked": walked,
                "clear": clear,
            },
        )
    return {"walked": walked, "refs": table_from_buffer(gpu, refs, total)}


def _clear_directions(plan: GridPlan, empty: NDArray[np.bool_]) -> NDArray[np.uint32]:
    """What :func:`clear_directions` tells of each cell of all grids, from whether it is empty."""
    bits = np.zeros(len(empty), np.uint32)
    for grid in plan.grids[:_CLEARED]:
        first, dims = int(grid["cells"]), grid["dims"][::-1].astype(np.int64)
        run = slice(first, first + int(np.prod(dims)))
        bits[run] = clear_directions(empty[run].reshape(dims)).ravel()
    return bits


def joined(arrays: list[NDArray], shape: tuple[int, ...], dtype: Any) -> NDArray:
    return np.concatenate([*arrays, np.zeros(shape, dtype)]).astype(dtype, copy=False)


def weighted_median(values: Sequence[float], weights: Sequence[int]) -> float:
    order = np.argsort(values)
    cumulative = np.cumsum(np.asarray(weights, float)[order])
    index = min(int(np.searchsorted(cumulative, cumulative[-1] / 2)), len(order) - 1)
    return float(np.asarray(values)[order][index])
