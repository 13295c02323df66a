"""Which voxel of a volume is under the pointer, and its value."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.passes.volume.settings import VolumeSettings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip
from scuro.scene.items import VolumeItem
from scuro.style.transfer_choose import choose_transfer
from scuro.viewer.navigate import Size, pixel_ray

FAINT = 0.02
"""Opacity per voxel below which a ray passes on."""


def voxel_at(
    item: VolumeItem, settings: VolumeSettings, clip: Clip, camera: Camera, pixel: Size, size: Size
) -> tuple[tuple[int, int, int], float, float] | None:
    """The first voxel along the ray of a pixel that is not clear.

    The ray is walked in half voxels on the processor; the value is the file's own.

    Returns:
        Index i, j, k, the voxel's value, and its depth along the viewing direction; ``None`` if
        the ray meets nothing.
    """
    volume = item.volume
    origin, direction = pixel_ray(camera, pixel, size)
    if settings.planes.on:
        found = _on_plane(item, settings, clip, origin, direction)
        if found is not None or settings.planes.alone:
            return None if found is None else _voxel(item, *found, camera, origin, direction)
    with np.errstate(divide="ignore", invalid="ignore"):
        slabs = (volume.bounds - origin) / direction
    start = max(float(np.nanmax(slabs.min(axis=0))), 0.0)
    end = float(np.nanmin(slabs.max(axis=0)))
    if end <= start:
        return None
    t = np.arange(start, end, float(volume.spacing.min()) / 2)
    points = origin + t[:, None] * direction
    equations = clip.equations()
    kept = (points @ equations[:, :3].T + equations[:, 3] >= 0).all(axis=1)
    indices = np.c_[points, np.ones(len(points))] @ np.linalg.inv(volume.world_from_index).T
    cells = np.rint(indices[:, :3]).astype(int)
    nz, ny, nx = volume.values.shape
    kept &= ((cells >= 0) & (cells < (nx, ny, nz))).all(axis=1)
    cells, t = cells[kept], t[kept]
    values = volume.values[cells[:, 2], cells[:, 1], cells[:, 0]]
    seen = np.flatnonzero(_seen(item, settings, values))
    if not len(seen):
        return None
    return _voxel(item, cells[seen[0]], float(t[seen[0]]), camera, origin, direction)


def _voxel(
    item: VolumeItem, cell: NDArray, t: float, camera: Camera, origin: NDArray, direction: NDArray
) -> tuple[tuple[int, int, int], float, float]:
    """A cell's index and value, and the depth of a place on a ray."""
    i, j, k = cell.tolist()
    forward = -camera.view_from_world()[2, :3]
    depth = float((origin + t * direction - np.asarray(camera.position)) @ forward)
    return (i, j, k), float(item.volume.values[k, j, i]), depth


def _on_plane(
    item: VolumeItem, settings: VolumeSettings, clip: Clip, origin: NDArray, direction: NDArray
) -> tuple[NDArray, float] | None:
    """The cell of the nearest slice plane that a ray meets, and how far along the ray."""
    inverse = np.linalg.inv(item.volume.world_from_index)
    size = np.array(item.volume.values.shape[::-1])
    start, way = inverse @ np.append(origin, 1), inverse @ np.append(direction, 0)
    found = []
    for axis, place in enumerate(settings.planes.places):
        if place is None or way[axis] == 0:
            continue
        # texture coordinates span the voxels' outer faces
        t = float((place * size[axis] - 0.5 - start[axis]) / way[axis])
        at = (start + t * way)[:3]
        inside = ((at >= -0.5) & (at <= size - 0.5)).all()
        if t > 0 and inside and clip.keeps(origin + t * direction):
            found.append((t, np.clip(np.rint(at), 0, size - 1).astype(int)))
    if not found:
        return None
    t, cell = min(found, key=lambda one: one[0])
    return cell, t


def _seen(item: VolumeItem, settings: VolumeSettings, values: NDArray) -> NDArray[np.bool_]:
    if settings.iso is not None:
        return values >= settings.iso
    transfer = item.shown or choose_transfer(
        item.volume, settings.transfer, settings.opacity, settings.window, settings.level
    )
    return transfer.opacity(values) > FAINT


def voxel_sentence(item: VolumeItem, index: tuple[int, int, int], value: float) -> str:
    """``brain · voxel 12, 40, 7 · value 113``."""
    name = item.volume.value_name
    unit = f" ({name})" if name else ""
    return f"{item.volume.name} · voxel {', '.join(map(str, index))} · value {value:g}{unit}"
