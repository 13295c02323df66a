"""Passes over tiles a few tiles at a time, for pictures that somebody waits beside.

A pass of thousands of rays a pixel takes minutes, and nothing can be asked of a GPU meanwhile. Cut
into pieces it gives way between them; each tile is worked on as before, so the picture is the same.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from scuro.passes.frame import Frame

PIECE = 0.05
"""Seconds that a piece should take."""
FIRST = 8
"""Tiles of a pass's first piece: two cores take 0.1 s for them at 4,096 rays a pixel."""
_GROWTH = 8
"""The next piece has at most so many times the tiles."""


def run_in_pieces(
    frame: Frame,
    record: Callable[[dict[str, Any], Any], None],
    clock: Callable[[], float] = time.perf_counter,
) -> None:
    """Run a pass over ``tile_list`` piece by piece; :attr:`Frame.breathe` is called between them.

    Args:
        frame: What is drawn; all that it has recorded is submitted.
        record: Records the pass, given the resources that replace the frame's and the buffer with
            the count of workgroups.
        clock: Seconds, for tests.
    """
    assert frame.breathe is not None
    gpu, recorder = frame.gpu, frame.recorder
    recorder.flush()
    total = int(gpu.read_buffer(frame.resources["tile_count"], np.uint32)[0])
    listed = gpu.read_buffer(frame.resources["tile_list"], np.uint32)[:total]
    # mixed, so that what a few tiles take tells of the others: dear ones lie beside each other
    listed = np.random.default_rng(0).permutation(listed)
    piece = frame.targets.buffer("piece_list", 4 * len(listed))
    count = frame.targets.buffer("piece_count", 16, indirect=True)
    done, tiles = 0, FIRST
    while done < total:
        tiles = min(tiles, total - done)
        gpu.write_buffer(count, np.array([tiles, 1, 1, 0], np.uint32))
        gpu.write_buffer(piece, listed[done : done + tiles])
        record({"tile_list": piece}, count)
        start = clock()
        recorder.flush()
        gpu.finish()
        seconds = max(clock() - start, 1e-6)
        done += tiles
        tiles = max(1, min(round(tiles * PIECE / seconds), _GROWTH * tiles))
        frame.breathe(done / total)
