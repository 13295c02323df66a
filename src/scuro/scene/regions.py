"""The levels of a scene's hierarchy, and the region that each element belongs to at each level.

Level by level a scene is divided more finely: compartments, compartments within them, ingredients,
instances, then parts of an instance (chains, residues or any selections). Every level refines the
one before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body

BY_OBJECT, BY_INSTANCE, BY_GROUP = range(3)
"""What tells the regions of a level apart; as in passes/semantic/regions.wgsl."""


@dataclass(frozen=True, eq=False)
class Division:
    """One way of dividing the elements (atoms) of a body."""

    name: str
    """What its groups are: chains, residues …"""
    group: NDArray[np.int32]
    """(elements,) the group of each element id."""
    names: tuple[str, ...] = ()
    """What each group is called."""


@dataclass(frozen=True, eq=False)
class Divided:
    """A body and how it is divided further than into instances."""

    body: Body
    divisions: tuple[Division, ...] = ()
    """Coarse to fine."""
    fibre: bool = False
    """Whether element ids number separate pieces (curves): they are its instances."""
    painted: bool = False
    """Whether its colour is that of its place in the hierarchy."""


@dataclass(frozen=True)
class Level:
    """One way of dividing the scene."""

    name: str
    kind: int
    """BY_OBJECT, BY_INSTANCE or BY_GROUP."""
    division: int = 0
    """Which table of labels (BY_OBJECT) or of groups (BY_GROUP)."""
    depth: int = 0
    """How many steps below the root of the tree: for colours."""


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """All levels of a scene, coarse to fine, and the tables behind them."""

    levels: tuple[Level, ...]
    labels: NDArray[np.uint32]
    """(k, objects): the region of each object in each of the BY_OBJECT levels."""
    ranges: NDArray[np.uint32]
    """(k, objects, 2): first and end of the run of objects around each that share its region."""
    names: tuple[tuple[str, ...], ...]
    """For each BY_OBJECT level, the path of each region joined by ``/``."""
    groups: NDArray[np.uint32]
    """All groups of all bodies, one after the other."""
    offsets: NDArray[np.uint32]
    """(divisions, objects): where a body's groups begin in ``groups``; all ones for none."""
    group_names: tuple[tuple[tuple[str, ...], ...], ...]
    """For each division and object what its groups are called, empty where nothing is known."""
    fibre: NDArray[np.uint32]
    """(objects,) where element ids number the instances, 1 + the number of the object's path; 0
    elsewhere."""
    paths: tuple[tuple[str, ...], ...]
    """For each object its place in the tree, root first, its own name last."""
    painted: NDArray[np.bool_]
    """(objects,) whether it is coloured by that place."""


NO_GROUPS = np.uint32(0xFFFFFFFF)


def hierarchy_of(divided: Sequence[Divided]) -> Hierarchy:
    """The hierarchy of bodies, from their paths and divisions.

    Levels that divide nothing further are left out; there is always at least one level.
    """
    paths = [d.body.path or (d.body.name,) for d in divided]
    places = {path: number for number, path in enumerate(dict.fromkeys(paths))}
    fibres = [d.fibre * (1 + places[p]) for d, p in zip(divided, paths, strict=True)]
    levels: list[Level] = []
    labels: list[NDArray[np.uint32]] = []
    names: list[tuple[str, ...]] = []
    deepest = max((len(p) for p in paths), default=1)
    for depth in range(1, deepest + 1):
        # compartments first; the ingredients' own names come last, all at once
        inner = depth < deepest
        cut = [p[: min(depth + 1, len(p) - 1)] if inner else p for p in paths]
        found = list(dict.fromkeys(cut))
        label = np.array([found.index(c) for c in cut], np.uint32)
        if len(found) < 2 or (labels and _same(labels[-1], label)):
            continue
        name = f"compartment {depth}" if inner else "ingredient"
        levels.append(Level(name, BY_OBJECT, len(labels), depth if inner else deepest - 1))
        labels.append(label)
        names.append(tuple("/".join(c[1:]) or c[0] for c in found))
    if any(d.body.instances > 1 or d.fibre for d in divided):
        levels.append(Level("instance", BY_INSTANCE, depth=deepest - 1))
    divisions = max((len(d.divisions) for d in divided), default=0)
    offsets = np.full((max(divisions, 1), max(len(divided), 1)), NO_GROUPS, np.uint32)
    groups: list[NDArray[np.uint32]] = []
    total = 0
    for k in range(divisions):
        deeper = [(n, d.divisions[k]) for n, d in enumerate(divided) if k < len(d.divisions)]
        levels.append(Level(deeper[0][1].name, BY_GROUP, k, deepest - 1))
        for number, division in deeper:
            offsets[k, number] = total
            groups.append(division.group.astype(np.uint32))
            total += len(division.group)
    if not levels:
        levels.append(Level("object", BY_INSTANCE))
    labels = labels or [np.zeros(max(len(divided), 1), np.uint32)]
    return Hierarchy(
        levels=tuple(levels),
        labels=np.array(labels, np.uint32),
        ranges=np.stack([_runs(row) for row in labels]),
        names=tuple(names),
        groups=np.concatenate([*groups, np.zeros(1, np.uint32)]),
        offsets=offsets,
        group_names=tuple(
            tuple(d.divisions[k].names if k < len(d.divisions) else () for d in divided)
            for k in range(divisions)
        ),
        fibre=np.array(fibres or [0], np.uint32),
        paths=tuple(paths),
        painted=np.array([d.painted for d in divided] or [False]),
    )


def _runs(labels: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """(n, 2) first and end of the run of equal labels around each entry."""
    edges = np.flatnonzero(np.diff(labels, prepend=labels[0] + 1, append=labels[-1] + 1))
    run = np.searchsorted(edges, np.arange(len(labels)), side="right") - 1
    return np.stack([edges[run], edges[run + 1]], axis=1).astype(np.uint32)


def _same(one: NDArray, other: NDArray) -> bool:
    """Whether two labellings divide alike (both number regions by first appearance)."""
    return bool((one == other).all())


def level_at(distance: float, thresholds: Sequence[float]) -> tuple[int, float]:
    """Level t and how far the camera is on the way to t + 1 (0 to 1); Koch's Algorithm 1.

    Args:
        distance: From the camera to the middle of the scene (not to each object, or objects at
            different distances would lie on different levels: thesis, Figure 3.5).
        thresholds: One distance a level, falling: the camera is on level t at the t-th.
    """
    t = int(np.searchsorted(-np.asarray(thresholds), -distance, side="right")) - 1
    if t < 0:
        return 0, 0.0
    if t >= len(thresholds) - 1:
        return len(thresholds) - 1, 0.0
    near, far = thresholds[t + 1], thresholds[t]
    return t, float((far - distance) / (far - near))
