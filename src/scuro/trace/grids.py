"""The uniform grids of a scene: over each geometry's primitives, over instances and assemblies.

Here they are laid out; ``build.py`` sorts things into them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body
from scuro.trace.instances import Encoding
from scuro.trace.pack import PackedGeometry
from scuro.trace.placement import Placement
from scuro.trace.support import support_tables

GRID = np.dtype(
    [("origin", np.float32, 3), ("cell", np.float32), ("dims", np.uint32, 3), ("cells", np.uint32)]
)
"""``Grid`` of wgsl/scene_types.wgsl."""


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
    """GRID records: over instances (the scene's, the assemblies'), then one a geometry. Cells of
    the former are numbered by themselves."""
    over: int
    """How many of them are over instances."""
    listed: tuple[tuple[tuple[int, int], ...], ...]
    """For each of those the runs of instances that it lists: first and number."""
    grid_of: dict[int, int]
    """By ``id(geometry)``: its grid."""
    first_slots: dict[int, int]
    """By ``id(geometry)``: its first slot in the table of primitives."""
    primitives: tuple[NDArray[np.uint32], ...]
    """Those of each geometry (kind and slot among its own)."""
    listing_cells: int
    """Cells of all grids over instances."""
    cells: int
    """Cells of all others."""
    growth: Growth
    encoding: Encoding
    """How instances are read."""
    supports: NDArray[np.float32]
    """(objects, e, e) how far objects reach: see :func:`support_tables`."""
    reach: dict[int, float]
    """By ``id(geometry)``: how far beyond their surfaces its solids are listed at most."""

    @property
    def farthest(self) -> float:
        """The largest of ``reach``: how far beyond their bounding spheres instances are listed."""
        return max(self.reach.values(), default=0.0)


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
    listing_cells = 0
    for number in range(over):
        boxes, radii, counts = _contents(bodies, placement, center, number)
        code = placement.encoding
        spare = margin + (code.steps[min(number, 1)] if code.packed else 0.0)
        grids[number] = _grid_over(boxes, radii, counts, spare, code.packed)
        grids[number]["cells"] = listing_cells
        listing_cells += int(np.prod(grids[number]["dims"], dtype=np.int64))
    supports = support_tables(
        bodies, packed, len(placement), [run.radius for run in placement.runs]
    )
    slots = cells = 0
    for number, (key, p) in enumerate(packed.items(), start=over):
        first_slots[key], grid_of[key] = slots, number
        border = int(np.ceil(reach[key] / p.cell))
        dims = p.dims + 2 * border
        grids[number] = (p.origin - border * p.cell, p.cell, dims, cells)
        slots += len(p.slots)
        cells += int(np.prod(dims, dtype=np.int64))
    return GridPlan(
        grids, over, placement.listed, grid_of, first_slots,
        tuple(p.primitives for p in packed.values()), listing_cells, cells, growth,
        placement.encoding, supports, reach,
    )  # fmt: skip


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
    boxes: list[NDArray],
    radii: Sequence[float],
    counts: Sequence[int],
    margin: float,
    sparing: bool,
) -> tuple[Any, ...]:
    """A grid over instances: cells about as large as a typical one, or larger to save memory."""
    if not boxes:
        return np.zeros(3), 1.0, np.ones(3), 0
    typical = weighted_median(radii, counts)
    # bounding spheres may reach beyond the boxes, but nothing in them does
    border = margin + 1e-3 * typical
    low = np.min([b[0] for b in boxes], 0) - border
    high = np.max([b[1] for b in boxes], 0) + border
    size = high - low
    cell = max(
        (2.5 if sparing else 2.0) * typical,
        float(np.cbrt(np.prod(size) / (4 * sum(counts) + 8))),
        float(size.max()) / 512,
    )
    return low, cell, np.maximum(np.ceil(size / cell), 1), 0


def weighted_median(values: Sequence[float], weights: Sequence[int]) -> float:
    order = np.argsort(values)
    cumulative = np.cumsum(np.asarray(weights, float)[order])
    index = min(int(np.searchsorted(cumulative, cumulative[-1] / 2)), len(order) - 1)
    return float(np.asarray(values)[order][index])
