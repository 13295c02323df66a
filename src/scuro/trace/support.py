"""How far objects reach in each direction: instances need not be listed in cells beyond.

A cell that lies beyond the plane across a direction u at the distance h(u) of the support function
h(u) = max over all points p of u·p holds nothing of the object. Molecules fill their bounding
spheres badly: on a round protein this leaves out an eighth of the cells that the sphere touches.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, Geometry
from scuro.trace.pack import PackedGeometry

EDGE = 16
"""Texels along the edge of an object's table, which is an octahedral map."""
FROM = 1 << 12
"""Scenes of fewer instances do without: there all objects count as their bounding spheres."""
_POINTS = 1 << 14

_tables: weakref.WeakKeyDictionary[Geometry, NDArray[np.float32]] = weakref.WeakKeyDictionary()


def support_tables(
    bodies: Sequence[Body], packed: dict[int, PackedGeometry], rows: int, radii: Sequence[float]
) -> NDArray[np.float32]:
    """The tables (n, e, e) of all objects of a scene: bodies, then assemblies, which are spheres.

    Args:
        bodies: Of the scene.
        packed: Their geometries and those of their levels, by ``id``.
        rows: Instances in the table.
        radii: Of the n objects' bounding spheres.
    """
    edge = EDGE if rows >= FROM else 1
    tables = np.tile(np.array(radii, np.float32)[:, None, None], (1, edge, edge))
    if edge > 1:
        for table, body, radius in zip(tables, bodies, radii, strict=False):
            geometry = body.geometry
            if geometry not in _tables:
                solids = [packed[id(g)].slots for g in (geometry, *geometry.levels)]
                _tables[geometry] = support_table(solids, radius)
            table[:] = _tables[geometry]
    return tables


def support_table(solids: Iterable[NDArray[np.float32]], radius: float) -> NDArray[np.float32]:
    """Upper bounds (EDGE, EDGE) of the support in the directions of each texel.

    The support is convex, and directions within a texel are positive combinations of those of its
    corners: the largest at the corners, over the cosine between a corner and the middle, bounds it.

    Args:
        solids: Points and radii (n, 4) about the middle of the object: that of each of its levels.
        radius: Of the bounding sphere, which bounds the support, too.
    """
    corners = _directions()
    flat = np.ones(((EDGE + 1) ** 2, 4), np.float32)  # the radius adds to any of them
    flat[:, :3] = corners.reshape(-1, 3)
    reach = np.zeros(len(flat), np.float32)
    for points in solids:
        for start in range(0, len(points), _POINTS):
            part = points[start : start + _POINTS]
            np.maximum(reach, (flat @ part.T).max(axis=1), out=reach)
    around = _of_texels(reach.reshape(EDGE + 1, EDGE + 1))
    middle = _of_texels(corners).sum(axis=0)
    middle /= np.linalg.norm(middle, axis=-1, keepdims=True)
    cosine = np.einsum("kyxi,yxi->kyx", _of_texels(corners), middle).min(axis=0)
    return np.minimum(around.max(axis=0) / cosine * 1.0001, radius).astype(np.float32)


def _of_texels(corners: NDArray) -> NDArray:
    """What belongs to the four corners of each texel."""
    return np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, :-1], corners[1:, 1:]])


def _directions() -> NDArray[np.float64]:
    """Of the texels' corners: ``octahedral_direction`` of wgsl/octahedral.wgsl."""
    ticks = np.linspace(-1, 1, EDGE + 1)
    y, x = np.meshgrid(ticks, ticks, indexing="ij")
    z = 1 - np.abs(x) - np.abs(y)
    sign_x, sign_y = np.where(x >= 0, 1, -1), np.where(y >= 0, 1, -1)
    x, y = (
        np.where(z >= 0, x, (1 - np.abs(y)) * sign_x),
        np.where(z >= 0, y, (1 - np.abs(x)) * sign_y),
    )
    direction = np.stack([x, y, z], axis=-1)
    return direction / np.linalg.norm(direction, axis=-1, keepdims=True)
