"""Sweeps a cross-section along smooth curves: closed triangle meshes for cartoons.

A cross-section is a rectangle with rounded corners: a circle, a flat band and a bar are the same
shape with other numbers, so that one ribbon can pass from one to another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Geometry
from scuro.style.sticks import any_across, unit


@dataclass(frozen=True)
class Rings:
    """Cross-sections along one or more ribbons, s of them."""

    centers: NDArray
    """(s, 3)"""
    tangents: NDArray
    """(s, 3) unit, the way the chain runs."""
    sides: NDArray
    """(s, 3) unit, the direction of the width, perpendicular to the tangent."""
    shapes: NDArray
    """(s, 3): half width, half thickness, radius of the corners."""
    starts: NDArray[np.bool_]
    """(s,) the first ring of every ribbon."""
    owners: NDArray[np.intp]
    """(s,) the atom that gives the ring its colour and id."""


def hermite(
    points: NDArray, starts: NDArray[np.bool_], at: NDArray[np.intp], t: NDArray
) -> tuple[NDArray, NDArray]:
    """Smooth curves through ``points`` (k, 3): value and derivative at ``at + t``.

    Cubic Hermite pieces with the directions of Catmull and Rom's, but with the speed that makes
    evenly turning points lie on (nearly) a circle: an alpha helix turns by 100° a residue.

    Args:
        points: Points of all curves, one curve after the other.
        starts: (k,) the first point of every curve.
        at: (s,) the point before each place; at a curve's last point t must be 0.
        t: (s,) 0 to 1, the way to the next point.
    """
    last = ends_of(starts)
    index = np.arange(len(points))
    before, after = np.where(starts, index, index - 1), np.where(last, index, index + 1)
    steps = np.maximum(after - before, 1)[:, None]
    slopes = (points[after] - points[before]) / steps * _round(points, before, after)[:, None]
    p, q, u, v = points[at], points[after[at]], slopes[at], slopes[after[at]]
    t = t[:, None]
    value = (
        (1 + 2 * t) * (1 - t) ** 2 * p
        + t * (1 - t) ** 2 * u
        + t**2 * (3 - 2 * t) * q
        + t**2 * (t - 1) * v
    )
    slope = 6 * t * (t - 1) * (p - q) + (1 - t) * (1 - 3 * t) * u + t * (3 * t - 2) * v
    return value, slope


def ends_of(starts: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The last element of every run, from the first ones (k,)."""
    return np.append(starts[1:], True)[: len(starts)]


def _round(points: NDArray, before: NDArray, after: NDArray) -> NDArray:
    """Factor (k,) on Catmull-Rom slopes r sin(a) that gives 4 r tan(a/4), a turning by ``a``."""
    coming, going = unit(points - points[before]), unit(points[after] - points)
    angle = np.arccos(np.clip((coming * going).sum(-1), -1.0, 1.0))
    angle = np.where((coming == 0).all(-1) | (going == 0).all(-1), 0.0, angle)
    angle = np.clip(angle, 1e-3, np.radians(110))
    return 4 * np.tan(angle / 4) / np.sin(angle)


def frames(tangents: NDArray, guides: NDArray) -> NDArray:
    """Unit vectors (s, 3) across the ``tangents``, as near to the ``guides`` as they can be."""
    across = guides - (guides * tangents).sum(-1, keepdims=True) * tangents
    lost = np.linalg.norm(across, axis=-1, keepdims=True) < 1e-3
    return unit(np.where(lost, any_across(tangents), across))


def sweep(rings: Rings, sides: int, colors: NDArray[np.uint8]) -> Geometry:
    """The closed surface around the rings, with flat caps at both ends of every ribbon.

    Faces are counter-clockwise from outside.

    Args:
        rings: The cross-sections.
        sides: Points around a cross-section, a multiple of four.
        colors: (n, 4) of all atoms.
    """
    points, before, after = _cross_sections(rings.shapes, sides)
    up = np.cross(rings.tangents, rings.sides)
    basis = np.stack([rings.sides, up], axis=1)  # (s, 2, 3)
    vertices = rings.centers[:, None] + points @ basis  # (s, m, 3)
    leaving, arriving = before @ basis, after @ basis

    a = np.flatnonzero(~rings.starts[1:])
    b = a + 1

    def around(values: NDArray) -> NDArray:
        return np.roll(values, -1, axis=1)

    # The quad between point k and k + 1 of two rings: low, low next, high next, high.
    corners = (vertices[a], around(vertices)[a], around(vertices)[b], vertices[b])
    normals = (leaving[a], arriving[a], arriving[b], leaving[b])
    owners = tuple(np.broadcast_to(rings.owners[r][:, None], (len(r), sides)) for r in (a, a, b, b))

    def triangles(parts: tuple[NDArray, ...]) -> NDArray:
        low, low_next, high_next, high = parts
        pair = ((low, low_next, high), (low_next, high_next, high))
        stacked = np.stack([np.stack(t, axis=2) for t in pair], axis=2)
        return stacked.reshape(-1, 3, *stacked.shape[4:])

    ends = _caps(rings, vertices)
    ids = np.concatenate([triangles(owners), ends[2]]).astype(np.int32)
    return Geometry(
        triangles=np.concatenate([triangles(corners), ends[0]]).astype(np.float32),
        triangle_normals=np.concatenate([triangles(normals), ends[1]]).astype(np.float32),
        triangle_colors=colors[ids],
        triangle_ids=ids,
    )


def _cross_sections(shapes: NDArray, sides: int) -> tuple[NDArray, NDArray, NDArray]:
    """Points (s, m, 2) and, for the edge from each to the next, the normals at both its ends."""
    quarter = sides // 4
    corner = np.repeat(np.arange(4), quarter)
    angle = (np.tile((np.arange(quarter) + 0.5) / quarter, 4) + corner) * (np.pi / 2)
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])[corner]
    inner = shapes[:, :2] - shapes[:, 2:]  # (s, 2) to the corners' centres
    round_ = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = signs * inner[:, None] + shapes[:, None, 2:] * round_

    # Straight edges, from one corner to the next, have the normal of their plane; on a circle,
    # where nothing is straight, that of the circle.
    flatness = np.clip(inner / np.maximum(shapes[:, 2:], 1e-6), 0.0, 1.0)[:, [0, 1, 0, 1]]
    before = np.tile(angle, (len(shapes), 1))
    after = np.roll(before, -1, axis=1)
    after[:, -1] += 2 * np.pi
    last = np.arange(4) * quarter + quarter - 1  # the points where straight edges begin
    plane = (np.arange(4) + 1) * (np.pi / 2)
    before[:, last] += flatness * (plane - before[:, last])
    after[:, last] += flatness * (plane - after[:, last])

    def normal(a: NDArray) -> NDArray:
        return np.stack([np.cos(a), np.sin(a)], axis=-1)

    return points, normal(before), normal(after)


def _caps(rings: Rings, vertices: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Vertices, normals (c, 3, 3) and owners (c, 3) of the fans that close the ribbons."""
    sides = vertices.shape[1]
    middle = np.arange(1, sides - 1)
    found = []
    for which, sign in ((rings.starts, -1.0), (ends_of(rings.starts), 1.0)):
        ring = np.flatnonzero(which)
        order = (middle, middle + 1) if sign > 0 else (middle + 1, middle)
        fan = np.stack([np.zeros_like(middle), *order], axis=-1)
        normal = sign * rings.tangents[ring]
        found.append(
            (
                vertices[ring][:, fan].reshape(-1, 3, 3),
                np.repeat(normal, len(fan), axis=0)[:, None].repeat(3, axis=1),
                np.repeat(rings.owners[ring], len(fan))[:, None].repeat(3, axis=1),
            )
        )
    return tuple(np.concatenate(parts) for parts in zip(*found, strict=True))  # type: ignore[return-value]
