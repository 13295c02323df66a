"""Levels of detail: the spheres of a structure merged into fewer, larger ones.

Each level has a quarter as many spheres as the one before. Atoms are grouped by halving the set
along the longest side of its box, again and again, so that groups are compact, equally large, and
nested from level to level; nothing is random. A merged sphere is the ball with its members' radius
of gyration; one factor for all radii then makes the mean area of the shadows that the level throws
equal to that of the atoms: the outline, and with it the volume, is kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.generate import fibonacci_sphere
from scuro.scene.geometry import Geometry

HALVINGS = 2
"""Halvings between one level and the next: each has a quarter as many spheres."""
COARSEST = 16
"""No level has fewer spheres than this, unless the structure itself has."""
DIRECTIONS = 5
"""From how many directions outlines are compared."""


@dataclass(frozen=True, eq=False)
class Level:
    """One level of detail of a structure."""

    spheres: NDArray[np.float32]
    """(n, 4)"""
    member: NDArray[np.int32]
    """(atoms,) which of the level's spheres each atom was merged into."""
    size: float
    """Mean radius of the level's spheres: the detail it can show, ångström."""


def levels_of_detail(spheres: NDArray[np.float32]) -> tuple[Level, ...]:
    """All levels, the atoms themselves (level 0) first.

    Args:
        spheres: (n, 4) centre and radius of the atoms.
    """
    atoms = np.ascontiguousarray(spheres, np.float32)
    each = np.arange(len(atoms), dtype=np.int32)
    found = [Level(atoms, each, float(atoms[:, 3].mean()))]
    area = shadow_area(atoms)
    depth = max(int(np.log2(max(len(atoms), 1))) - HALVINGS, 0)
    groups = halve(atoms[:, :3], depth)
    for kept in range(depth, int(np.log2(COARSEST)) - 1, -HALVINGS):
        member = groups >> (depth - kept)
        merged = merge(atoms, member)
        merged[:, 3] *= _radius_factor(merged, area)
        found.append(Level(merged, member, float(merged[:, 3].mean())))
    return tuple(found)


def level_geometry(geometry: Geometry, level: Level) -> Geometry:
    """The geometry with its spheres replaced by a level's.

    Merged spheres take the mean colour of their members, and the id of one of them.
    """
    count = len(level.spheres)
    members = np.bincount(level.member, minlength=count)
    colors = np.stack(
        [
            np.bincount(level.member, weights=geometry.sphere_colors[:, c], minlength=count)
            for c in range(4)
        ],
        axis=1,
    )
    first = np.zeros(count, np.int32)
    first[level.member[::-1]] = geometry.sphere_ids[::-1]
    return Geometry(
        spheres=level.spheres,
        sphere_colors=np.round(colors / members[:, None]).astype(np.uint8),
        sphere_ids=first,
    )


def halve(points: NDArray[np.float32], times: int) -> NDArray[np.int32]:
    """Group (n,) of each point, 0 … 2^times - 1, by halving along the longest side.

    The first k bits of a group's number are its group after k halvings. Points (n, 3) must be at
    least 2^times.
    """
    group = np.zeros(len(points), np.int64)
    for _ in range(times):
        count = int(group.max()) + 1
        order = np.argsort(group, kind="stable")
        starts = np.searchsorted(group[order], np.arange(count))
        low = np.minimum.reduceat(points[order], starts)
        high = np.maximum.reduceat(points[order], starts)
        axis = (high - low).argmax(axis=1)
        along = points[np.arange(len(points)), axis[group]]
        order = np.lexsort((along, group))
        sizes = np.diff(starts, append=len(points))
        rank = np.empty(len(points), np.int64)
        rank[order] = np.arange(len(points)) - np.repeat(starts, sizes)
        group = 2 * group + (rank >= (sizes // 2)[group])
    return group.astype(np.int32)


def merge(atoms: NDArray[np.float32], member: NDArray[np.int32]) -> NDArray[np.float32]:
    """(m, 4) balls with the centroid and the radius of gyration of their members' balls.

    A uniform ball of radius R has a squared radius of gyration of 3/5 R²; balls merged add their
    own to the spread of their centres.
    """
    points, radii = atoms[:, :3].astype(np.float64), atoms[:, 3].astype(np.float64)
    centers = _means(points, member)
    spread = ((points - centers[member]) ** 2).sum(axis=1) + 0.6 * radii**2
    count = np.bincount(member)
    gyration2 = np.bincount(member, weights=spread) / count
    return np.concatenate([centers, np.sqrt(gyration2 / 0.6)[:, None]], axis=1).astype(np.float32)


def shadow_area(spheres: NDArray[np.float32]) -> float:
    """Mean area of the shadows that a set of spheres throws along several directions.

    For a convex shape it is a quarter of the surface (Cauchy).
    """
    directions = fibonacci_sphere(2 * DIRECTIONS)[:DIRECTIONS]
    radius = spheres[:, 3]
    pixel = max(float(np.median(radius)) / 3, float(np.ptp(spheres[:, :3], axis=0).max()) / 400)
    areas = []
    for direction in directions:
        across = np.cross(direction, np.roll(direction, 1))
        across /= np.linalg.norm(across)
        plane = np.stack([across, np.cross(direction, across)], axis=1)
        areas.append(_disc_union(spheres[:, :3].astype(np.float64) @ plane, radius, pixel))
    return float(np.mean(areas))


def _disc_union(centers: NDArray, radii: NDArray, pixel: float) -> float:
    """Area covered by discs, counted on a raster; (n, 2) centres and (n,) radii."""
    low = (centers - radii[:, None]).min(axis=0) - pixel
    size = np.ceil(((centers + radii[:, None]).max(axis=0) - low) / pixel).astype(int) + 2
    covered = np.zeros(size, bool)
    # discs of equal raster radius share one stencil of offsets
    steps = np.maximum(np.round(radii / pixel * 2).astype(int), 1)
    for step in np.unique(steps):
        reach = step / 2
        span = np.arange(-int(np.ceil(reach)), int(np.ceil(reach)) + 1)
        dx, dy = np.meshgrid(span, span, indexing="ij")
        inside = dx**2 + dy**2 <= reach**2
        cells = np.round((centers[steps == step] - low) / pixel).astype(int)
        x = np.clip(cells[:, :1] + dx[inside], 0, size[0] - 1)
        y = np.clip(cells[:, 1:] + dy[inside], 0, size[1] - 1)
        covered[x, y] = True
    return float(covered.sum()) * pixel**2


def _radius_factor(spheres: NDArray[np.float32], area: float) -> float:
    """Factor for all radii that gives the spheres' shadows a mean area, by the secant method."""
    factors = [1.0, 0.85]
    areas = [shadow_area(spheres), _scaled_area(spheres, 0.85)]
    while len(areas) < 5 and abs(areas[-1] / area - 1) > 2e-3:
        slope = (areas[-1] - areas[-2]) / (factors[-1] - factors[-2])
        if slope <= 0:
            break
        factors.append(float(np.clip(factors[-1] + (area - areas[-1]) / slope, 0.4, 2.0)))
        areas.append(_scaled_area(spheres, factors[-1]))
    return factors[int(np.argmin(np.abs(np.array(areas) - area)))]


def _scaled_area(spheres: NDArray[np.float32], factor: float) -> float:
    return shadow_area(spheres * np.array([1, 1, 1, factor], np.float32))


def _means(points: NDArray[np.float64], which: NDArray) -> NDArray[np.float64]:
    """(m, 3) mean of the points of each cluster."""
    count = np.bincount(which)
    return (
        np.stack([np.bincount(which, weights=points[:, c]) for c in range(3)], axis=1)
        / (count[:, None])
    )
