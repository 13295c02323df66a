"""Depth-aware borders (Tarini et al. 2006): thicker where more depth lies behind an edge."""

from __future__ import annotations

from typing import Any

from scuro.passes.frame import Frame
from scuro.passes.post.depth import full_jump
from scuro.settings import SettingsGroup, setting
from scuro.style.paint import check_color, linear_rgba


class BorderSettings(SettingsGroup):
    """Lines around what stands out from what lies behind it."""

    width: float | None = setting(
        None,
        "widest line, in front of the background; 0 draws none, as do all lightings but flat",
        low=0,
        high=16,
        unit="px",
        main=True,
    )
    color: str = setting("black", "colour of the lines", check=check_color)
    opacity: float = setting(1.0, "1 covers what is behind the lines", low=0, high=1)
    jump: float | None = setting(
        None, "depth jump at which lines reach their full width (default: two atoms)", low=0
    )


def borders_reach(settings: BorderSettings, px: float) -> float:
    """Distance in pixels from which one is influenced; ``px`` of them are 1 px."""
    return settings.width * px + 1 if settings.width else 0.0


THIN = 2.0
"""Lines up to this width in samples are found in few steps."""


def borders_uniform(frame: Frame) -> dict[str, Any]:
    """Field values of ``Borders`` (borders.wgsl)."""
    settings = frame.settings.borders
    red, green, blue, alpha = linear_rgba(settings.color)
    width = (settings.width or 0.0) * frame.px
    pixel = 2 * frame.camera.half_height() / frame.resources["view"]["size"][1]
    return {
        "color": (red, green, blue),
        "opacity": settings.opacity * alpha,
        "width": width,
        "pixel": pixel,
        "opening": 0.0 if frame.camera.orthographic else pixel,
        "per_jump": 1 / max(full_jump(frame, settings.jump, width), 1e-6),
    }
