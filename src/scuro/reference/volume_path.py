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

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from scuro.gpu import Recorder
from scuro.reference.volume_sums import RunningSums

if TYPE_CHECKING:
    from scuro.passes.volume.classify import Classified
    from scuro.passes.volume.settings import VolumeSettings

PATHS_A_DISPATCH = 1
"""Paths a pixel in one dispatch: lavapipe ends loops after 65,535 iterations in all, silently."""

GRADIENT = 0.7
"""How much brighter a graded environment is above than in the middle (as reference/path.py's)."""


def draw_paths(
    record: Recorder,
    resources: Mapping[str, Any],
    constants: Mapping[str, Any],
    classified: Classified,
    settings: VolumeSettings,
    size: tuple[int, int],
    sums: RunningSums,
    key: Any,
) -> None:
    """Record the volume's picture, path traced with ``settings.samples`` paths a pixel.

    Args:
        record: Where to.
        resources: What passes/volume/march.wgsl and lamps.wgsl want bound.
        constants: Those of march.wgsl.
        classified: Volume and transfer function.
        settings: Paths a pixel, and the group ``path``.
        size: Width and height of the picture.
        sums: The running sums.
        key: Everything that the picture depends on but the number of samples.
    """
    shader = "reference/volume_path.wgsl"
    paths = {
        "majorant": max(float(classified.extinction.max()), 1e-6) / classified.grid.voxel,
        "anisotropy": settings.path.anisotropy,
        "bounces": settings.path.bounces,
        "gradient": GRADIENT if settings.path.environment == "gradient" else 0.0,
    }
    for first, count in sums.missing(key, size, settings.samples, PATHS_A_DISPATCH):
        bound = {**resources, "paths": {**paths, "first": first, "count": count, "total": 1}}
        bound["sums"] = sums.buffer
        record.compute(shader, "main", size, bound, constants, label="volume paths")
    bound = {**resources, "paths": {**paths, "first": 0, "count": 0, "total": settings.samples}}
    bound["sums"] = sums.buffer
    record.compute(shader, "finish", size, bound, constants, label="volume paths")
