"""Frame times: how much smaller and coarser pictures must be while something moves."""

from __future__ import annotations

import math

GPU_TARGET, SOFTWARE_TARGET = 0.033, 0.100
"""Seconds a frame may take on a GPU and on a software adapter."""
SMALLEST = 0.2
"""Share of the full width and height below which resolution does not drop."""
_HOPELESS = 0.7
"""Where the smallest picture would have to be so much smaller, effects are left out."""
_STEPS = 20
"""Sizes are multiples of one in so many: a texture is kept for each while it is used."""
_AIM = 0.95
"""Share of the target that is aimed at: frames vary."""
_CALM = 1.25
"""The share grows only when frames are this much faster than the target, so that it rests."""


class Pacing:
    """Chooses the resolution of moving pictures to hold a frame time.

    Args:
        target: Seconds a frame may take.
    """

    def __init__(self, target: float) -> None:
        self.target = target
        self.beside = 0.0
        """Seconds a frame takes besides the picture: the panel, copying it to the screen."""
        self.scale = 0.5
        """Share of the full width and height."""
        self.plain = False
        """Whether effects are left out, too: even the smallest picture takes too long with them."""

    def begin(self) -> None:
        """Another scene: its pictures may take long, and the first one must not."""
        self.scale, self.plain = SMALLEST, False

    def measured(self, seconds: float) -> None:
        """Take note of how long the last moving picture took, at the present scale."""
        if seconds <= 0:
            return
        ratio = max(_AIM * self.target - self.beside, 0.2 * self.target) / seconds
        if 1 <= ratio < _CALM:
            return
        # time goes with the number of pixels; half the way at once keeps one slow frame from
        # collapsing the picture, while a picture far too slow must give way in one step
        wanted = self.scale * math.sqrt(ratio)
        if ratio > 1:
            wanted = self.scale + 0.5 * (wanted - self.scale)
        steps = math.floor(wanted * _STEPS + 1e-6) or 1
        self.scale = min(1.0, max(SMALLEST, steps / _STEPS))
        if wanted < _HOPELESS * SMALLEST and not self.plain:
            self.plain, self.scale = True, 0.5


def moving_size(size: tuple[int, int], scale: float) -> tuple[int, int]:
    """A picture's size at a scale, at least one pixel."""
    width, height = (max(1, round(s * scale)) for s in size)
    return width, height
