"""Depth cues in one pass: toon shading, fog, halos, borders, in this order; each can be off."""

from __future__ import annotations

from typing import Any

from scuro.passes.frame import Frame
from scuro.passes.geometry.tiles import find_tiles
from scuro.passes.post.borders import THIN, borders_reach, borders_uniform
from scuro.passes.post.fog import fog_uniform
from scuro.passes.post.fxaa import asked_for, brightness_of
from scuro.passes.post.halos import blur_depth, halos_reach, halos_uniform


def cues_reach(settings: Any, px: float) -> float:
    """Distance in pixels from which one is influenced; ``px`` of them are 1 px.

    ``settings`` are those of a picture.
    """
    return max(borders_reach(settings.borders, px), halos_reach(settings.halos, px))


def draw_cues(frame: Frame) -> None:
    """Apply to ``color`` those that the settings ask for."""
    settings = frame.settings
    steps = settings.toon.steps
    lines = settings.borders.width or 0.0
    on = {
        "TOON": bool(steps),
        "FOG": bool(settings.fog.strength),
        "HALOS": bool(settings.halos.width),
        "LINES": 0 < lines * frame.px <= THIN,
        "WIDE_LINES": lines * frame.px > THIN,
    }
    if not any(on.values()):
        return
    reach = cues_reach(settings, frame.px)
    if reach:
        find_tiles(frame, margin=reach, name="wide_tile")
    halos = halos_uniform(frame)
    # where nothing comes between, what FXAA compares is stored at once
    last = frame.resources["color"] is frame.sparse and not settings.depth_of_field.blur
    on["BRIGHTNESS"] = asked_for(frame) and last
    brightness = brightness_of(frame, on["BRIGHTNESS"])
    frame.replace_color(
        "passes/post/cues.wgsl",
        {
            "toon": {"steps": float(steps)},
            "fog": fog_uniform(frame),
            "halos": halos,
            "blurred": blur_depth(frame, halos) if on["HALOS"] else _nothing(frame),
            "smooth_edges": frame.gpu.linear_sampler,
            "borders": borders_uniform(frame),
            "nearest": frame.gpu.nearest_sampler,
            **brightness,
        },
        tiles=True,
        constants=on,
    )


def _nothing(frame: Frame) -> Any:
    return frame.target("nothing", "rgba16float", size=(1, 1))
