"""Depth cues in one pass: toon shading, fog, halos, borders, in this order; each can be off.

Where no pass comes before, it shades, and where none comes after, it encodes the picture.
"""

from __future__ import annotations

from typing import Any

from scuro.passes.compose.shade import encoding, light_of
from scuro.passes.frame import Frame
from scuro.passes.post.borders import THIN, borders_reach, borders_uniform
from scuro.passes.post.fog import fog_uniform
from scuro.passes.post.fxaa import asked_for, brightness_of
from scuro.passes.post.halos import blur_depth, halos_reach, halos_uniform


def cues_reach(settings: Any, px: float) -> float:
    """Distance in pixels from which one is influenced; ``px`` of them are 1 px.

    ``settings`` are those of a picture.
    """
    return max(borders_reach(settings.borders, px), halos_reach(settings.halos, px))


def draw_cues(frame: Frame, shading: bool = False) -> None:
    """Apply to ``color`` those that the settings ask for.

    Args:
        frame: With a G-buffer.
        shading: Whether ``color`` is still to be made.
    """
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
    if not shading and not any(on.values()):
        return
    if cues_reach(settings, frame.px):
        near = {f"tile_{part}": frame.resources[f"near_{part}"] for part in ("list", "count")}
        frame.resources |= near
    halos = halos_uniform(frame)
    sparse = shading or frame.resources["color"] is frame.sparse
    last = sparse and not settings.depth_of_field.blur
    on["SHADING"] = shading
    on["BRIGHTNESS"] = last and asked_for(frame)
    on["PICTURE"] = last and _is_final(frame)
    brightness = brightness_of(frame, on["BRIGHTNESS"])
    light, lit = light_of(frame)
    resources = {
        "toon": {"steps": float(steps)},
        "fog": fog_uniform(frame),
        "halos": halos,
        "blurred": blur_depth(frame, halos) if on["HALOS"] else _nothing(frame),
        "borders": borders_uniform(frame),
        "nearest": frame.gpu.nearest_sampler,
        "picture": _nothing(frame, "rgba8unorm"),
        **light,
        **brightness,
    }
    if on["PICTURE"]:
        resources |= encoding(frame, frame.size)
    constants = on | lit
    if shading:
        color = frame.sparse = frame.target("color", "rgba16float", clear=(0, 0, 0, 0))
        resources |= {"color": _nothing(frame), "replaced": color}
        frame.compute_tiles("passes/post/cues.wgsl", resources, constants=constants)
    else:
        frame.replace_color("passes/post/cues.wgsl", resources, tiles=True, constants=constants)


def _is_final(frame: Frame) -> bool:
    """Whether only FXAA can follow, if not depth of field."""
    settings = frame.settings
    joined = settings.stereo.mode == "red-cyan"
    return frame.scale == 1 and not joined and settings.semantic.mode == "off"


def _nothing(frame: Frame, format: str = "rgba16float") -> Any:
    return frame.targets.get(f"no {format}", (1, 1), format)
