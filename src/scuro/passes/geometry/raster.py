"""Primary visibility by rasterised impostors (QuteMol's and HaptiMOL's way; Easdon 2013, 3.3)."""

from __future__ import annotations

from typing import Any

from scuro.passes.frame import Frame

_SHADER = "passes/geometry/raster.wgsl"


def rasterise(frame: Frame) -> None:
    """Draw spheres, rods and triangles into ``visible``."""
    visible = frame.target("visible", "rgba32uint", attachment=True)
    depth = frame.targets.get("depth", frame.size, "depth32float", attachment=True)
    near, far = _depth_range(frame)
    clear = True
    instance = 0

    def draw(first: int, stride: int, count: int, copies: int, entries: tuple[str, str]) -> None:
        nonlocal clear
        uniform: dict[str, Any] = {
            "first": first,
            "count": max(count, 1),
            "instance": instance,
            "near": near,
            "far": far,
            "tile": frame.size,
        }
        frame.recorder.draw(
            _SHADER,
            {"visible": visible},
            3 if stride == 3 else 4,
            count * copies,
            frame.resources | {"draw": uniform},
            depth=depth,
            clear=clear,
            # every bit set says that no primitive is there
            clear_value=(0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0),
            entries=entries,
            constants=frame.constants | {"STRIDE": stride},
            topology="triangle-list" if stride == 3 else "triangle-strip",
            label="raster",
        )
        clear = False

    accelerator = frame.accelerator
    draw(0, 1, 0, 0, ("quad", "solid"))
    for body in accelerator.bodies:
        geometry, copies = body.geometry, len(body.positions)
        first = accelerator.first_slots[id(geometry)]
        spheres, rods = len(geometry.spheres), len(geometry.rods)
        triangles = len(geometry.triangles)
        if spheres and copies:
            draw(first, 1, spheres, copies, ("quad", "solid"))
        if rods and copies:
            draw(first + spheres, 2, rods, copies, ("quad", "solid"))
        if triangles and copies:
            draw(first + spheres + 2 * rods, 3, triangles, copies, ("corner", "flat_triangle"))
        instance += copies


def _depth_range(frame: Frame) -> tuple[float, float]:
    """Distances of depth 1 and 0; a perspective depth ends at infinity.

    Reversed floating-point depth makes the nearest distance a matter of clipping only: a small
    share of the scene's size, so that no picture depends on it.
    """
    extent = max(frame.accelerator.extent, 1e-6)
    middle = frame.resources["view"]["distance"]
    if frame.camera.orthographic:
        return -(middle + 2 * extent), middle + 2 * extent
    return 1e-5 * extent, middle + 2 * extent
