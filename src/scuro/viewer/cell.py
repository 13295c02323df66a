"""Which cell of a reservoir is under the pointer, and its property."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.kept import kept_with
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.reservoir import ReservoirItem
from scuro.style.reservoir_options import parse_slices
from scuro.viewer.navigate import Size, pixel_ray
from scuro.viewer.voxel import FAINT

MOST_CELLS = 2_000_000
"""Active cells beyond which a pointer's question would take too long."""
_TRIANGLES = np.array(
    [
        quad[corner]
        for axis in range(3)
        for side in (0, 1)
        for quad in [
            [
                sum(bit << a for a, bit in zip(others, bits, strict=True)) | side << axis
                for bits in ((0, 0), (1, 0), (1, 1), (0, 1))
            ]
            for others in [[a for a in range(3) if a != axis]]
        ]
        for corner in (0, 1, 2, 0, 2, 3)
    ]
).reshape(12, 3)
"""Corners of the triangles of a cell's six faces; bit 0 is i's side, bit 1 j's, bit 2 k's."""


def cell_at(
    item: ReservoirItem, clip: Clip, camera: Camera, pixel: Size, size: Size
) -> tuple[tuple[int, int, int], float, float] | None:
    """The first cell along the ray of a pixel that is shown.

    Cells whose boxes the ray meets are intersected exactly, each face as two triangles.

    Returns:
        One-based i, j, k as in the files, the property's value, and the depth along the viewing
        direction; ``None`` if the ray meets nothing, or in models of more than
        :data:`MOST_CELLS` cells.
    """
    grid = item.grid
    if grid.active_count > MOST_CELLS:
        return None
    origin, direction = pixel_ray(camera, pixel, size)
    low, high = _boxes(grid, item.exaggeration)
    with np.errstate(divide="ignore", invalid="ignore"):
        slabs = (np.stack([low, high]) - origin) / direction
    enter = np.nanmax(slabs.min(axis=0), axis=1)
    leave = np.nanmin(slabs.max(axis=0), axis=1)
    first, last = _kept(clip, origin, direction)
    met = np.flatnonzero((leave >= np.maximum(enter, first)) & (enter <= last) & _shown(item))
    if not len(met):
        return None
    cells = np.flatnonzero(grid.active)[met]
    corners = grid.to_world(grid.corners(cells), item.exaggeration).reshape(-1, 8, 3)
    enter, leave = _crossings(corners, origin, direction)
    seen = np.flatnonzero((leave >= max(first, 0.0)) & (enter <= last))
    if not len(seen):
        return None
    nearest = seen[np.argmin(np.maximum(enter[seen], first))]
    k, j, i = np.unravel_index(cells[nearest], grid.active.shape)
    t = max(float(enter[nearest]), first)
    forward = -camera.view_from_world()[2, :3]
    depth = float((origin + t * direction - np.asarray(camera.position)) @ forward)
    value = float(item.values()[met[nearest]])
    return (int(i) + 1, int(j) + 1, int(k) + 1), value, depth


@kept_with
def _boxes(grid: CornerPointGrid, exaggeration: float) -> tuple[NDArray, NDArray]:
    """Lowest and highest corners (n, 3) of the active cells' boxes."""
    corners = grid.to_world(grid.corners(), exaggeration).reshape(-1, 8, 3)
    return corners.min(axis=1), corners.max(axis=1)


def _kept(clip: Clip, origin: NDArray, direction: NDArray) -> tuple[float, float]:
    """The stretch of a ray that clipping keeps: it is convex."""
    first, last = -np.inf, np.inf
    for *normal, offset in clip.equations():
        slope, start = float(np.dot(normal, direction)), float(np.dot(normal, origin) + offset)
        if slope > 0:
            first = max(first, -start / slope)
        elif slope < 0:
            last = min(last, -start / slope)
        elif start < 0:
            return np.inf, -np.inf
    return first, last


def _shown(item: ReservoirItem) -> NDArray[np.bool_]:
    """(n_active,) which cells can be seen."""
    shown: NDArray[np.bool_] = item.chosen()
    if item.show == "volume":
        from scuro.style.reservoir import item_transfer

        return shown & (item_transfer(item).opacity(item.values()) > FAINT)
    if item.show == "slices":
        place = np.nonzero(item.grid.active)[::-1]
        layers = [place[a] + 1 == n for a, n in parse_slices(item.settings.slices)]
        return shown & np.any(layers, axis=0) if layers else shown & False
    return shown


def _crossings(corners: NDArray, origin: NDArray, direction: NDArray) -> tuple[NDArray, NDArray]:
    """Where a ray enters and leaves each cell (n, 8, 3) (Möller and Trumbore 1997)."""
    a, b, c = (corners[:, _TRIANGLES[:, n]] for n in range(3))
    u, v, s = b - a, c - a, origin - a
    across = np.cross(direction, v)
    along = np.cross(s, u)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / (u * across).sum(-1)
        p, q = (s * across).sum(-1) * inverse, (along @ direction) * inverse
        t = (v * along).sum(-1) * inverse
        inside = (p >= -1e-9) & (q >= -1e-9) & (p + q <= 1 + 1e-9)
    return np.where(inside, t, np.inf).min(axis=1), np.where(inside, t, -np.inf).max(axis=1)


def cell_sentence(item: ReservoirItem, index: tuple[int, int, int], value: float) -> str:
    """``REEK · cell 12, 40, 7 · SWAT 0.31``."""
    name = item.shown_property
    unit = item.grid.property_unit(name)
    return (
        f"{item.grid.name} · cell {', '.join(map(str, index))} · {name} {value:.4g} {unit}".strip()
    )
