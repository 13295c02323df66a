"""The finished picture of a far view, spread as a lens would: what is left of shimmer."""

from __future__ import annotations

import numpy as np

from scuro.passes.frame import Frame
from scuro.passes.post.fxaa import draw_fxaa
from scuro.passes.semantic.levels import atom_radius

CALM_FROM = 0.5
"""Nothing is calmed while a pixel's width holds fewer atoms than this (calm.wgsl, still.wgsl)."""
_SPREAD, _MOST = 0.35, 0.65
"""Deviation of the spread for each atom that a pixel's width holds, and the most; pixels."""


def is_far(frame: Frame) -> bool:
    """Whether any pixel may hold more than :data:`CALM_FROM` atoms side by side."""
    scene, camera = frame.accelerator, frame.camera
    farthest = float(np.linalg.norm(np.subtract(camera.position, scene.center))) + scene.extent
    across = 1.0 if camera.orthographic else farthest
    pixel = 2 * camera.half_height() * across / (frame.scale * frame.settings.size[1])
    return pixel >= CALM_FROM * 2 * atom_radius(frame)


def draw_still(frame: Frame) -> None:
    """Spread ``color`` where pixels hold many atoms.

    After FXAA, which mends outlines only while they are sharp. Without any smoothing of edges
    (``antialias.method`` none) pixels stay as they were sampled.
    """
    settings = frame.settings
    calm = settings.semantic.calm
    off = settings.semantic.mode == "off" or settings.renderer == "path"
    if off or calm == 0 or settings.antialias.method == "none" or not is_far(frame):
        return
    draw_fxaa(frame)
    frame.smoothed = True
    still = {"spread": _SPREAD * calm, "most": _MOST, "atom": 2 * atom_radius(frame)}
    frame.replace_color("passes/semantic/still.wgsl", {"still": still}, tiles=True)
