"""``analytic``: blocking factors of each atom's nearest spheres (Easdon 2013, section 4.4).

The lists of neighbours are found once a geometry. Spheres of other instances and rods, ribbons and
triangles do not occlude: ``hybrid`` adds them by rays.
"""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.frame import Frame
from scuro.scene.geometry import Geometry
from scuro.settings import SettingsGroup, setting
from scuro.trace.pack import NO_PRIMITIVE, PackedGeometry, pack_geometry
from scuro.trace.table import table


class AnalyticSettings(SettingsGroup):
    """Analytic occlusion."""

    neighbours: int = setting(
        16, "nearest spheres that occlude each atom, in fours", low=4, high=128
    )
    form: str = setting(
        "clipped",
        "blocking factor of a sphere: exact with the horizon, or Easdon's equation 4.4 without",
        choices=("clipped", "easdon"),
    )


def draw(frame: Frame) -> None:
    """Fill ``visibility``."""
    block_analytically(frame, "visibility", frame.settings.occlusion.analytic.neighbours)


def block_analytically(frame: Frame, name: str, neighbours: int) -> None:
    """Fill the texture ``name`` with the product over near spheres of what each leaves open.

    Args:
        frame: With ``surface`` and ``ids`` filled.
        name: Target.
        neighbours: Spheres an atom; rounded up to fours.
    """
    texels = -(-neighbours // 4)
    resources = {
        "analytic": {
            "texels": texels,
            "range": frame.settings.occlusion.distance or 3e38,
            "form": int(frame.settings.occlusion.analytic.form == "easdon"),
        },
        "neighbours": neighbour_table(frame, texels),
        "result": frame.target(name, "r32float", clear=(1, 1, 1, 1)),
    }
    frame.compute_tiles("passes/occlusion/analytic.wgsl", resources, label="occlusion")


def neighbour_table(frame: Frame, texels: int) -> Any:
    """For each slot of the scene, ``texels`` times four slots of the spheres around it."""
    key = (id(frame.accelerator), texels)
    return frame.targets.table("neighbours", key, lambda: _neighbour_table(frame, texels))


def _neighbour_table(frame: Frame, texels: int) -> Any:
    lists = []
    for body in {id(b.geometry): b for b in frame.accelerator.bodies}.values():
        packed = pack_geometry(body.geometry)
        found = nearest_spheres(body.geometry, packed, 4 * texels).astype(np.uint32)
        first = np.uint32(frame.accelerator.first_slots[id(body.geometry)])
        none = found == NO_PRIMITIVE
        lists.append(np.where(none, np.uint32(NO_PRIMITIVE), found + first))
    joined = np.concatenate([*lists, np.full((1, 4 * texels), NO_PRIMITIVE, np.uint32)])
    return table(frame.gpu, joined.reshape(-1, 4), "neighbours")


_found: weakref.WeakKeyDictionary[Geometry, dict[int, NDArray]] = weakref.WeakKeyDictionary()


def nearest_spheres(geometry: Geometry, packed: PackedGeometry, count: int) -> NDArray[np.uint32]:
    """For each slot (s, count) the slots of the nearest other spheres; ``NO_PRIMITIVE`` for none.

    Nearest by the distance between centres (of a slot that is no sphere: its own point).
    """
    held = _found.setdefault(geometry, {})
    if count not in held:
        held[count] = _search(packed.slots, len(geometry.spheres), count)
    return held[count]


def _search(slots: NDArray[np.float32], spheres: int, count: int) -> NDArray[np.uint32]:
    if spheres == 0:
        return np.full((len(slots), count), NO_PRIMITIVE, np.uint32)
    from scipy.spatial import cKDTree

    # slots lie along a space-filling curve: the tree need not balance itself
    tree = cKDTree(slots[:spheres, :3], balanced_tree=False, compact_nodes=False)
    distance, index = tree.query(slots[:, :3], k=count + 1, workers=-1)
    own = np.arange(len(slots))[:, None]
    # move oneself (a sphere is its own nearest) to the end, to be cut off
    index = np.where(np.isfinite(distance) & (index != own), index, NO_PRIMITIVE)
    order = np.argsort(index == NO_PRIMITIVE, axis=1, kind="stable")
    return np.take_along_axis(index, order, axis=1)[:, :count].astype(np.uint32)
