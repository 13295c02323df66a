"""Monte-Carlo truth for cone occlusion and cone shadows in volumes (Campagnolo 2021, 3.1.1)."""

from __future__ import annotations

import math

from scuro.passes.volume.light import MOST_ITERATIONS
from scuro.passes.volume.march import March
from scuro.reference.volume_sums import RunningSums

GAP = 1.0
"""First sample of secondary rays, in mean voxel edges (the thesis's h₀ for Monte Carlo)."""

STEP = 0.5
"""Step of secondary rays, in mean voxel edges (h_s)."""

RAYS_A_DISPATCH = 4
"""Rays a cone in one dispatch: more take longer than some drivers allow a dispatch."""


def draw_monte_carlo(march: March, sums: RunningSums) -> None:
    """Record the volume's picture with every cone sampled by ``settings.samples`` rays.

    Args:
        march: Volume, settings (cones' angles and lengths, number of rays) and picture; constants
            ``OCCLUSION`` and ``SHADOWS`` beside those of march.wgsl.
        sums: The running sums.
    """
    shader = "reference/volume_cones.wgsl"
    grid, settings = march.grid, march.settings
    reaches = [k.length * grid.diagonal for k in (settings.occlusion, settings.shadow)]
    truth = {
        "sines": [math.sin(math.radians(k.angle)) for k in (settings.occlusion, settings.shadow)],
        "reaches": reaches,
        "total": settings.samples,
        "seed": 0,
        "gap": GAP * grid.voxel,
        "step": STEP * grid.voxel,
    }
    lights = sum(light["shadow"] >= 0 for light in march.resources["lights"]["list"])
    steps = [min(reach, grid.diagonal) / (STEP * grid.voxel) for reach in reaches]
    a_sample = steps[0] * settings.occlusion.on + steps[1] * lights * settings.shadow.on
    piece = max(1, int(MOST_ITERATIONS / (RAYS_A_DISPATCH * max(a_sample, 1.0))))
    pieces = math.ceil(grid.diagonal / march.spacing / piece) + 1
    batches = list(sums.missing(march.key, march.size, settings.samples, RAYS_A_DISPATCH))

    def compute(entry: str, **now: int) -> None:
        bound = {"sums": sums.buffer, "truth": truth | now}
        march.compute(shader, entry, bound, constants={"PIECE": piece}, label="volume truth")

    for i in range(pieces):
        for first, rays in batches:
            last = first + rays == settings.samples
            compute("main", first=first, rays=rays, piece=i, last=int(last))
    compute("finish", first=0, rays=0, piece=0, last=0)
