"""Anti-aliasing of the finished picture: FXAA (Lottes 2009), the fast half."""

from __future__ import annotations

import math

from scuro.passes.frame import Frame
from scuro.style.paint import premultiplied


def draw_fxaa(frame: Frame) -> None:
    """Smooth the jagged edges of ``color``."""
    if frame.settings.antialias.method != "fxaa":
        return
    background = premultiplied(frame.settings.background)
    frame.target("brightness", "r32float", clear=(_brightness(background), 0, 0, 0))
    frame.compute_tiles("passes/post/fxaa_luma.wgsl", {"fxaa": {"background": background}})
    frame.replace_color("passes/post/fxaa.wgsl", {"nearest": frame.gpu.nearest_sampler}, tiles=True)


def _brightness(background: tuple[float, float, float, float]) -> float:
    """Of pixels that show nothing else, as in fxaa_luma.wgsl."""
    red, green, blue, _ = background
    return math.sqrt(0.2126 * red + 0.7152 * green + 0.0722 * blue)
