"""Monte-Carlo truth for cone occlusion and cone shadows in volumes (Campagnolo 2021, 3.1.1)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from scuro.gpu import Recorder
from scuro.reference.volume_sums import RunningSums

if TYPE_CHECKING:
    from scuro.passes.volume.grid import VolumeGrid
    from scuro.passes.volume.settings import VolumeSettings

GAP = 1.0
"""First sample of secondary rays, in mean voxel edges (the thesis's h₀ for Monte Carlo)."""

STEP = 0.5
"""Step of secondary rays, in mean voxel edges (h_s)."""

RAYS_A_DISPATCH = 4
"""Rays a cone in one dispatch: more take longer than some drivers allow a dispatch."""


def draw_monte_carlo(
    record: Recorder,
    resources: Mapping[str, Any],
    constants: Mapping[str, Any],
    grid: VolumeGrid,
    settings: VolumeSettings,
    size: tuple[int, int],
    sums: RunningSums,
    key: Any,
) -> None:
    """Record the volume's picture with every cone sampled by ``settings.samples`` rays.

    Args:
        record: Where to.
        resources: What passes/volume/lit.wgsl wants bound.
        constants: ``OCCLUSION``, ``SHADOWS`` and those of march.wgsl.
        grid: The volume.
        settings: Cones' angles and lengths, and the number of rays.
        size: Width and height of the picture.
        sums: The running sums.
        key: Everything that the picture depends on but the number of samples.
    """
    shader = "reference/volume_cones.wgsl"
    truth = {
        "sines": [math.sin(math.radians(k.angle)) for k in (settings.occlusion, settings.shadow)],
        "reaches": [k.length * grid.diagonal for k in (settings.occlusion, settings.shadow)],
        "total": settings.samples,
        "seed": 0,
        "gap": GAP * grid.voxel,
        "step": STEP * grid.voxel,
    }
    bound = {**resources, "truth": {**truth, "first": 0, "rays": 0}}
    for first, rays in sums.missing(key, size, settings.samples, RAYS_A_DISPATCH):
        now = {**truth, "first": first, "rays": rays}
        bound = {**resources, "truth": now, "sums": sums.buffer}
        record.compute(shader, "main", size, bound, constants, label="volume truth")
    bound["sums"] = sums.buffer
    record.compute(shader, "finish", size, bound, constants, label="volume truth")
