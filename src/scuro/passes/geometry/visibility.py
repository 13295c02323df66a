"""Primary visibility: which primitive each pixel sees, by ray casting or by rasterisation.

Both ways fill the same visibility buffer; ``resolve`` turns it into the G-buffer by intersecting
each pixel's one primitive again, so that depths and normals are exact either way.
"""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.passes.geometry.raster import rasterise
from scuro.passes.geometry.tiles import find_tiles

EMPTY_IDS = (0xFFFFFFFF,) * 4

RASTER_LIMIT = 3000
"""On a software adapter, more spheres than this are faster ray cast."""


def draw_visibility(frame: Frame) -> None:
    """Fill ``visible``, then ``surface``, ``albedo`` and ``ids``."""
    find_tiles(frame)
    if _way(frame) == "raster":
        rasterise(frame)
    else:
        frame.target("visible", "rgba32uint", attachment=True)
        frame.compute_tiles("passes/geometry/raycast.wgsl")
    frame.target("surface", "rgba32float", clear=(0, 0, 0, 0))
    frame.target("albedo", "rgba16float", clear=(0, 0, 0, 0))
    frame.target("ids", "rgba32uint", clear=EMPTY_IDS)
    frame.compute_tiles("passes/geometry/resolve.wgsl")


def _way(frame: Frame) -> str:
    way = frame.settings.visibility
    if frame.constants["HAS_OPACITY"]:
        return "raycast"  # transparent objects are left out, ray by ray
    if frame.constants["HAS_NESTING"]:
        return "raycast"  # what is placed twice over would be drawn piece by piece
    if frame.constants["CLIPPED"] and frame.constants["HAS_TRIANGLES"]:
        return "raycast"  # whether a pixel shows the cap of a mesh takes all of the mesh to know
    return "raycast" if way == "auto" else way
