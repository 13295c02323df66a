"""Faces of chosen cells, and isosurfaces through them, as triangles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.cornerpoint_topology import split_faces

# for each face: axis (0 k, 1 j, 2 i), end of it, and its corners around (k, j, i side)
_FACES = (
    (0, 0, ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))),
    (0, 1, ((1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0))),
    (1, 0, ((0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0))),
    (1, 1, ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))),
    (2, 0, ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))),
    (2, 1, ((0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1))),
)
_AXES = "kji"

# Kuhn's six tetrahedra of a cube, corners as numbers 4 k + 2 j + i: neighbours' diagonals agree
_TETRAHEDRA = np.array(
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]]
)


@dataclass(frozen=True)
class Faces:
    """Quadrilaterals of cells."""

    corners: NDArray[np.float64]
    """(n, 4, 3) world positions, counter-clockwise seen from outside the cell."""
    cells: NDArray[np.int64]
    """(n,) flat index of the cell, in natural order."""


def outer_faces(grid: CornerPointGrid, chosen: NDArray, exaggeration: float) -> Faces:
    """Faces of chosen cells that no other chosen cell covers.

    A face between two chosen cells is left out only where all four corners agree: at faults both
    sides are kept.

    Args:
        grid: The grid.
        chosen: (nk, nj, ni) which cells.
        exaggeration: Factor on heights.
    """
    return _gather(grid, exaggeration, _bare(grid, chosen))


def fault_faces(grid: CornerPointGrid, chosen: NDArray, exaggeration: float) -> Faces:
    """Faces of chosen cells whose neighbour across them is chosen too but displaced."""
    return _gather(grid, exaggeration, _displaced(grid, chosen))


def _bare(grid: CornerPointGrid, chosen: NDArray) -> Iterator[tuple[int, NDArray]]:
    split = {axis: split_faces(grid, name) for axis, name in enumerate(_AXES)}
    for number, (axis, end, _) in enumerate(_FACES):
        covered = np.zeros(chosen.shape, bool)
        own, other = _sides(axis, end)
        covered[own] = chosen[other] & ~split[axis]
        yield number, chosen & ~covered


def _displaced(grid: CornerPointGrid, chosen: NDArray) -> Iterator[tuple[int, NDArray]]:
    split = {axis: split_faces(grid, _AXES[axis]) for axis in (1, 2)}
    for number, (axis, end, _) in enumerate(_FACES):
        if axis == 0:
            continue
        apart = np.zeros(chosen.shape, bool)
        own, other = _sides(axis, end)
        apart[own] = chosen[other] & split[axis]
        yield number, chosen & apart


def _sides(axis: int, end: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Where cells have a neighbour at an end of an axis, and where those neighbours are."""
    low, high = [slice(None)] * 3, [slice(None)] * 3
    low[axis], high[axis] = slice(None, -1), slice(1, None)
    return (tuple(low), tuple(high)) if end else (tuple(high), tuple(low))


def _gather(
    grid: CornerPointGrid, exaggeration: float, found: Iterator[tuple[int, NDArray]]
) -> Faces:
    quads, cells = [np.zeros((0, 4, 3))], [np.zeros(0, np.int64)]
    for number, mask in found:
        index = np.flatnonzero(mask)
        corners = grid.to_world(grid.corners(index), exaggeration)
        quad = np.stack([corners[:, k, j, i] for k, j, i in _FACES[number][2]], axis=1)
        outward = quad.mean(axis=1) - corners.reshape(-1, 8, 3).mean(axis=1)
        normal = np.cross(quad[:, 2] - quad[:, 0], quad[:, 3] - quad[:, 1])
        wrong = (normal * outward).sum(axis=1) < 0
        quad[wrong] = quad[wrong][:, ::-1]
        area = np.linalg.norm(normal, axis=1)
        kept = area > 1e-9 * max(float(area.max(initial=0)), 1e-30)
        quads.append(quad[kept])
        cells.append(index[kept])
    return Faces(np.concatenate(quads), np.concatenate(cells))


def isosurface(
    grid: CornerPointGrid, corner_values: NDArray, chosen: NDArray, iso: float, exaggeration: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles where the values at cells' corners cross a value, by marching tetrahedra.

    Args:
        grid: The grid.
        corner_values: As of :func:`~scuro.scene.cornerpoint_topology.vertex_values`.
        chosen: (nk, nj, ni) which cells.
        iso: The value.
        exaggeration: Factor on heights.

    Returns:
        (n, 3, 3) world positions, facing the lower values, and (n,) cells.
    """
    low, high = corner_values.min(axis=(1, 3, 5)), corner_values.max(axis=(1, 3, 5))
    with np.errstate(invalid="ignore"):
        cells = np.flatnonzero(chosen & (low < iso) & (high >= iso))
    points = grid.to_world(grid.corners(cells), exaggeration).reshape(-1, 8, 3)
    k, j, i = np.unravel_index(cells, grid.active.shape)
    values = np.stack(
        [corner_values[k, dk, j, dj, i, di] for dk, dj, di in np.ndindex(2, 2, 2)], axis=1
    )
    found, owners = [np.zeros((0, 3, 3))], [np.zeros(0, np.int64)]
    for corners in _TETRAHEDRA:
        triangles, which = _cut_tetrahedra(points[:, corners], values[:, corners], iso)
        found.append(triangles)
        owners.append(cells[which])
    return np.concatenate(found), np.concatenate(owners)


def _cut_tetrahedra(
    points: NDArray, values: NDArray, iso: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles of (n, 4) tetrahedra; each is cut in a triangle or a quadrilateral."""
    order = np.argsort(values, axis=1, kind="stable")
    points = np.take_along_axis(points, order[:, :, None], axis=1)
    values = np.take_along_axis(values, order, axis=1).astype(np.float64)
    above = (values >= iso).sum(axis=1)

    def cut(rows: NDArray, a: int, b: int) -> NDArray:
        gap = values[rows, b] - values[rows, a]
        share = (iso - values[rows, a]) / np.where(gap == 0, 1, gap)
        return points[rows, a] + share[:, None] * (points[rows, b] - points[rows, a])

    one, two, three = (np.flatnonzero(above == n) for n in (1, 2, 3))
    parts = [
        (one, [(0, 3), (1, 3), (2, 3)]),
        (three, [(0, 1), (0, 2), (0, 3)]),
        (two, [(0, 2), (0, 3), (1, 3)]),
        (two, [(0, 2), (1, 3), (1, 2)]),
    ]
    triangles = np.concatenate(
        [np.stack([cut(rows, a, b) for a, b in edges], axis=1) for rows, edges in parts]
    )
    which = np.concatenate([rows for rows, _ in parts])
    # face the lowest corner
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    wrong = (normal * (points[which, 0] - triangles[:, 0])).sum(axis=1) < 0
    triangles[wrong] = triangles[wrong][:, ::-1]
    kept = np.linalg.norm(normal, axis=1) > 0
    return triangles[kept], which[kept]
