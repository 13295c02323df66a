"""Sums over samples that a further frame of the same picture adds to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from scuro.gpu import Gpu


class RunningSums:
    """The buffer of a progressive volume picture and how many samples are in it.

    Args:
        gpu: Where to put it.
    """

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._key: Any = None
        self._samples = 0
        self.buffer: Any = None

    def missing(
        self, key: Any, size: tuple[int, int], wanted: int, most: int
    ) -> Iterator[tuple[int, int]]:
        """First sample and number of samples of every dispatch that is still to come.

        Args:
            key: Everything that the picture depends on but the number of samples.
            size: Width and height of the picture.
            wanted: Samples a pixel.
            most: Samples a pixel and dispatch.
        """
        if (key, size) != self._key or self._samples > wanted:
            if self._key is None or size != self._key[1]:
                # 32 bytes a pixel: linear color and opacity, depth and how often it was met
                self.buffer = self._gpu.buffer(32 * size[0] * size[1], label="volume sums")
            self._key, self._samples = (key, size), 0
        while self._samples < wanted:
            count = min(most, wanted - self._samples)
            yield self._samples, count
            self._samples += count
