"""Primary visibility: which primitive each pixel sees, by ray casting or by rasterisation.

Both ways fill the same visibility buffer; ``resolve`` turns it into the G-buffer by intersecting
each pixel's one primitive again, so that depths and normals are exact either way.
"""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.passes.geometry.raster import rasterise
from scuro.passes.geometry.tiles import find_tiles

EMPTY_IDS = (0xFFFFFFFF,) * 4

RASTER_MOST = 1_000_000
"""More primitives than this, instances counted, are ray cast: see :func:`_suits_raster`."""
_RASTER_BODIES = 64
"""So are more bodies, each of which takes draws of its own."""


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
    bodies = frame.accelerator.bodies
    if frame.constants["CLIPPED"] and any(
        body.clipped and body.closed and len(body.geometry.triangles) for body in bodies
    ):
        return "raycast"  # whether a pixel shows the cap of a mesh takes all of the mesh to know
    if way != "auto":
        return way
    return "raster" if _suits_raster(frame) else "raycast"


def _suits_raster(frame: Frame) -> bool:
    """Whether rasterisation is the faster way.

    Space-filling atoms hide each other and stop rays early; rays among sticks and ribbons go far
    and test much. On a software adapter, at 1280×720: atoms of 1AON ray cast 0.10, rasterised 0.42
    core-seconds a frame; its cartoon 0.75 and 0.35; sticks of 1HPV 0.28 and 0.09.
    """
    bodies = frame.accelerator.bodies
    if frame.constants["HAS_LEVELS"] or len(bodies) > _RASTER_BODIES:
        return False
    spheres = sum(len(body.geometry.spheres) * body.instances for body in bodies)
    drawn = sum(len(body.geometry) * body.instances for body in bodies)
    return 0 < drawn <= RASTER_MOST and 3 * spheres <= 2 * drawn
