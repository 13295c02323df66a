"""The volume as a medium that scatters light many times: a path tracer by delta tracking.

The second truth beside the cones' Monte Carlo, and the more physical one: light comes from an
environment and from the lights, is attenuated by all matter on its way, and is scattered any number
of times by a Henyey-Greenstein phase function. Free paths are drawn by delta tracking (Woodcock et
al. 1965; Novák et al. 2018, section 4.1) with the largest extinction of the transfer function as
majorant. Unbiased up to the bounce limit.

A sample's color is its single-scattering albedo. A light of strength 1 is one by which a white
matte surface that faces it looks white, as everywhere in scuro: its irradiance is π.
"""

from __future__ import annotations

from scuro.passes.volume.march import March
from scuro.reference.volume_sums import RunningSums

PATHS_A_DISPATCH = 1
"""Paths a pixel in one dispatch: lavapipe ends loops after 65,535 iterations in all, silently."""

GRADIENT = 0.7
"""How much brighter a graded environment is above than in the middle (as reference/path.py's)."""


def draw_paths(march: March, sums: RunningSums) -> None:
    """Record the volume's picture, path traced with ``settings.samples`` paths a pixel.

    Args:
        march: Volume, settings (their group ``path``) and picture; lamps.wgsl is bound, too.
        sums: The running sums.
    """
    shader = "reference/volume_path.wgsl"
    settings, classified = march.settings, march.classified
    paths = {
        "majorant": max(float(classified.extinction.max()), 1e-6) / classified.grid.voxel,
        "anisotropy": settings.path.anisotropy,
        "bounces": settings.path.bounces,
        "gradient": GRADIENT if settings.path.environment == "gradient" else 0.0,
    }

    def compute(entry: str, **now: int) -> None:
        bound = {"sums": sums.buffer, "paths": paths | now}
        march.compute(shader, entry, bound, label="volume paths")

    for first, count in sums.missing(march.key, march.size, settings.samples, PATHS_A_DISPATCH):
        compute("main", first=first, count=count, total=1)
    compute("finish", first=0, count=0, total=settings.samples)
