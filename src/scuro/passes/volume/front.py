"""A volume's dense part as a surface, on which fog, halos and borders are drawn."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from scuro.passes.frame import Frame
from scuro.passes.geometry.tiles import TILE
from scuro.passes.post.cues import cues_reach

if TYPE_CHECKING:
    from scuro.scene.scene import Scene


@contextmanager
def volume_front(frame: Frame, scene: Scene) -> Iterator[None]:
    """While it lasts, ``surface`` shows the volume where it is dense, and tiles are everywhere."""
    settings = frame.settings
    planes = settings.volume.planes
    cues = cues_reach(settings, frame.px) or settings.fog.strength
    if not scene.volumes or not cues or (planes.on and planes.alone):
        yield
        return
    kept = dict(frame.resources)
    front = frame.target("front", "rgba32float")
    frame.compute("passes/volume/front.wgsl", {"front": front}, label="volume front")
    frame.resources |= {"surface": front, **_all_tiles(frame)}
    frame.outline = scene.volumes[0].outline
    yield
    for name in ("surface", "tile_list", "tile_count", "near_list", "near_count"):
        if name in kept:
            frame.resources[name] = kept[name]


def _all_tiles(frame: Frame) -> dict[str, object]:
    """Lists of every tile of the picture, for passes over surfaces and for those beside them."""
    width, height = (-(-s // TILE) for s in frame.size)
    y, x = np.divmod(np.arange(width * height, dtype=np.uint32), np.uint32(width))
    listed = frame.targets.buffer("front_tile_list", 4 * width * height)
    count = frame.targets.buffer("front_tile_count", 16, True)
    frame.gpu.write_buffer(listed, x | y << 16)
    frame.gpu.write_buffer(count, np.array([width * height, 1, 1, 0], np.uint32))
    return {f"{kind}_{part}": buffer for kind in ("tile", "near")
            for part, buffer in (("list", listed), ("count", count))}  # fmt: skip
