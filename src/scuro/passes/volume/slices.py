"""Directional occlusion by slices of the volume, front to back (Schott et al. 2009): a peer.

Planes that face the viewer are composited one after the other. A buffer of openness goes with
them: before each plane it is blurred by the disc that the occlusion cone cuts out of the plane
before, and after it the plane's own matter is taken away. Many small blurs spread with the square
root of their number, where a cone spreads with the distance, so that the angle at which this
resembles a cone is another one: the thesis fitted it by hand (section 3.5.1),
``volume.occlusion.slice_angle`` here.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from scuro.gpu import Gpu
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.march import March


class SliceBuffers:
    """What slices of one picture size need."""

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.openness = [gpu.texture(size, "r32float", label="slices' openness") for _ in range(2)]
        self.sums = gpu.buffer(16 * size[0] * size[1], label="slices' color")
        self.seen = gpu.buffer(4 * size[0] * size[1], label="slices' depth")


def draw_slices(march: March, buffers: SliceBuffers) -> None:
    """Record the volume's picture by slices ``settings.step`` apart.

    Args:
        march: Volume, settings (angle, attenuation and step) and picture.
        buffers: For pictures of that size.
    """
    shader = "passes/volume/slices.wgsl"
    occlusion, spacing = march.settings.occlusion, march.spacing
    depths, low, high = _extent(march.grid, march.resources["view"], march.size)
    angle = occlusion.angle if occlusion.slice_angle is None else occlusion.slice_angle
    fields = {
        "low": low,
        "high": high,
        "spacing": spacing,
        "radius": spacing * math.tan(math.radians(angle)),
        "attenuation": occlusion.attenuation,
    }
    record = march.record
    record.clear_buffer(buffers.sums)
    record.clear_buffer(buffers.seen)

    def bound(depth: float, first: bool, now: int) -> dict[str, Any]:
        return {
            "sums": buffers.sums,
            "seen": buffers.seen,
            "slice": {**fields, "depth": depth, "first": int(first)},
            "openness": buffers.openness[now],
            "openness_after": buffers.openness[1 - now],
        }

    near, far = depths or (0.0, 0.0)
    part = high[0] - low[0], high[1] - low[1]
    for i in range(math.ceil((far - near) / spacing)):
        one = bound(near + (i + 0.5) * spacing, i == 0, i % 2)
        march.compute(shader, "main", one, size=part, label="volume slices")
    march.compute(shader, "finish", bound(far, False, 0), label="volume slices")


def _extent(
    grid: VolumeGrid, view: Mapping[str, Any], size: tuple[int, int]
) -> tuple[tuple[float, float] | tuple[()], tuple[int, int], tuple[int, int]]:
    """Nearest and farthest depth of the volume, and the pixels that may see it; () if none."""
    corners = np.array([[*c, 1.0] for c in itertools.product((0.0, 1.0), repeat=3)])
    scene = corners @ grid.scene_from_texture.T
    x, y, z, _ = (scene @ np.asarray(view["view_from_scene"], np.float64).T).T
    depth = -z
    far = float(depth.max())
    if far <= 0:
        return (), (0, 0), size
    if not view["orthographic"] and depth.min() <= 0:  # the eye is inside or beside the volume
        return (0.0, far), (0, 0), size
    scale = np.ones_like(depth) if view["orthographic"] else depth
    place = np.stack([x, -y]) / scale / np.reshape(view["half_extent"], (2, 1)) * 0.5 + 0.5
    pixel = place * np.reshape(view["size"], (2, 1)) - np.reshape(view["origin"], (2, 1))
    low = np.clip(np.floor(pixel.min(axis=1)) - 1, 0, size).astype(int)
    high = np.clip(np.ceil(pixel.max(axis=1)) + 1, 0, size).astype(int)
    if (high <= low).any():
        return (), (0, 0), size
    return (max(float(depth.min()), 0.0), far), tuple(low.tolist()), tuple(high.tolist())
