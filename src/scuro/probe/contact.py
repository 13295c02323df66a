"""The compiled inner loops of the probe: grid, first hit, sliding.

All of them are in this one file because numba's cache of a function does not notice that a function
of another file has changed. Points are (3,) arrays in double precision; a grid is the run of
arguments ``centers, radii, low, cell, shape, starts, items`` of :class:`scuro.probe.solver.Grid`.
"""
# numba compiles by the arguments' types: annotations would only repeat the text above
# mypy: disable-error-code="no-untyped-def"

from __future__ import annotations

import math

import numpy as np
from numba import njit

SLACK = 1e-6
"""Å kept free between the probe and the atoms: rounding never carries it in."""
_CONTACT = 4e-6
"""Å within which a sphere counts as touched."""
_MOST_TURNS = 64
"""Changes of direction an update may take; a hand's step takes a few."""
_MOST_TOUCHED = 12
_DONE = 1e-9
"""Å; a shorter way is none."""
_NEVER = 2.0
"""A share of a step that is beyond its end."""


@njit(cache=True)
def sort_spheres(centers, radii, low, cell, shape):
    counts = np.zeros(shape[0] * shape[1] * shape[2] + 1, np.int64)
    items = np.zeros(0, np.int32)
    for fill in range(2):
        for s in range(len(radii)):
            first = np.empty(3, np.int64)
            last = np.empty(3, np.int64)
            for a in range(3):
                first[a] = max(0, int((centers[s, a] - radii[s] - low[a]) / cell))
                last[a] = min(shape[a] - 1, int((centers[s, a] + radii[s] - low[a]) / cell))
            for i in range(first[0], last[0] + 1):
                for j in range(first[1], last[1] + 1):
                    for k in range(first[2], last[2] + 1):
                        index = (i * shape[1] + j) * shape[2] + k
                        if fill == 0:
                            counts[index + 1] += 1
                        else:
                            items[counts[index]] = s
                            counts[index] += 1
        if fill == 0:
            counts = np.cumsum(counts)
            items = np.zeros(counts[-1], np.int32)
    # filling has moved every start to the next one's place
    counts[1:] = counts[:-1].copy()
    counts[0] = 0
    return counts, items


@njit(cache=True)
def first_hit(start, step, centers, radii, low, cell, shape, starts, items, slack):
    """Share of ``step`` (3,) from ``start`` (3,) at which a sphere grown by ``slack`` is met.

    A sphere that ``start`` lies on or in counts only if the step leads farther in. 2 if none.
    """
    begin, end = 0.0, 1.0
    for a in range(3):
        high = low[a] + shape[a] * cell
        if step[a] == 0.0:
            if start[a] < low[a] or start[a] > high:
                return _NEVER
            continue
        t0, t1 = (low[a] - start[a]) / step[a], (high - start[a]) / step[a]
        begin, end = max(begin, min(t0, t1)), min(end, max(t0, t1))
    if begin > end:
        return _NEVER
    at = np.empty(3, np.int64)
    way = np.empty(3, np.int64)
    after = np.empty(3)
    stride = np.empty(3)
    for a in range(3):
        place = (start[a] + begin * step[a] - low[a]) / cell
        at[a] = min(max(math.floor(place), 0), shape[a] - 1)
        way[a] = 1 if step[a] > 0 else -1
        if step[a] == 0.0:
            after[a], stride[a] = np.inf, np.inf
        else:
            border = low[a] + (at[a] + (1 if step[a] > 0 else 0)) * cell
            after[a] = (border - start[a]) / step[a]
            stride[a] = cell / abs(step[a])
    best = _NEVER
    while True:
        index = (at[0] * shape[1] + at[1]) * shape[2] + at[2]
        for n in range(starts[index], starts[index + 1]):
            best = min(best, _sphere_hit(start, step, centers[items[n]], radii[items[n]] + slack))
        axis = 0
        if after[1] < after[axis]:
            axis = 1
        if after[2] < after[axis]:
            axis = 2
        # what was met lies before the next cell, or the way ends here
        if best <= after[axis] or after[axis] > end:
            return best
        at[axis] += way[axis]
        if at[axis] < 0 or at[axis] >= shape[axis]:
            return best
        after[axis] += stride[axis]


@njit(cache=True)
def _sphere_hit(start, step, center, radius):
    x, y, z = start[0] - center[0], start[1] - center[1], start[2] - center[2]
    toward = x * step[0] + y * step[1] + z * step[2]
    length = step[0] ** 2 + step[1] ** 2 + step[2] ** 2
    # a way along the tangent, but for rounding, goes in by a part in 1e18 only
    if toward >= -1e-9 * radius * math.sqrt(length):
        return _NEVER
    outside = x * x + y * y + z * z - radius * radius
    if outside <= 0.0:
        return 0.0
    root = toward * toward - length * outside
    if root < 0.0:
        return _NEVER
    # the form without cancellation
    share = outside / (-toward + math.sqrt(root))
    return share if share <= 1.0 else _NEVER


@njit(cache=True)
def touching(point, centers, radii, low, cell, shape, starts, items, reach, found):
    """Fill ``found`` with the spheres whose surface is within ``reach``; how many there are."""
    count = 0
    at = np.empty(3, np.int64)
    for a in range(3):
        at[a] = math.floor((point[a] - low[a]) / cell)
        if at[a] < 0 or at[a] >= shape[a]:
            return 0
    index = (at[0] * shape[1] + at[1]) * shape[2] + at[2]
    for n in range(starts[index], starts[index + 1]):
        s = items[n]
        away = 0.0
        for a in range(3):
            away += (point[a] - centers[s, a]) ** 2
        if away <= (radii[s] + reach) ** 2 and count < len(found):
            found[count] = s
            count += 1
    return count


@njit(cache=True)
def move(position, target, centers, radii, low, cell, shape, starts, items):
    found = np.empty(_MOST_TOUCHED, np.int64)
    normals = np.empty((_MOST_TOUCHED, 3))
    for _ in range(_MOST_TURNS):
        wanted = target - position
        count = touching(position, centers, radii, low, cell, shape, starts, items, _CONTACT, found)
        for n in range(count):
            normal = position - centers[found[n]]
            normals[n] = normal / math.sqrt(normal @ normal)
        step = _allowed(wanted, normals[:count])
        if step @ step < _DONE * _DONE:
            break
        share = first_hit(position, step, centers, radii, low, cell, shape, starts, items, SLACK)
        position = position + min(share, 1.0) * step
        position = _pushed_out(position, centers, radii, low, cell, shape, starts, items, found)
    return position


@njit(cache=True)
def _pushed_out(position, centers, radii, low, cell, shape, starts, items, found):
    """Undo what rounding took of the slack (a few ulps, never more)."""
    count = touching(position, centers, radii, low, cell, shape, starts, items, SLACK, found)
    for n in range(count):
        normal = position - centers[found[n]]
        length = math.sqrt(normal @ normal)
        missing = radii[found[n]] + SLACK - length
        if missing > 0:
            position = position + normal * (missing / length)
    return position


@njit(cache=True)
def _allowed(wanted, normals):
    """The vector nearest to ``wanted`` that leads into none of the touched spheres.

    Its projection on the cone n·v >= 0: the best of the free vector, those along one tangent plane
    or along two planes' edge, and rest (Karush-Kuhn-Tucker; in space no more than two planes can
    bind a vector that is not zero).
    """
    count = len(normals)
    best = np.zeros(3)
    worst = wanted @ wanted
    for i in range(-1, count):
        for j in range(i, count):
            if j == i:
                # i = j = -1: no plane; i = j: one
                candidate = wanted.copy()
                if i >= 0:
                    candidate -= (candidate @ normals[i]) * normals[i]
            elif i < 0:
                continue
            else:
                edge = np.cross(normals[i], normals[j])
                length = edge @ edge
                if length < 1e-12:
                    continue
                candidate = edge * ((wanted @ edge) / length)
            away = wanted - candidate
            loss = away @ away
            if loss < worst and _is_free(candidate, normals):
                best, worst = candidate, loss
    return best


@njit(cache=True)
def _is_free(vector, normals):
    least = -1e-9 * math.sqrt(vector @ vector)
    for n in range(len(normals)):  # noqa: SIM110 (numba has no all())
        if vector @ normals[n] < least:
            return False
    return True
