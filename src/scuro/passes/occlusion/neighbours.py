"""The nearest spheres around each atom, found on the GPU over a grid of centres.

Those of a geometry are looked for among its own spheres, some twelve spheres away at most.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from functools import partial
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.passes.frame import Frame
from scuro.steps import finished, in_thread, scaled
from scuro.trace import Accelerator
from scuro.trace.pack import PackedGeometry, sorted_by
from scuro.trace.table import empty_table, filled_in_steps

STEP = 1 << 13
"""So many lists of sixteen are made in one step; of longer ones, fewer."""
_CELLS_A_SPHERE = 4


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Lists for all slots of a scene that belong to spheres and rods."""

    texels: int
    """Texels of four neighbours a list."""
    table: Any
    """Slots of neighbours, nearest first; ``NO_PRIMITIVE`` where there are no more."""
    skipped: Any
    """Buffer: for each object what its slots' rows in the table are less than the slots: triangles
    have no row."""

    @property
    def resources(self) -> dict[str, Any]:
        return {"neighbours": self.table, "neighbours_skipped": self.skipped}


_known: WeakKeyDictionary[Accelerator, dict[int, Neighbours]] = WeakKeyDictionary()


def neighbours_of(frame: Frame, count: int) -> Neighbours:
    """The lists of a frame's scene, kept as long as the scene is.

    Args:
        frame: Of the scene.
        count: Spheres a list; rounded up to fours.
    """
    return finished(neighbours_in_steps(frame, count))


def neighbours_in_steps(frame: Frame, count: int) -> Generator[float, None, Neighbours]:
    """The same in steps; yields the share that is done."""
    kept = _known.setdefault(frame.accelerator, {})
    texels = -(-count // 4)
    if texels not in kept:
        kept[texels] = yield from _search(frame.gpu, frame.accelerator, texels)
    return kept[texels]


@dataclass(frozen=True, eq=False)
class _Cells:
    """The spheres of one geometry sorted by cells."""

    entries: NDArray[np.uint32]
    """(n, 4) the bits of each centre, and its slot in the geometry."""
    starts: NDArray[np.int64]
    """(cells + 1,) first entry of each cell."""
    origin: NDArray[np.float32]
    cell: float
    dims: NDArray[np.int64]


def _search(gpu: Gpu, accelerator: Accelerator, texels: int) -> Generator[float, None, Neighbours]:
    packed = accelerator.packed
    first_slots = accelerator.first_slots
    cells: list[tuple[NDArray[np.uint32], NDArray[np.uint32]]] = []
    skipped: dict[int, int] = {}
    uniforms: list[dict[str, Any]] = []
    entries = starts = triangles = rows = 0
    for key, p in packed.items():
        spheres, ends = _kinds(p)
        skipped[key] = triangles
        found = yield from in_thread(partial(_sorted_centers, p.slots[:spheres, :3]))
        slots = found.entries
        slots[:, 3] += np.uint32(first_slots[key])
        uniforms.append(
            {
                "spheres": spheres,
                "entries": entries,
                "rods": first_slots[key] + spheres,
                "cells": starts,
                "skipped": triangles,
                "texels": texels,
                "origin": found.origin,
                "cell": found.cell,
                "dims": found.dims,
                "end": spheres + ends,
            }
        )
        cells.append((slots, (found.starts + entries).astype(np.uint32)))
        entries += spheres
        starts += len(found.starts)
        rows += spheres + ends
        triangles += len(p.slots) - spheres - ends
    none, no_cell = np.zeros((1, 4), np.uint32), np.zeros(1, np.uint32)
    upload = partial(filled_in_steps, gpu)
    listed = [*(c[0] for c in cells), none], [*(c[1] for c in cells), no_cell]
    resources = {
        "slots": accelerator.resources["slots"],
        "entries": (yield from scaled(upload(listed[0], "rgba32uint", "centres"), 0.0, 0.05)),
        "starts": (yield from scaled(upload(listed[1], "r32uint", "cells"), 0.05, 0.1)),
        "found": empty_table(gpu, max(1, rows * texels), "rgba32uint", "neighbours"),
    }
    # a scan of the surroundings finds sixteen
    done, step = 0, STEP // -(-texels // 4)
    for uniform in uniforms:
        for first in range(0, uniform["end"], step):
            count = min(step, uniform["end"] - first)
            search = uniform | {"first": first, "end": first + count}
            gpu.compute(
                "passes/occlusion/neighbours.wgsl", "main", (count,),
                resources | {"search": search}, {"WIDE": _scans(texels, 6) < _scans(texels, 4)},
            )  # fmt: skip
            done += count
            yield 0.1 + 0.9 * done / rows
    by_object = [skipped[id(body.geometry)] for body in accelerator.bodies]
    buffer = gpu.buffer(np.array([*by_object, 0], np.uint32), label="slots without neighbours")
    return Neighbours(texels, resources["found"], buffer)


def _scans(texels: int, width: int) -> int:
    return -(-texels // width)


def _kinds(p: PackedGeometry) -> tuple[int, int]:
    """Slots of spheres and slots of rods; those of triangles follow."""
    kinds = p.primitives >> np.uint32(29)
    return int((kinds == 0).sum()), 2 * int(((kinds == 1) | (kinds == 2)).sum())


def _sorted_centers(points: NDArray[np.float32]) -> _Cells:
    """Centres (n, 3) sorted into cells of about the distance between them."""
    if len(points) == 0:
        nothing = np.zeros((0, 4), np.uint32)
        return _Cells(nothing, np.zeros(2, np.int64), np.zeros(3, np.float32), 1.0, np.ones(3, int))
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.maximum((high - low).astype(np.float64), 1e-6)
    origin = low - np.float32(1e-6) * np.float32(size.max())
    # ever smaller cells until most points have one for themselves: in a line, a sheet or a ball
    cell = float(size.max()) / np.cbrt(len(points))
    while True:
        dims = np.floor(size / cell * 1.0001).astype(np.int64) + 1
        at = _flat(points, origin, cell, dims)
        taken = np.count_nonzero(np.bincount(at))
        smaller = np.prod(np.floor(size / (0.85 * cell)) + 1)
        if taken >= 0.6 * len(points) or smaller > _CELLS_A_SPHERE * len(points) + 64:
            break
        cell *= 0.85
    order = sorted_by(at)
    entries = np.empty((len(points), 4), np.uint32)
    entries[:, :3] = points[order].view(np.uint32)
    entries[:, 3] = order
    starts = np.zeros(dims.prod() + 1, np.int64)
    np.cumsum(np.bincount(at, minlength=dims.prod()), out=starts[1:])
    return _Cells(entries, starts, origin, cell, dims)


def _flat(points: NDArray, origin: NDArray, cell: float, dims: NDArray) -> NDArray[np.uint32]:
    """The cell of each point (n, 3), numbered along x first."""
    at = np.zeros(len(points), np.uint32)
    for axis in (2, 1, 0):
        place = ((points[:, axis] - origin[axis]) / np.float32(cell)).astype(np.int32)
        at *= np.uint32(dims[axis])
        at += np.clip(place, 0, dims[axis] - 1).astype(np.uint32)
    return at
