"""Names of the regions in view, level by level, after Kouřil et al. (2018, "Labels on levels").

Each region that takes up enough of the picture gets its name where it is widest; of the many
instances of an ingredient the largest in view stands for all. Names of level t fade out as those of
level t + 1 fade in.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.scene.regions import BY_GROUP, BY_OBJECT, NO_GROUPS, Hierarchy, Level
from scuro.style.labels import placed

SMALLEST = 0.002
"""Share of the picture below which a region gets no name."""
OVER = (0.35, 0.65)
"""Names go over from t to t + 1 between these shares of the way: in between two lie on each other.
"""
_NOTHING = 0xFFFFFFFF
_SIDES = ("surface", "interior")
"""What says nothing without the name of its compartment."""
_INK, _HALO = (24, 24, 28), (255, 255, 255)


@dataclass(frozen=True)
class RegionLabel:
    """A name at a pixel."""

    text: str
    x: float
    y: float
    area: float
    """Share of the picture that the region takes up."""
    opacity: float


def region_labels(
    ids: NDArray[np.uint32], hierarchy: Hierarchy, level: int, blend: float
) -> list[RegionLabel]:
    """The labels of a picture, the largest region first.

    Args:
        ids: (h, w, 4) element, instance and object of each pixel, as the G-buffer has them.
        hierarchy: The scene's.
        level: t.
        blend: How far the camera is on the way from t to t + 1, 0 to 1.
    """
    last = len(hierarchy.levels) - 1
    best: dict[str, RegionLabel] = {}
    over = min(max((blend - OVER[0]) / (OVER[1] - OVER[0]), 0.0), 1.0)
    for index, weight in ((level, 1.0 - over), (level + 1, over)):
        if weight <= 0 or index > last:
            continue
        for label in _of_level(ids, hierarchy, hierarchy.levels[index], weight):
            before = best.get(label.text)
            if before is None:
                best[label.text] = label
            else:  # a name of both levels stays
                larger = max(before, label, key=lambda found: found.area)
                opacity = min(before.opacity + label.opacity, 1.0)
                best[label.text] = RegionLabel(
                    larger.text, larger.x, larger.y, larger.area, opacity
                )
    return sorted(best.values(), key=lambda label: -label.area)


def _of_level(
    ids: NDArray[np.uint32], hierarchy: Hierarchy, level: Level, weight: float
) -> list[RegionLabel]:
    """The largest region of each name at one level."""
    from scipy import ndimage

    numbers = region_numbers(ids, hierarchy, level)
    kinds, region = np.unique(numbers, return_inverse=True)
    region = region.reshape(numbers.shape)
    # how deep inside its region each pixel lies; the picture's edge is an edge, too
    edge = np.zeros(region.shape, bool)
    edge[:, :-1] |= region[:, 1:] != region[:, :-1]
    edge[:-1] |= region[1:] != region[:-1]
    edge[[0, -1]] = edge[:, [0, -1]] = True
    inside = ndimage.distance_transform_edt(~edge)
    areas = np.bincount(region.ravel()) / region.size
    chosen = np.flatnonzero((kinds >= 0) & (areas >= SMALLEST))
    spots = ndimage.maximum_position(inside, region, chosen) if len(chosen) else []
    best: dict[str, RegionLabel] = {}
    for number, (y, x) in zip(chosen.tolist(), spots, strict=True):
        text = _name(ids[y, x], hierarchy, level)
        label = RegionLabel(text, x + 0.5, y + 0.5, float(areas[number]), weight)
        if text not in best or best[text].area < label.area:
            best[text] = label
    return list(best.values())


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
    numbers = instance << 24
    if level.kind == BY_GROUP:
        offset = hierarchy.offsets[level.division][thing]
        divided = there & (offset != NO_GROUPS)
        group = hierarchy.groups[np.where(divided, offset + element, 0)].astype(np.int64)
        numbers = np.where(divided, numbers + group + 1, numbers)
    numbers = np.where(fibre > 0, (fibre << 32 | element) + (1 << 60), numbers)
    return np.where(there, numbers, -1)


def _name(ids: NDArray[np.uint32], hierarchy: Hierarchy, level: Level) -> str:
    element, _, thing, _ = (int(v) for v in ids)
    path = hierarchy.paths[thing]
    if level.kind == BY_OBJECT:
        name = hierarchy.names[level.division][hierarchy.labels[level.division][thing]]
        *above, own = map(_readable, name.split("/"))
        return f"{above[-1]}, {own}" if above and own in _SIDES else own
    if level.kind == BY_GROUP:
        names = hierarchy.group_names[level.division][thing]
        offset = hierarchy.offsets[level.division][thing]
        if names and offset != NO_GROUPS:
            name = names[int(hierarchy.groups[offset + element])]
            return f"{_readable(path[-1])}, chain {name}" if level.name == "chain" else name
    return _readable(path[-1])


def _readable(name: str) -> str:
    """A node's name without cellPACK's version numbers and underscores."""
    return re.sub(r"(_\d+)+$", "", name).replace("_", " ").strip() or name


def with_labels(
    pixels: NDArray[np.uint8], labels: list[RegionLabel], scale: float, most: int
) -> NDArray[np.uint8]:
    """The picture with names on it: the largest regions first, none over another.

    Args:
        pixels: (h, w, 4).
        labels: In pixels of the buffer they were found in.
        scale: From those to the picture's.
        most: How many at most.
    """
    from PIL import Image, ImageDraw, ImageFont

    height, width = pixels.shape[:2]
    size = max(10, height // 36)
    halo = max(1, size // 8)
    font = ImageFont.load_default(size)
    boxes = [font.getbbox(label.text, stroke_width=halo) for label in labels]
    extents = [(box[2] - box[0] + size / 2, box[3] - box[1] + size / 4) for box in boxes]
    places = np.array([(scale * label.x, scale * label.y, 1.0) for label in labels]).reshape(-1, 3)
    found = placed(places, extents, (width, height), order=np.arange(len(labels)), centered=True)
    overlay = Image.new("RGBA", (width, height), (*_HALO, 0))
    draw = ImageDraw.Draw(overlay)
    for index, (left, top) in found[:most]:
        alpha = round(255 * labels[index].opacity)
        box = boxes[index]
        corner = (left + size / 4 - box[0], top + size / 8 - box[1])
        draw.text(corner, labels[index].text, (*_INK, alpha), font,
                  stroke_width=halo, stroke_fill=(*_HALO, round(0.8 * alpha)))  # fmt: skip
    return np.asarray(Image.alpha_composite(Image.fromarray(pixels, "RGBA"), overlay))
