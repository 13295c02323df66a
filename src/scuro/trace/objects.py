"""The object table: what tracing and shading need to know of each body, level and assembly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body
from scuro.trace.grids import GRID, GridPlan
from scuro.trace.pack import PackedGeometry
from scuro.trace.placement import Placement

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
        ("number", np.uint32),
        ("row", np.uint32),
        ("copies", np.uint32),
        ("frame", np.uint32),
    ]
)
"""``Traced``, ``Material`` and ``Numbering`` of wgsl/scene.wgsl: OBJECT_TEXELS texels."""

MATERIAL_KINDS = ("diffuse", "glossy", "metal", "mirror", "glass")
UNCLIPPED, OPEN, NESTED = 1, 2, 4
"""As in wgsl/scene.wgsl."""
OPACITY_SHIFT = 24
"""The flags' highest byte is the opacity (wgsl/opacity.wgsl)."""


NO_FRAME = 0xFFFFFFFF


def object_table(
    bodies: Sequence[Body], packed: dict[int, PackedGeometry], plan: GridPlan, placement: Placement
) -> NDArray:
    """OBJECT records: bodies, then assemblies, then levels of detail; one row at least."""
    objects = np.zeros(max(1, len(bodies) + len(placement.assemblies)), OBJECT)
    objects["frame"] = NO_FRAME
    for index, body in enumerate(bodies):
        key = id(body.geometry)
        objects[index] = _object(body, packed[key], plan.grids[plan.grid_of[key]])
        objects[index]["radius"] += plan.reach[key]
        objects[index]["number"] = placement.numbers[index]
        objects[index]["row"] = placement.runs[index].first
        objects[index]["copies"] = len(body.positions)
        found = placement.of_body[index]
        objects[index]["frame"] = NO_FRAME if found is None else placement.assemblies[found].row
    for number, assembly in enumerate(placement.assemblies):
        row = objects[len(bodies) + number]
        row["grid"] = plan.grids[1 + number]
        row["radius"] = assembly.radius + max(
            plan.reach[id(bodies[i].geometry)] for i in assembly.bodies
        )
        row["flags"] = NESTED
    grids = {key: plan.grids[number] for key, number in plan.grid_of.items()}
    return _with_levels(objects, bodies, packed, grids)


def _with_levels(
    objects: NDArray, bodies: Sequence[Body], packed: dict[int, PackedGeometry], grids: dict
) -> NDArray:
    """The object table with a row for each coarser level, and links from each to the next."""
    first: dict[int, int] = {}
    rows: list[NDArray] = []
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
        *(0, 0, 0, NO_FRAME),
    )
