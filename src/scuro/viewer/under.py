"""What is under the pointer: an atom, a cell, a voxel, and how far away it is.

Places are (x, y) in the picture, each 0 to 1 from the upper left.
"""

from __future__ import annotations

from typing import Any

from scuro.errors import ScuroError
from scuro.scene.reservoir import ReservoirItem
from scuro.viewer import navigate
from scuro.viewer.cell import cell_at, cell_sentence
from scuro.viewer.eyes import eye_at
from scuro.viewer.pick import Pick, pick, sentence
from scuro.viewer.view import View
from scuro.viewer.voxel import voxel_at, voxel_sentence


def surface_at(view: View, x: float, y: float) -> Pick | None:
    """The surface that is seen there; ``None`` if there is none."""
    if view.drawn is None or not view.drawable:
        return None
    return pick(view.drawn, view.model.scene, x, y)


def words_at(view: View, x: float, y: float) -> str:
    """What is there in words; empty if nothing."""
    found = surface_at(view, x, y)
    if found is not None and not _is_cells(found):
        return sentence(found)
    inside = _inside(view, x, y)
    if inside is None:
        return "" if found is None else sentence(found)
    item, (index, value, _) = inside
    tell = cell_sentence if isinstance(item, ReservoirItem) else voxel_sentence
    return tell(item, index, value)


def depth_at(view: View, x: float, y: float) -> float:
    """Distance along the viewing direction of what is seen there; the target's if nothing."""
    found = surface_at(view, x, y)
    if found is not None:
        point = navigate.project(view.camera, [found.position], view.size)
        return float(point[0, 2])
    inside = _inside(view, x, y)
    return view.camera.distance if inside is None else inside[1][2]


def _inside(view: View, x: float, y: float) -> Any:
    """The voxel or cell that is seen there: its item, and its index, value and depth."""
    try:
        return _found_inside(view, x, y)
    except ScuroError:  # such as the name of a colormap, half typed: drawing says so
        return None


def _found_inside(view: View, x: float, y: float) -> Any:
    model, (width, height) = view.model, view.size
    eye = eye_at(view.eyes(view.size), x * width)
    camera, size, pixel = eye.camera, eye.size, eye.on_axis((x * width, y * height))
    for item in model.scene.volumes:
        found = voxel_at(item, model.settings.volume, model.clip, camera, pixel, size)
        if found is not None:
            return item, found
    for reservoir in model.scene.reservoirs:
        found = cell_at(reservoir, model.clip, camera, pixel, size)
        if found is not None:
            return reservoir, found
    return None


def _is_cells(found: Pick) -> bool:
    """Whether a surface is that of a reservoir's cells, and not a well or an edge."""
    return isinstance(found.item, ReservoirItem) and found.body.name.endswith(("cells", "slices"))
