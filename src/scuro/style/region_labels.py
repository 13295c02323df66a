"""Names of the regions in view, level by level, after Kouřil et al. (2018, "Labels on levels").

Each region that takes up enough of the picture gets its name where it is widest; of the many
instances of an ingredient the largest in view stands for all. Names of level t fade out as those of
level t + 1 fade in. Each name hangs on a point of its region's surface, by which it is found again
in the next picture.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scuro.scene.camera import Camera
from scuro.scene.projection import project, unproject_all
from scuro.scene.regions import BY_GROUP, BY_OBJECT, NO_GROUPS, Hierarchy, Level

BY_ELEMENT = -1
"""Kind of a level on which every element is a region; semantic levels never go so deep."""
SMALLEST = 0.002
"""Share of the picture below which a region of many elements gets no name."""
SMALLEST_PART = 5e-5
"""The same of residues and atoms."""
OVER = (0.35, 0.65)
"""Names go over from t to t + 1 between these shares of the way: in between two lie on each other.
"""
KEPT = 0.35
"""A name keeps its point while it lies so deep inside its region, in shares of the deepest."""
MOST_FOUND = 500
"""Regions that are considered, the largest ones."""
_SAME_DEPTH = 0.02
"""A point is seen if what is seen in its place is no farther off than this share of its depth."""
_NOTHING = 0xFFFFFFFF
_SIDES = ("surface", "interior")
"""What says nothing without the name of its compartment."""


@dataclass(frozen=True)
class Survey:
    """What is where in a picture, coarsely."""

    ids: NDArray[np.uint32]
    """(h, w, 4) element, instance and object of each pixel, as the G-buffer has them."""
    depth: NDArray[np.float32]
    """(h, w) along the viewing direction."""
    camera: Camera

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self.ids.shape[1], self.ids.shape[0]


@dataclass(frozen=True)
class RegionLabel:
    """A name at a pixel."""

    text: str
    key: Hashable
    """What it is a name of: the same in every picture of the scene."""
    x: float
    y: float
    area: float
    """Share of the picture that the region takes up."""
    opacity: float
    anchor: tuple[float, float, float]
    """World position of the point that it hangs on."""
    element: tuple[int, int, int]
    """Element, instance and object at that point."""


class Namer:
    """Divides a scene's elements into regions and names them.

    Args:
        hierarchy: The scene's.
        atom_names: For objects that are molecules, the name of an atom by its number.
        masks: For objects that are molecules, which atoms may be named; all where there is none.
    """

    def __init__(
        self,
        hierarchy: Hierarchy,
        atom_names: Mapping[int, Sequence[str]] | None = None,
        masks: Mapping[int, NDArray[np.bool_]] | None = None,
    ) -> None:
        self.hierarchy = hierarchy
        self._atom_names = atom_names or {}
        self._masks = masks or {}

    @cached_property
    def _several(self) -> bool:
        """Whether a chain's name needs its molecule's beside it."""
        return len(set(self.hierarchy.paths)) > 1

    def numbers(self, ids: NDArray[np.uint32], level: Level) -> NDArray[np.int64]:
        """(h, w) a number for each region at a level, -1 where nothing is to be named."""
        if level.kind == BY_ELEMENT:
            element, instance, thing = (ids[..., k].astype(np.int64) for k in range(3))
            found = np.where(thing != _NOTHING, instance << 32 | element, -1)
        else:
            found = region_numbers(ids, self.hierarchy, level)
        for number, mask in self._masks.items():
            here = ids[..., 2] == number
            atom = np.minimum(ids[..., 0], len(mask) - 1)
            found = np.where(here & ~mask[atom], -1, found)
        return found

    def name(self, ids: NDArray[np.uint32], level: Level) -> str:
        """Of the region that a pixel belongs to."""
        element, _, thing, _ = (int(v) for v in ids)
        hierarchy = self.hierarchy
        path = hierarchy.paths[thing]
        if level.kind == BY_OBJECT:
            number = hierarchy.labels[level.division][thing]
            *above, own = map(_readable, hierarchy.names[level.division][number].split("/"))
            return f"{above[-1]}, {own}" if above and own in _SIDES else own
        if level.kind == BY_ELEMENT:
            names = self._atom_names.get(thing)
            return names[element] if names is not None and element < len(names) else ""
        if level.kind == BY_GROUP:
            names = hierarchy.group_names[level.division][thing]
            offset = hierarchy.offsets[level.division][thing]
            if names and offset != NO_GROUPS:
                name = names[int(hierarchy.groups[offset + element])]
                if level.name != "chain" or not name.strip():
                    return name.strip()
                return f"{_readable(path[-1])}, chain {name}" if self._several else f"chain {name}"
        return _readable(path[-1])


def region_labels(
    survey: Survey,
    namer: Namer,
    wanted: Sequence[tuple[Level, float]],
    keep: Mapping[Hashable, tuple[float, float, float]] | None = None,
) -> list[RegionLabel]:
    """The labels of a picture, the largest region first.

    Args:
        survey: Of the picture.
        namer: Of its scene.
        wanted: Levels and how opaque their names are: see :func:`levels_between`.
        keep: Points that names hung on before: they stay there while they can.
    """
    best: dict[Hashable, RegionLabel] = {}
    for level, weight in wanted:
        for label in _of_level(survey, namer, level, weight, keep or {}):
            before = best.get(label.key)
            if before is None:
                best[label.key] = label
            else:  # a name of both levels stays
                larger = max(before, label, key=lambda found: found.area)
                opacity = min(before.opacity + label.opacity, 1.0)
                best[label.key] = replace(larger, opacity=opacity)
    return sorted(best.values(), key=lambda label: -label.area)


def levels_between(hierarchy: Hierarchy, level: int, blend: float) -> list[tuple[Level, float]]:
    """Levels whose names show, and how opaque they are.

    Args:
        hierarchy: The scene's.
        level: t.
        blend: How far the camera is on the way from t to t + 1, 0 to 1.
    """
    over = min(max((blend - OVER[0]) / (OVER[1] - OVER[0]), 0.0), 1.0)
    last = len(hierarchy.levels) - 1
    both = ((level, 1.0 - over), (level + 1, over))
    return [(hierarchy.levels[n], weight) for n, weight in both if weight > 0 and n <= last]


def _of_level(
    survey: Survey,
    namer: Namer,
    level: Level,
    weight: float,
    keep: Mapping[Hashable, tuple[float, float, float]],
) -> list[RegionLabel]:
    """The largest region of each name at one level; of residues and atoms every one."""
    from scipy import ndimage

    ids = survey.ids
    numbers = namer.numbers(ids, level)
    kinds, region = np.unique(numbers, return_inverse=True)
    region = region.reshape(numbers.shape)
    # how deep inside its region each pixel lies; the picture's edge is an edge, too
    edge = np.zeros(region.shape, bool)
    edge[:, :-1] |= region[:, 1:] != region[:, :-1]
    edge[:-1] |= region[1:] != region[:-1]
    edge[[0, -1]] = edge[:, [0, -1]] = True
    inside = ndimage.distance_transform_edt(~edge)
    areas = np.bincount(region.ravel()) / region.size
    single = level.kind == BY_ELEMENT or level.name == "residue"
    smallest = SMALLEST_PART if single else SMALLEST
    chosen = np.flatnonzero((kinds >= 0) & (areas >= smallest))
    chosen = chosen[np.argsort(-areas[chosen], kind="stable")][:MOST_FOUND]
    spots = ndimage.maximum_position(inside, region, chosen) if len(chosen) else []
    best: dict[Hashable, tuple[int, tuple[int, int], float]] = {}
    texts: dict[Hashable, str] = {}
    for number, spot in zip(chosen.tolist(), spots, strict=True):
        text = namer.name(ids[spot], level)
        key: Hashable = (text, int(kinds[number])) if single else text
        if text and (key not in best or best[key][2] < areas[number]):
            best[key], texts[key] = (number, spot, float(areas[number])), text
    kept = _kept(survey, namer, level, keep, best, inside)
    places = np.array([kept.get(key, spot) for key, (_, spot, _) in best.items()], int)
    places = places.reshape(-1, 2)
    pixels = places[:, ::-1] + 0.5
    depths = survey.depth[places[:, 0], places[:, 1]].astype(float)
    anchors = unproject_all(survey.camera, pixels, survey.size, depths)
    made = []
    for (key, (_, _, area)), (y, x), anchor in zip(best.items(), places, anchors, strict=True):
        at = keep[key] if key in kept else tuple(anchor.tolist())
        element, instance, thing = (int(v) for v in ids[y, x, :3])
        made.append(
            RegionLabel(texts[key], key, x + 0.5, y + 0.5, area, weight, at,
                        (element, instance, thing))
        )  # fmt: skip
    return made


def _kept(
    survey: Survey,
    namer: Namer,
    level: Level,
    keep: Mapping[Hashable, tuple[float, float, float]],
    best: Mapping[Hashable, tuple[int, tuple[int, int], float]],
    inside: NDArray,
) -> dict[Hashable, tuple[int, int]]:
    """Names that stay on their points: row and column of each."""
    keys = [key for key in best if key in keep]
    if not keys:
        return {}
    width, height = survey.size
    seen = project(survey.camera, [keep[key] for key in keys], survey.size)
    found = {}
    for key, (x, y, depth) in zip(keys, seen, strict=True):
        if not (depth > 0 and 0 <= x < width and 0 <= y < height):
            continue
        place = int(y), int(x)
        near = abs(float(survey.depth[place]) - depth) <= _SAME_DEPTH * depth
        if not near or inside[place] < KEPT * float(inside[best[key][1]]):
            continue
        if namer.name(survey.ids[place], level) == (key[0] if isinstance(key, tuple) else key):
            found[key] = place
    return found


def region_numbers(
    ids: NDArray[np.uint32], hierarchy: Hierarchy, level: Level
) -> NDArray[np.int64]:
    """(h, w) a number for each region at a level, -1 where nothing is; as wgsl/region.wgsl."""
    element, instance, thing = (ids[..., k].astype(np.int64) for k in range(3))
    there = thing != _NOTHING
    thing = np.where(there, thing, 0)
    if level.kind == BY_OBJECT:
        labels = hierarchy.labels[level.division].astype(np.int64)
        return np.where(there, labels[thing], -1)
    fibre = hierarchy.fibre[thing].astype(np.int64)
    numbers = instance << 32
    if level.kind == BY_GROUP:
        offset = hierarchy.offsets[level.division][thing]
        divided = there & (offset != NO_GROUPS)
        group = hierarchy.groups[np.where(divided, offset + element, 0)].astype(np.int64)
        numbers = np.where(divided, numbers + group + 1, numbers)
    numbers = np.where(fibre > 0, (fibre << 32 | element) + (1 << 60), numbers)
    return np.where(there, numbers, -1)


def _readable(name: str) -> str:
    """A node's name without cellPACK's version numbers and underscores."""
    return re.sub(r"(_\d+)+$", "", name).replace("_", " ").strip() or name
