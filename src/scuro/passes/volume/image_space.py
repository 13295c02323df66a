"""Cones from every sample of every ray of the picture (Campagnolo 2021, 3.3.1 and 3.3.2)."""

from __future__ import annotations

import math
from typing import Any

from scuro.passes.volume.light import MOST_ITERATIONS, iterations
from scuro.passes.volume.march import March


def state_bytes(size: tuple[int, int]) -> int:
    """Size of the buffer in which rays of a picture go from one piece to the next."""
    return 32 * size[0] * size[1]


def draw_cones(march: March, state: Any) -> None:
    """Record the picture, its rays in pieces that no adapter ends before they are done.

    Args:
        march: Volume, settings (the step) and picture.
        state: Buffer of :func:`state_bytes`.
    """
    kinds = march.resources["cones"]["kinds"]
    piece = max(1, MOST_ITERATIONS // iterations(kinds, march.resources))
    for i in range(math.ceil(march.grid.diagonal / march.spacing / piece)):
        march.compute(
            "passes/volume/raycast_cones.wgsl",
            "main",
            {"pieces": {"index": i}, "sums": state},
            constants={"PIECE": piece},
            label="volume",
        )
