"""Deferred shading and the encoding of the picture."""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.style.paint import premultiplied, srgb


def shade(frame: Frame) -> None:
    """Light the G-buffer: ``color``, linear and premultiplied."""
    white = frame.resources.get("visibility")
    constants = {
        "HAS_OCCLUSION": white is not None,
        "HAS_SHADOWS": "shadow" in frame.resources,
    }
    resources = {
        "visibility": white or frame.target("white", "r32float", size=(1, 1)),
        "shadow": frame.resources.get("shadow") or frame.target("white", "r32float", size=(1, 1)),
    }
    frame.sparse = frame.target("color", "rgba16float", clear=(0, 0, 0, 0))
    frame.compute_tiles("passes/compose/shade.wgsl", resources, constants=constants)


def encode(frame: Frame) -> None:
    """Turn ``color`` into ``picture``: sRGB, over the background or with straight alpha."""
    size = frame.resources["color"].size[:2]
    red, green, blue, alpha = srgb(frame.settings.background)
    empty = (red, green, blue, alpha) if alpha > 0 else (0.0, 0.0, 0.0, 0.0)
    frame.target("picture", "rgba8unorm", size=size, clear=empty)
    background = premultiplied(frame.settings.background)
    frame.compute_shown("passes/compose/encode.wgsl", {"encode": {"background": background}})
