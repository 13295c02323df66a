"""Anti-aliasing of the finished picture: FXAA (Lottes 2009), the fast half."""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.style.paint import premultiplied


def draw_fxaa(frame: Frame) -> None:
    """Smooth the jagged edges of ``color``."""
    if frame.settings.antialias.method != "fxaa":
        return
    background = premultiplied(frame.settings.background)
    frame.replace_color("passes/post/fxaa.wgsl", {"fxaa": {"background": background}}, tiles=True)
