"""Depth cueing: surfaces fade toward a colour with their distance from the scene's front."""

from __future__ import annotations

from typing import Any

from scuro.passes.frame import Frame
from scuro.passes.post.depth import depth_range
from scuro.settings import SettingsGroup, setting
from scuro.style.paint import check_color, premultiplied


class FogSettings(SettingsGroup):
    """Depth cueing between the front and the back of the scene."""

    strength: float = setting(
        0.0, "how much of its own colour the scene's back loses", low=0, high=1, main=True
    )
    color: str = setting(
        "background", "what to fade to: a colour, or the background", check=check_color
    )
    start: float = setting(
        0.1, "where it begins: 0 is the scene's front, 1 its back", low=-1, high=2
    )
    end: float = setting(1.0, "where it is full", low=-1, high=3)


def fog_uniform(frame: Frame) -> dict[str, Any]:
    """Field values of ``Fog`` (fog.wgsl); a transparent background turns surfaces transparent."""
    settings = frame.settings.fog
    named = settings.color
    front, back = depth_range(frame) if settings.strength else (0.0, 1.0)
    span = (settings.end - settings.start) * (back - front)
    return {
        "color": premultiplied(frame.settings.background if named == "background" else named),
        "start": front + settings.start * (back - front),
        "density": 1 / max(span, 1e-6),
        "strength": settings.strength,
    }
