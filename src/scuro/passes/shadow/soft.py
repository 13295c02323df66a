"""``soft``: penumbras from one ray a pixel (Parker et al. 1998; Easdon 2013, section 5.5).

Each solid's silhouette as the ray passes it is blurred: light fades over a band around it, from
inside to outside, by a Hermite curve, and of all solids the one that leaves least decides. The band
widens with the distance from the shaded point as the light's disc makes it, up to
``shadows.penumbra``, which bounds how far around the ray solids must be looked for. Parker's own
form, an outer sphere of a fixed ratio, is there as ``shadows.ratio``.

Meshes have no outer sphere: scenes that hold any are shadowed by rays to the light's disc instead.
"""

from __future__ import annotations

from collections.abc import Iterator

from scuro.passes.frame import Frame
from scuro.passes.shadow.ray import default_spread, draw_area
from scuro.trace.grids import Growth


def prepare(frame: Frame) -> Iterator[float]:
    """Build in short steps what :func:`draw` needs; yields the share that is done."""
    if not frame.constants["HAS_TRIANGLES"]:
        yield from frame.accelerator.grown_in_steps(frame.gpu, _growth(frame)[0])


def draw(frame: Frame, light: int) -> None:
    """Fill ``shadow_light``."""
    if frame.constants["HAS_TRIANGLES"]:
        draw_area(frame, light)
        return
    settings = frame.settings.shadows
    growth, most = _growth(frame)
    grown = dict(frame.accelerator.grown(frame.gpu, growth))
    grown["scene"] = frame.resources["scene"] | grown["scene"]
    frame.compute_tiles(
        "passes/shadow/soft.wgsl",
        {
            **grown,
            "soft": {
                "light": light,
                "spread": default_spread(frame),
                "most": most,
                "ratio": settings.ratio or 0.0,
            },
            "result": frame.resources["shadow_light"],
        },
        constants={"PARKER": settings.ratio is not None},
        label="shadow",
    )


def _growth(frame: Frame) -> tuple[Growth, float]:
    """By how much solids are listed larger, and half the widest band around a silhouette."""
    settings = frame.settings.shadows
    most = 0.5 * settings.penumbra * frame.accelerator.primitive_radius
    if settings.ratio is None:
        return Growth(margin=most), most
    return Growth(factor=settings.ratio), most
