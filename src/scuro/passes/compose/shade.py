"""Deferred shading and the encoding of the picture."""

from __future__ import annotations

from typing import Any

from scuro.passes.frame import Frame
from scuro.style.paint import premultiplied, srgb


def shade(frame: Frame) -> None:
    """Light the G-buffer: ``color``, linear and premultiplied."""
    resources, constants = light_of(frame)
    frame.sparse = frame.target("color", "rgba16float", clear=(0, 0, 0, 0))
    frame.compute_tiles("passes/compose/shade.wgsl", resources, constants=constants)


def light_of(frame: Frame) -> tuple[dict[str, Any], dict[str, bool]]:
    """What shaded.wgsl wants bound, and its constants."""
    white = frame.target("white", "r32float", size=(1, 1))
    names = {"visibility": "HAS_OCCLUSION", "shadow": "HAS_SHADOWS"}
    resources = {name: frame.resources.get(name) or white for name in names}
    return resources, {names[name]: name in frame.resources for name in names}


def encode(frame: Frame) -> None:
    """Turn ``color`` into ``picture``, unless the pass that made it did so."""
    if "picture" in frame.resources:
        return
    frame.compute_shown(
        "passes/compose/encode.wgsl", encoding(frame, frame.resources["color"].size[:2])
    )


def encoding(frame: Frame, size: tuple[int, int]) -> dict[str, Any]:
    """What encoded.wgsl wants bound, and the empty ``picture``.

    The picture is sRGB, over the background or with straight alpha.
    """
    red, green, blue, alpha = srgb(frame.settings.background)
    empty = (red, green, blue, alpha) if alpha > 0 else (0.0, 0.0, 0.0, 0.0)
    picture = frame.target("picture", "rgba8unorm", size=size, clear=empty)
    background = premultiplied(frame.settings.background)
    return {"encode": {"background": background}, "picture": picture}
