"""The tiles of the picture in which there may be a surface; see wgsl/tiles.wgsl."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scuro.passes.frame import Frame
from scuro.passes.post.cues import cues_reach

TILE = 8
MAX_TILES = 65535
"""One dispatch has at most so many workgroups along x: larger pictures are drawn in parts."""

_CLUSTERS_LIMIT = 1 << 20
"""With more clusters than this, instances stand for themselves."""

_RUNS_LIMIT = 128
"""So do they with more bodies than this: each body's clusters take a dispatch of their own."""


def find_tiles(frame: Frame, name: str = "tile") -> None:
    """Fill ``tile_list`` and ``tile_count`` for :meth:`Frame.compute_tiles`.

    ``near_list`` and ``near_count`` are of the tiles in which depth cues may draw, if there are any
    that draw beside surfaces.

    Args:
        frame: What is drawn; its context, too, once that is.
        name: Of the buffers, to keep what an earlier call filled for passes already recorded.
    """
    width, height = (-(-s // TILE) for s in frame.size)
    buffer = frame.targets.buffer
    reach = cues_reach(frame.settings, frame.px)
    tiles = 4 * width * height
    mask = buffer(f"{name}_mask", 2 * tiles if reach else tiles)
    lists = {"tile_mask": mask}
    for kind, size in (("tile", tiles), ("near", tiles if reach else 4)):
        count = buffer(f"{name}_{kind}_count", 16, indirect=True)
        frame.gpu.write_buffer(count, np.array([0, 1, 1, 0], np.uint32))
        lists |= {f"{kind}_count": count, f"{kind}_list": buffer(f"{name}_{kind}_list", size)}
    frame.resources |= lists
    frame.recorder.clear_buffer(mask)

    def run(drawn: Frame, entry: str, threads: int, **splat: float) -> None:
        uniform = {
            "clusters": 0, "first_cluster": 0, "first_instance": 0, "count": 0,
            "tiles": (width, height), "margins": (1.0, 1.0 + reach),
        } | splat  # fmt: skip
        rows = -(-threads // (64 * 65535))
        drawn.compute(
            "passes/geometry/tiles.wgsl",
            lists | {"splat": uniform},
            entry=entry,
            constants={"CUES": bool(reach)},
            threads=(-(-threads // rows), rows),
            label="tiles",
        )

    for drawn in (frame, frame.context):
        if drawn is not None:
            _mark(drawn, run)
    run(frame, "gather", width * height)


def _mark(drawn: Frame, run: Callable[..., None]) -> None:
    """Mark the tiles of one accelerator's clusters, or of its instances."""
    accelerator = drawn.accelerator
    runs = accelerator.cluster_runs
    if accelerator.cluster_instances <= _CLUSTERS_LIMIT and len(runs) <= _RUNS_LIMIT:
        for first_instance, copies, first, clusters in runs:
            run(
                drawn,
                "mark",
                copies * clusters,
                clusters=clusters,
                first_cluster=first,
                first_instance=first_instance,
                count=copies * clusters,
            )
        whole: tuple[tuple[int, int], ...] = (accelerator.frame_run,)
    else:
        whole = accelerator.whole_runs
    for first, count in whole:
        if count:
            run(drawn, "mark", count, first_instance=first, count=count)
