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

from scuro.scene.sphere import fibonacci_sphere

HALVINGS = 2
"""Halvings between one level and the next: each has a quarter as many spheres."""
COARSEST = 4
"""No level has fewer spheres than this, unless the structure itself has."""
SIZES = 8
"""Sizes of discs that outlines are drawn with."""
DIRECTIONS = 3
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

    @property
    def member_of_each(self) -> NDArray[np.int32]:
        """(n,) for each sphere one of the atoms that it stands for."""
        first = np.zeros(len(self.spheres), np.int32)
        first[self.member[::-1]] = np.arange(len(self.member) - 1, -1, -1, dtype=np.int32)
        return first


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
    pixel = max(float(np.median(radius)) / 2.5, float(np.ptp(spheres[:, :3], axis=0).max()) / 400)
    areas = []
    for direction in directions:
        across = np.cross(direction, np.roll(direction, 1))
        across /= np.linalg.norm(across)
        plane = np.stack([across, np.cross(direction, across)], axis=1)
        areas.append(_disc_union(spheres[:, :3].astype(np.float64) @ plane, radius, pixel))
    return float(np.mean(areas))


def _disc_union(centers: NDArray, radii: NDArray, pixel: float) -> float:
    """Area covered by discs, counted on a raster; (n, 2) centres and (n,) radii."""
    low = (centers - radii[:, None]).min(axis=0) - 3 * pixel
    size = np.ceil(((centers + radii[:, None]).max(axis=0) - low) / pixel).astype(int) + 6
    covered = np.zeros(size, bool)
    # discs of about one size share a stencil of offsets
    classes = np.unique(np.geomspace(radii.min(), radii.max() + 1e-6, SIZES))
    nearest = np.abs(classes[:, None] - radii).argmin(axis=0)
    for number, radius in enumerate(classes):
        here = nearest == number
        if not here.any():
            continue
        reach = radius / pixel
        span = np.arange(-int(np.ceil(reach)), int(np.ceil(reach)) + 1)
        inside = span[:, None] ** 2 + span**2 <= reach**2
        dx, dy = (d[inside] for d in np.meshgrid(span, span))
        cells = np.round((centers[here] - low) / pixel).astype(np.int32)
        covered[cells[:, :1] + dx, cells[:, 1:] + dy] = True
    return float(covered.sum()) * pixel**2


def _radius_factor(spheres: NDArray[np.float32], area: float) -> float:
    """Factor for all radii that gives the spheres' shadows a mean area, by the secant method."""
    # areas grow about as the factor to the power 1.2, since shadows overlap
    factors = [0.85]
    areas = [_scaled_area(spheres, 0.85)]
    while len(areas) < 4 and abs(areas[-1] / area - 1) > 0.01:
        power = 1.2
        if len(areas) > 1 and factors[-1] != factors[-2]:
            power = np.log(areas[-1] / areas[-2]) / np.log(factors[-1] / factors[-2])
        step = (area / areas[-1]) ** (1 / max(power, 0.3))
        factors.append(float(np.clip(factors[-1] * step, 0.4, 2.0)))
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
