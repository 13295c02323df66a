"""Toon shading: light in a few steps, whatever made it."""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.settings import SettingsGroup, setting


class ToonSettings(SettingsGroup):
    """Flat tones in place of smooth shading."""

    steps: int = setting(0, "number of tones; 0 shades smoothly", low=0, high=16, main=True)


def draw_toon(frame: Frame) -> None:
    """Bring the brightness of ``color``, relative to the surface's own, to a number of steps."""
    steps = frame.settings.toon.steps
    if steps:
        frame.replace_color("passes/post/toon.wgsl", {"toon": {"steps": float(steps)}}, tiles=True)
