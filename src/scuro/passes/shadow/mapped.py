"""``mapped``: shadow maps, as QuteMol and games have them, for comparison.

A map's texels are larger than the picture's pixels or smaller, its bias detaches shadows from what
casts them, and it must be cast anew whenever the light moves: the faults that rays do not have.
"""

from __future__ import annotations

from scuro.passes.frame import Frame


def draw(frame: Frame, light: int) -> None:
    """Fill ``shadow_light``."""
    settings = frame.settings.shadows
    size = settings.map_size
    depths = frame.targets.get("shadow_map", (size, size), "r32float")
    uniform = {
        "light": light,
        "size": size,
        "bias": settings.bias,
        "taps": settings.taps,
    }
    shader = "passes/shadow/mapped.wgsl"
    # a texture is either read or written within a pass: each pass gets stand-ins for the other's
    read, written = (
        frame.targets.get(f"shadow_map_{use}", (1, 1), "r32float") for use in ("read", "written")
    )
    also = frame.targets.get("shadow_map_result", (1, 1), "r32float")
    frame.compute(
        shader,
        {"mapped": uniform, "depths_out": depths, "depths": read, "result": also},
        entry="fill_map",
        threads=(size, size),
        label="shadow map",
    )
    frame.compute_tiles(
        shader,
        {
            "mapped": uniform,
            "depths_out": written,
            "depths": depths,
            "result": frame.resources["shadow_light"],
        },
        label="shadow",
    )
