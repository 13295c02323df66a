"""The finished picture of a far view, smoothed by rays and spread as by a lens: less shimmer."""

from __future__ import annotations

import numpy as np

from scuro.passes.frame import Frame
from scuro.passes.post.fxaa import list_edges
from scuro.passes.semantic.levels import atom_radius
from scuro.passes.transparent.layers import opaque_only

CALM_FROM = 0.5
"""Nothing is calmed while a pixel's width holds fewer atoms than this (calm.wgsl, still.wgsl)."""
_SPREAD, _MOST = 1.0, 0.55
"""Deviation of the spread for each atom that a pixel's width holds, and the most; pixels."""


def is_far(frame: Frame) -> bool:
    """Whether any pixel may hold more than :data:`CALM_FROM` atoms side by side."""
    scene, camera = frame.accelerator, frame.camera
    farthest = float(np.linalg.norm(np.subtract(camera.position, scene.center))) + scene.extent
    across = 1.0 if camera.orthographic else farthest
    pixel = 2 * camera.half_height() * across / (frame.scale * frame.settings.size[1])
    return pixel >= CALM_FROM * 2 * atom_radius(frame)


def draw_still(frame: Frame) -> None:
    """Smooth edges by rays, and spread ``color``, where pixels hold many atoms.

    In place of FXAA, and only where it is asked for: without any smoothing of edges pixels stay as
    they were sampled, and supersampling needs no help.
    """
    settings = frame.settings
    calm = settings.semantic.calm
    off = settings.semantic.mode == "off" or settings.renderer == "path"
    if off or calm == 0 or settings.antialias.method != "fxaa" or not is_far(frame):
        return
    still = {"spread": _SPREAD * calm, "most": _MOST, "atom": 2 * atom_radius(frame)}
    list_edges(frame)
    color = frame.resources["color"]
    replaced = frame.target("replaced", "rgba16float", size=color.size[:2])
    frame.recorder.copy_texture(color, replaced)
    with opaque_only(frame):
        frame.compute(
            "passes/semantic/edges.wgsl",
            {"nearest": frame.gpu.nearest_sampler, "still": still},
            indirect=frame.resources["edge_count"],
            label="edges",
        )
    frame.resources["color"] = replaced
    frame.smoothed = True
    frame.replace_color("passes/semantic/still.wgsl", {"still": still}, tiles=True)
