"""Monte-Carlo truth for cone occlusion and cone shadows in volumes (Campagnolo 2021, 3.1.1)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from scuro.gpu import Recorder
from scuro.passes.volume.light import MOST_ITERATIONS
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
    reaches = [k.length * grid.diagonal for k in (settings.occlusion, settings.shadow)]
    truth = {
        "sines": [math.sin(math.radians(k.angle)) for k in (settings.occlusion, settings.shadow)],
        "reaches": reaches,
        "total": settings.samples,
        "seed": 0,
        "gap": GAP * grid.voxel,
        "step": STEP * grid.voxel,
    }
    lights = sum(light["shadow"] >= 0 for light in resources["lights"]["list"])
    steps = [min(reach, grid.diagonal) / (STEP * grid.voxel) for reach in reaches]
    a_sample = steps[0] * settings.occlusion.on + steps[1] * lights * settings.shadow.on
    piece = max(1, int(MOST_ITERATIONS / (RAYS_A_DISPATCH * max(a_sample, 1.0))))
    pieces = math.ceil(grid.diagonal / (settings.step * grid.voxel) / piece) + 1
    constants = {**constants, "PIECE": piece}
    batches = list(sums.missing(key, size, settings.samples, RAYS_A_DISPATCH))
    bound = {**resources, "sums": sums.buffer}
    for i in range(pieces):
        for first, rays in batches:
            last = first + rays == settings.samples
            now = {**truth, "first": first, "rays": rays, "piece": i, "last": int(last)}
            record.compute(
                shader, "main", size, {**bound, "truth": now}, constants, label="volume truth"
            )
    done = {**truth, "first": 0, "rays": 0, "piece": 0, "last": 0}
    record.compute(
        shader, "finish", size, {**bound, "truth": done}, constants, label="volume truth"
    )
