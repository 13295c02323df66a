"""Labels that face the viewer and do not overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.style.marks import Rect

_OFFSET = 8.0
"""Pixels between a place and its label."""


@dataclass(frozen=True)
class Label:
    """Words at a place."""

    text: str
    position: tuple[float, float, float]
    """World position."""


def placed(
    places: NDArray,
    extents: Sequence[tuple[float, float]],
    size: tuple[float, float],
    *,
    order: NDArray | None = None,
    centered: bool = False,
    most: int | None = None,
    taken: Sequence[Rect] = (),
) -> list[tuple[int, tuple[float, float]]]:
    """Corners for labels, the nearest first; those for which there is no room are left out.

    Each label is tried to the right of its place, then left, above and below.

    Args:
        places: (n, 3) pixel x and y, and depth.
        extents: Width and height of each label.
        size: Of the picture.
        order: Indices in the order in which labels take their room, instead of by depth.
        centered: Whether a label is tried on its place before all.
        most: How many labels at most.
        taken: Where no label may lie.

    Returns:
        Index of the label and its upper left corner.
    """
    found: list[tuple[int, tuple[float, float]]] = []
    boxes = np.zeros((len(taken) + len(places), 4))
    boxes[: len(taken)] = np.array(taken).reshape(-1, 4)
    count = len(taken)
    for index in np.argsort(places[:, 2], kind="stable") if order is None else order:
        x, y, depth = places[index]
        if not depth > 0:
            continue
        w, h = extents[index]
        for left, top in (
            *([(x - w / 2, y - h / 2)] if centered else []),
            (x + _OFFSET, y - h / 2),
            (x - _OFFSET - w, y - h / 2),
            (x - w / 2, y - _OFFSET - h),
            (x - w / 2, y + _OFFSET),
        ):
            box = (left, top, left + w, top + h)
            inside = left >= 0 and top >= 0 and box[2] <= size[0] and box[3] <= size[1]
            if inside and not overlapping(boxes[:count], np.array(box)).any():
                boxes[count], count = box, count + 1
                found.append((int(index), (float(left), float(top))))
                break
        if most is not None and len(found) >= most:
            break
    return found


def overlapping(boxes: NDArray, box: NDArray) -> NDArray[np.bool_]:
    """Which rectangles (…, 4) share room with another (4,), or row by row with (…, 4)."""
    return (
        (boxes[..., 0] < box[..., 2])
        & (box[..., 0] < boxes[..., 2])
        & (boxes[..., 1] < box[..., 3])
        & (box[..., 1] < boxes[..., 3])
    )
