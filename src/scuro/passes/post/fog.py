"""Depth cueing: surfaces fade toward a colour with their distance from the scene's front."""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.passes.post.depth import depth_range
from scuro.settings import SettingsGroup, setting
from scuro.style.paint import premultiplied


class FogSettings(SettingsGroup):
    """Depth cueing between the front and the back of the scene."""

    strength: float = setting(
        0.0, "how much of its own colour the scene's back loses", low=0, high=1, main=True
    )
    color: str = setting("background", "what to fade to: a colour, or the background")
    start: float = setting(
        0.1, "where it begins: 0 is the scene's front, 1 its back", low=-1, high=2
    )
    end: float = setting(1.0, "where it is full", low=-1, high=3)


def draw_fog(frame: Frame) -> None:
    """Fade ``color``; toward a transparent background, surfaces turn transparent."""
    settings = frame.settings.fog
    if not settings.strength:
        return
    named = settings.color
    color = premultiplied(frame.settings.background if named == "background" else named)
    front, back = depth_range(frame)
    start = front + settings.start * (back - front)
    span = (settings.end - settings.start) * (back - front)
    frame.replace_color(
        "passes/post/fog.wgsl",
        {
            "fog": {
                "color": color,
                "start": start,
                "density": 1 / max(span, 1e-6),
                "strength": settings.strength,
            }
        },
        tiles=True,
    )
