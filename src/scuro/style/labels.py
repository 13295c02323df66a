"""Labels that face the viewer and do not overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
) -> list[tuple[int, tuple[float, float]]]:
    """Corners for labels, the nearest first; those for which there is no room are left out.

    Each label is tried to the right of its place, then left, above and below.

    Args:
        places: (n, 3) pixel x and y, and depth.
        extents: Width and height of each label.
        size: Of the picture.
        order: Indices in the order in which labels take their room, instead of by depth.
        centered: Whether a label is tried on its place before all.

    Returns:
        Index of the label and its upper left corner.
    """
    taken: list[tuple[float, float, float, float]] = []
    found = []
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
            if inside and not any(_overlap(box, other) for other in taken):
                taken.append(box)
                found.append((int(index), (left, top)))
                break
    return found


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
