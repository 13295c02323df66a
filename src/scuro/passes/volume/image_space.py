"""Cones from every sample of every ray of the picture (Campagnolo 2021, 3.3.1 and 3.3.2)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from scuro.gpu import Recorder
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.light import MOST_ITERATIONS, iterations
from scuro.passes.volume.settings import VolumeSettings


def state_bytes(size: tuple[int, int]) -> int:
    """Size of the buffer in which rays of a picture go from one piece to the next."""
    return 32 * size[0] * size[1]


def draw_cones(
    record: Recorder,
    resources: Mapping[str, Any],
    constants: Mapping[str, Any],
    grid: VolumeGrid,
    settings: VolumeSettings,
    state: Any,
) -> None:
    """Record the picture, its rays in pieces that no adapter ends before they are done.

    Args:
        record: Where to.
        resources: What lit.wgsl, march.wgsl and illumination.wgsl want bound.
        constants: Theirs.
        grid: The volume.
        settings: The step.
        state: Buffer of :func:`state_bytes`.
    """
    size = resources["march"]["width"], resources["march"]["height"]
    piece = max(1, MOST_ITERATIONS // iterations(resources["cones"]["kinds"], resources))
    samples = grid.diagonal / (settings.step * grid.voxel)
    for i in range(math.ceil(samples / piece)):
        record.compute(
            "passes/volume/raycast_cones.wgsl",
            "main",
            size,
            {**resources, "pieces": {"index": i}, "sums": state},
            {**constants, "PIECE": piece},
            label="volume",
        )
