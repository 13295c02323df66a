"""A geometry as the tracer stores it: slots of four floats, ordered along a Morton curve."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, Geometry

SPHERE, ROD, CONE, TRIANGLE = (np.uint32(k << 29) for k in range(4))
NO_PRIMITIVE = 0xFFFFFFFF


@dataclass(frozen=True, eq=False)
class PackedGeometry:
    """Slots, attributes and the grid of one geometry, about the middle of its box."""

    slots: NDArray[np.float32]
    """(s, 4): one a sphere (centre, radius), two a rod, three a triangle."""
    attributes: NDArray[np.uint32]
    """(s, 4): element id; linear red and green, blue as halves; octahedral normal."""
    primitives: NDArray[np.uint32]
    """(p,) kind and first slot of each primitive."""
    middle: NDArray[np.float32]
    """(3,) what was taken off all coordinates."""
    radius: float
    """Of the bounding sphere around the middle."""
    origin: NDArray[np.float32]
    cell: float
    dims: NDArray[np.uint32]
    clusters: NDArray[np.float32]
    """(c, 4) bounding spheres of runs of primitives that lie close together."""
    median_radius: float
    has_rods: bool
    has_triangles: bool


CELLS_A_PRIMITIVE = 4
"""Upper bound on a grid's cells: sparse geometries get larger cells, not more of them."""

_LINEAR = np.arange(256) / 255
_LINEAR = np.where(_LINEAR <= 0.04045, _LINEAR / 12.92, ((_LINEAR + 0.055) / 1.055) ** 2.4)
_LINEAR = _LINEAR.astype(np.float16)
"""Linear intensity of an sRGB byte."""

_packed: weakref.WeakKeyDictionary[Geometry, PackedGeometry] = weakref.WeakKeyDictionary()


def pack_geometry(geometry: Geometry, middle: NDArray[np.float32] | None = None) -> PackedGeometry:
    """A geometry packed for the GPU; the same geometry is packed once.

    ``middle`` (3,) is taken off all coordinates: that of the box by default, that of the full
    geometry for its coarser levels.
    """
    found = _packed.get(geometry)
    if found is None:
        found = _packed[geometry] = _pack(geometry, middle)
    return found


def pack_bodies(bodies: Sequence[Body]) -> dict[int, PackedGeometry]:
    """All geometries and their levels, by ``id``; a geometry's radius holds its levels too."""
    packed: dict[int, PackedGeometry] = {}
    for key, geometry in {id(b.geometry): b.geometry for b in bodies}.items():
        full = pack_geometry(geometry)
        levels = {id(level): pack_geometry(level, full.middle) for level in geometry.levels}
        radius = max([full.radius, *(p.radius for p in levels.values())])
        packed[key] = replace(full, radius=radius)
        packed |= levels
    return packed


_AT_ONCE = 1 << 16
"""Primitives that are converted at once: what lies between fits a processor's cache."""


def _pack(geometry: Geometry, middle: NDArray[np.float32] | None) -> PackedGeometry:
    low, high = geometry.bounds
    if middle is None:
        middle = ((low.astype(np.float64) + high) / 2).astype(np.float32)
    count = len(geometry)
    radii = np.concatenate([geometry.spheres[:, 3], geometry.rods[:, :, 3].mean(axis=1)])
    median = float(np.median(radii)) if len(radii) else 0.0
    cell, dims = _cells(geometry, low, high, median, count * CELLS_A_PRIMITIVE)
    origin = low - middle - 0.5 * (dims * cell - (high - low))

    # spheres, then rods, then triangles, each along the curve
    orders, codes = [], []
    for corners in (geometry.spheres[:, None], geometry.rods, geometry.triangles):
        found = _codes(corners, low, cell)
        along = sorted_by(found)
        orders.append(along)
        codes.append(found[along])
    s, r, t = orders
    rod_at, triangle_at = len(s), len(s) + 2 * len(r)
    slots = np.zeros((triangle_at + 3 * len(t), 4), np.float32)
    attributes = np.zeros((len(slots), 4), np.uint32)
    # three halves and nothing: linear colour needs no power function when a pixel is shaded
    halves = attributes[:, 1:3].view(np.float16)
    kinds = (
        (0, s, geometry.spheres[:, None], geometry.sphere_ids, geometry.sphere_colors),
        (rod_at, r, geometry.rods, geometry.rod_ids, geometry.rod_colors),
        (triangle_at, t, geometry.triangles, geometry.triangle_ids, geometry.triangle_colors),
    )
    for at, order, corners, ids, colors in kinds:
        each, width = corners.shape[1:]
        for first in range(0, len(order), _AT_ONCE):
            here = order[first : first + _AT_ONCE]
            there = slice(at + each * first, at + each * (first + len(here)))
            slots[there, :width] = corners[here].reshape(-1, width)
            slots[there, :3] -= middle
            attributes[there, 0] = ids[here].reshape(-1).view(np.uint32)
            halves[there, :3] = _LINEAR[colors[here].reshape(-1, 4)[:, :3]]
    for first in range(0, len(t), _AT_ONCE):
        packed = octahedral(geometry.triangle_normals[t[first : first + _AT_ONCE]].reshape(-1, 3))
        at = triangle_at + 3 * first
        attributes[at : at + len(packed), 3] = packed

    rods = slots[rod_at:triangle_at].reshape(-1, 2, 4)
    rod_kind = np.where(np.isclose(rods[:, 0, 3], rods[:, 1, 3], rtol=1e-5), ROD, CONE)
    primitives = np.concatenate(
        [
            np.arange(len(s), dtype=np.uint32) | SPHERE,
            (rod_at + 2 * np.arange(len(r), dtype=np.uint32)) | rod_kind.astype(np.uint32),
            (triangle_at + 3 * np.arange(len(t), dtype=np.uint32)) | TRIANGLE,
        ]
    )
    corners = np.sqrt(np.einsum("ij,ij->i", slots[:, :3], slots[:, :3])) + slots[:, 3]
    radius = float(corners.max()) * 1.00001 if len(corners) else 0.0
    pieces = (slots[:rod_at, None], rods, slots[triangle_at:].reshape(-1, 3, 4))
    clusters = [_clusters(piece, found) for piece, found in zip(pieces, codes, strict=True)]
    return PackedGeometry(
        slots=slots,
        attributes=attributes,
        primitives=primitives,
        middle=middle,
        radius=radius,
        origin=origin.astype(np.float32),
        cell=cell,
        dims=dims,
        clusters=np.concatenate(clusters),
        median_radius=median,
        has_rods=len(r) > 0,
        has_triangles=len(t) > 0,
    )


def _codes(
    corners: NDArray[np.float32], low: NDArray[np.float32], cell: float
) -> NDArray[np.uint32]:
    """Morton codes (n,) of the cells in which the middles of primitives (n, k, 3 or 4) lie."""
    codes = np.empty(len(corners), np.uint32)
    for first in range(0, len(corners), _AT_ONCE):
        here = corners[first : first + _AT_ONCE, :, :3]
        # a sum over an axis of two or three is an order slower by numpy's own reduction
        middles = sum(here[:, k] for k in range(here.shape[1])) / np.float32(here.shape[1])
        codes[first : first + len(here)] = morton(((middles - low) / cell).astype(np.uint32))
    return codes


def sorted_by(codes: NDArray[np.uint32]) -> NDArray[np.intp]:
    """What sorts codes stably: by their lower halves, then by their upper ones.

    numpy sorts 16 bits by counting, several times as fast as 32 by comparing.
    """
    lower = np.argsort(codes.astype(np.uint16), kind="stable")
    upper = (codes >> np.uint32(16)).astype(np.uint16)[lower]
    return lower[np.argsort(upper, kind="stable")]


def _clusters(points: NDArray[np.float32], codes: NDArray[np.uint32]) -> NDArray[np.float32]:
    """Bounding spheres (c, 4) of runs of primitives (n, k, 4) that share a cell, or 2³ or 4³."""
    if len(points) == 0:
        return np.zeros((0, 4), np.float32)
    cubes = codes >> np.uint32(0 if len(points) < 20_000 else 3 if len(points) < 200_000 else 6)
    starts = np.flatnonzero(np.append(True, cubes[1:] != cubes[:-1]))
    low = np.minimum.reduceat((points[..., :3] - points[..., 3:]).min(axis=1), starts)
    high = np.maximum.reduceat((points[..., :3] + points[..., 3:]).max(axis=1), starts)
    middle = (low + high) / 2
    radius = np.linalg.norm(high - low, axis=1) / 2
    return np.concatenate([middle, radius[:, None] * 1.0001], axis=1)


def _cells(
    geometry: Geometry, low: NDArray, high: NDArray, median: float, limit: int
) -> tuple[float, NDArray[np.uint32]]:
    """Cell size and grid dimensions.

    Space-filling atoms trace equally fast between 1.2 and 2.2 median radii, while the grid's size
    halves. Thin sticks and triangles have more space between than inside them: there the spacing
    decides.
    """
    size = np.maximum((high - low).astype(np.float64), 1e-6)
    size = np.maximum(size, size.max() * 1e-3)
    count = max(1, len(geometry))
    spacing = float(np.cbrt(np.prod(size) / count))
    cell = max(2.0 * median, 0.5 * spacing) if len(geometry.spheres) else max(median, spacing)
    while True:
        dims = np.maximum(np.ceil(size / cell * 1.0001), 1)
        if np.prod(dims) <= max(limit, 64) and dims.max() <= 1024:
            return cell, dims.astype(np.uint32)
        cell *= 1.05


def morton(cells: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Codes (n,) along the Morton curve of cells (n, 3), ten bits a coordinate."""
    code = np.zeros(len(cells), np.uint32)
    for axis in range(3):
        v = np.minimum(cells[:, axis], 1023).astype(np.uint32)
        v = (v | (v << np.uint32(16))) & np.uint32(0x030000FF)
        v = (v | (v << np.uint32(8))) & np.uint32(0x0300F00F)
        v = (v | (v << np.uint32(4))) & np.uint32(0x030C30C3)
        v = (v | (v << np.uint32(2))) & np.uint32(0x09249249)
        code |= v << np.uint32(axis)
    return code


def octahedral(normals: NDArray) -> NDArray[np.uint32]:
    """Unit vectors (n, 3) packed as ``octahedral_encode`` of wgsl/octahedral.wgsl does."""
    n = normals.astype(np.float64)
    n = n / np.maximum(np.abs(n).sum(axis=1, keepdims=True), 1e-30)
    p = n[:, :2]
    wrapped = (1 - np.abs(p[:, ::-1])) * np.where(p >= 0, 1, -1)
    p = np.where(n[:, 2:] >= 0, p, wrapped)
    q = np.round(np.clip(p, -1, 1) * 32767).astype(np.int16)
    return np.ascontiguousarray(q).view(np.uint32)[:, 0]
