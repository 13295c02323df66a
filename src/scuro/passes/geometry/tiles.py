"""The tiles of the picture in which there may be a surface; see wgsl/tiles.wgsl."""

from __future__ import annotations

import numpy as np

from scuro.passes.frame import Frame

TILE = 8
MAX_TILES = 65535
"""One dispatch has at most so many workgroups along x: larger pictures are drawn in parts."""

_CLUSTERS_LIMIT = 1 << 20
"""With more clusters than this, instances stand for themselves."""

_RUNS_LIMIT = 128
"""So do they with more bodies than this: each body's clusters take a dispatch of their own."""


def find_tiles(frame: Frame) -> None:
    """Fill ``tile_list`` and ``tile_count`` for :meth:`Frame.compute_tiles`."""
    accelerator = frame.accelerator
    width, height = (-(-s // TILE) for s in frame.size)
    mask = frame.scratch("tile_mask", 4 * width * height)
    count = frame.scratch("tile_count", 16, indirect=True)
    frame.scratch("tile_list", 4 * width * height)
    frame.recorder.clear_buffer(mask)
    frame.gpu.write_buffer(count, np.array([0, 1, 1, 0], np.uint32))

    def run(entry: str, threads: int, **splat: float) -> None:
        uniform = {
            "clusters": 0, "first_cluster": 0, "first_instance": 0, "count": 0,
            "tiles": (width, height), "margin": 1.0 + frame.margin,
        } | splat  # fmt: skip
        rows = -(-threads // (64 * 65535))
        frame.compute(
            "passes/geometry/tiles.wgsl",
            {"splat": uniform},
            entry=entry,
            threads=(-(-threads // rows), rows),
            label="tiles",
        )

    runs = accelerator.cluster_runs
    if accelerator.cluster_instances <= _CLUSTERS_LIMIT and len(runs) <= _RUNS_LIMIT:
        for first_instance, copies, first, clusters in runs:
            run(
                "mark",
                copies * clusters,
                clusters=clusters,
                first_cluster=first,
                first_instance=first_instance,
                count=copies * clusters,
            )
    elif accelerator.instances:
        run("mark", accelerator.instances, count=accelerator.instances)
    run("gather", width * height)
