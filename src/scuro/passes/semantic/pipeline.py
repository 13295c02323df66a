"""The passes of the thesis, in order. Each leaves its buffer in the frame under the shader's name.

``regions`` (t and t + 1), ``calm_surface``, ``diffuse``, ``gathered`` (light, visibility),
``bounce`` and ``lit`` (in one pixel of four), ``gathered_blurred`` (light), ``bounce_blurred``
(bounce, shadow), and ``color``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.frame import Frame
from scuro.passes.semantic.levels import (
    atom_radius,
    depth_limit,
    distance_of,
    edges_uniform,
    levels_uniform,
    place,
    region_table,
)
from scuro.passes.semantic.recolor import color_by_level
from scuro.passes.semantic.settings import SemanticSettings
from scuro.passes.semantic.smooth import rested, smoothed
from scuro.passes.semantic.still import is_far
from scuro.scene.regions import BY_GROUP, Hierarchy
from scuro.trace.table import float_table

_EMPTY, _LIT = (0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)


def shade_semantic(frame: Frame, hierarchy: Hierarchy) -> None:
    """Light the G-buffer with semantic occlusion, shadows and bounce: ``color``."""
    settings: SemanticSettings = frame.settings.semantic
    here = place(frame, hierarchy)
    frame.resources["levels"] = levels_uniform(hierarchy, here)
    frame.resources["region_table"] = region_table(frame.gpu, hierarchy)
    color_by_level(frame, hierarchy)
    frame.target("regions", "rgba32uint", clear=_EMPTY)
    frame.compute_tiles("passes/semantic/regions.wgsl")
    # light falls on the surface as it is; only the blur takes calmed normals for its edges
    calm = {"surface": _calm(frame, settings)}
    frame.target("diffuse", "rgba16float", clear=_EMPTY)
    frame.compute_tiles("passes/semantic/direct.wgsl")
    for name in ("gathered", "bounce"):
        frame.target(name, "rgba16float", clear=_EMPTY)
    frame.target("lit", "r32float", clear=_LIT)
    plain = settings.mode == "plain"
    near = 1.0 if plain else 1.0 - here.depth
    bounce = settings.bounce * (1.0 - here.depth)
    # faded out on the way in: single molecules would lie in the dark (thesis, chapter 5)
    shadow = 0.0 if plain else settings.shadow * here.depth
    if bounce > 0:  # one of screen space in every mode
        _bounce(frame, settings, bounce * near)
    if settings.mode == "traced":
        _trace(frame, settings, near)
    else:
        _occlude(frame, settings, near)
    if shadow > 0:
        _shadow(frame, settings, shadow)
    frames = rested(frame)
    samples = settings.rays if settings.mode == "traced" else settings.samples
    light = smoothed(frame, calm, frames, samples, bounce=bounce > 0, shadow=shadow > 0)
    frame.sparse = frame.target("color", "rgba16float", clear=_EMPTY)
    frame.compute_tiles(
        "passes/semantic/combine.wgsl",
        calm | light | {"edges": edges_uniform(frame)},
        constants={"HAS_THIN": bounce > 0 or shadow > 0},
    )


def _calm(frame: Frame, settings: SemanticSettings) -> Any:
    """The surface with calmed normals, ``calm_surface``; the surface itself where none need it."""
    atom = 2 * atom_radius(frame)
    if settings.calm == 0 or not is_far(frame):
        frame.resources["calm_surface"] = frame.resources["surface"]
        return frame.resources["surface"]
    surface = frame.resources["surface"]
    for step, name in (((1, 0), "calm_x"), ((0, 1), "calm_surface")):
        calm = {
            "step": step,
            "reach": settings.calm,
            "atom": atom,
            "depth_limit": depth_limit(frame),
        }
        calmed = frame.target(name, "rgba32float", clear=_EMPTY)
        frame.compute_tiles(
            "passes/semantic/calm.wgsl", {"calm": calm, "surface": surface, "calmed": calmed}
        )
        surface = calmed
    return surface


def _bounce(frame: Frame, settings: SemanticSettings, strength: float) -> None:
    _halton(frame, settings.samples)
    bounced = {
        "samples": settings.samples,
        "radius": settings.near_radius * atom_radius(frame),
        "strength": strength,
        "limit": frame.screen_reach,
    }
    frame.compute_tiles("passes/semantic/bounce.wgsl", {"bounced": bounced})


def _occlude(frame: Frame, settings: SemanticSettings, near: float) -> None:
    _halton(frame, settings.samples)
    ssdo = {
        "samples": settings.samples,
        "near_radius": settings.near_radius * atom_radius(frame),
        "far_radius": settings.far_radius * distance_of(frame, settings),
        "strength": settings.strength,
        "near_weight": near,
        "limit": frame.screen_reach,
    }
    frame.compute_tiles(
        "passes/semantic/ssdo.wgsl",
        {"ssdo": ssdo},
        constants={"HAS_NEAR": near > 0, "PLAIN": settings.mode == "plain"},
    )


def _halton(frame: Frame, samples: int) -> None:
    """Bind ``halton_points``: each further frame takes the next points of the sequence."""
    first = 1 + int(frame.resources["view"]["frame"]) * samples

    def points() -> Any:
        return float_table(frame.gpu, halton_points(first, samples), "Halton points")

    frame.resources["halton_points"] = frame.targets.table("halton", (first, samples), points)


def halton_points(first: int, count: int) -> NDArray[np.float32]:
    """(count, 4) points ``first``, … of the Halton sequence in bases 2, 3 and 5 (equation 2.6)."""
    found = np.zeros((count, 4))
    for axis, base in enumerate((2, 3, 5)):
        rest, digit = np.arange(first, first + count), 1.0
        while rest.any():
            digit /= base
            found[:, axis] += rest % base * digit
            rest //= base
    return found.astype(np.float32)


def _trace(frame: Frame, settings: SemanticSettings, near: float) -> None:
    """Occlusion in object space."""
    _halton(frame, settings.rays)
    rays = {
        "samples": settings.rays,
        "near_radius": settings.near_radius * atom_radius(frame),
        "far_radius": settings.far_radius * distance_of(frame, settings),
        "strength": settings.strength,
        "near_weight": near,
    }
    frame.compute_tiles(
        "passes/semantic/traced.wgsl",
        {"rays": rays},
        constants=_rays(frame) | {"HAS_NEAR": near > 0},
    )


def _rays(frame: Frame) -> dict[str, bool]:
    """Constants of rays between regions."""
    levels = frame.resources["levels"]
    groups = any(levels[name]["kind"] == BY_GROUP for name in ("here", "next"))
    return {"HAS_SKIPS": True, "HAS_GROUPS": groups}


def _shadow(frame: Frame, settings: SemanticSettings, strength: float) -> None:
    distance = distance_of(frame, settings)
    shader, constants = "passes/semantic/shadow.wgsl", {}
    shadow: dict[str, Any] = {"strength": strength}
    if settings.mode == "traced":
        shader, constants = "passes/semantic/traced_shadow.wgsl", _rays(frame)
    else:
        shadow |= {
            "steps": settings.shadow_steps,
            "reach": 0.5 * distance,
            "thickness": 0.25 * distance,
            "limit": frame.screen_reach,
        }
    frame.compute_tiles(
        shader, {"shadow": shadow, "edges": edges_uniform(frame)}, constants=constants
    )
