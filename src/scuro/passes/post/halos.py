"""Depth-aware halos (Tarini et al. 2006) by unsharp masking of depth (Luft et al. 2006)."""

from __future__ import annotations

import math
from typing import Any

from scuro.passes.frame import Frame
from scuro.passes.post.depth import full_jump
from scuro.settings import SettingsGroup, setting
from scuro.style.paint import check_color, linear_rgba


class HaloSettings(SettingsGroup):
    """A soft glow or shade around what stands out, laid on what lies behind it."""

    width: float = setting(
        0.0, "how far halos reach; 0 draws none", low=0, high=128, unit="px", main=True
    )
    color: str = setting(
        "black", "colour: dark halos look like contact shade, light ones glow", check=check_color
    )
    opacity: float = setting(0.6, "of the strongest halo, at the edge", low=0, high=1)
    jump: float | None = setting(
        None, "depth jump at which halos are at their strongest (default: two atoms)", low=0
    )


MOST_REDUCTION = 16
"""Depth is averaged over squares of at most so many pixels before it is blurred."""


def halos_reach(settings: HaloSettings, px: float) -> float:
    """Distance in pixels from which one is influenced; ``px`` of them are 1 px."""
    if not settings.width:
        return 0.0
    reduction = _reduction(settings.width * px)
    # four reduced pixels are around a pixel, and averages of squares around them
    return (math.ceil(settings.width * px / reduction) + 1.5) * reduction


def _reduction(width: float) -> int:
    """Pixels a side of the squares that are averaged first, for halos so many pixels wide.

    A blur needs few samples across its width. A power of two, so that parts agree on the squares.
    """
    reduction = 1
    while reduction < MOST_REDUCTION and reduction * 4 <= width:
        reduction *= 2
    return reduction


def halos_uniform(frame: Frame) -> dict[str, Any]:
    """Field values of ``Halos`` (halo_types.wgsl)."""
    settings = frame.settings.halos
    width = settings.width * frame.px
    reduction = _reduction(width)
    red, green, blue, alpha = linear_rgba(settings.color)
    return {
        "color": (red, green, blue),
        "opacity": settings.opacity * alpha,
        "width": width / reduction,
        "jump": max(full_jump(frame, settings.jump), 1e-6),
        "reduction": reduction,
    }


def blur_depth(frame: Frame, halos: dict[str, Any]) -> Any:
    """Blurred depth and coverage, in a texture smaller by the reduction of ``halos``."""
    small = tuple(-(-s // halos["reduction"]) for s in frame.size)
    source = frame.target("halo_depth", "rgba16float", size=small)
    resources = {"halos": halos, "result": source, "nearest": frame.gpu.nearest_sampler}
    frame.compute("passes/post/halo_reduce.wgsl", resources, threads=small, label="halos")
    quarters = ((-(-small[0] // 4), small[1]), (small[0], -(-small[1] // 4)))
    for entry, threads in zip(("across", "down"), quarters, strict=True):
        result = frame.target(f"halo_{entry}", "rgba16float", size=small)
        resources = {"halos": halos, "source": source, "result": result}
        frame.compute(
            "passes/post/halo_blur.wgsl", resources, entry=entry, threads=threads, label="halos"
        )
        source = result
    return source
