"""A volume on the GPU: its samples as a half-float texture, its place, and its blocks' ranges."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError
from scuro.gpu import Gpu
from scuro.scene.clip import Clip
from scuro.scene.volume import Volume

BLOCK = 4
"""Edge of a block in voxels: the unit of empty-space skipping (volume.wgsl has the same)."""

UPLOAD_BYTES = 32 << 20
"""How much is converted to half-floats at a time."""


class VolumeGrid:
    """A volume's samples in a texture that filters on every adapter.

    Half-floats for all types: 8-bit textures are filtered with 8 bits on software adapters, which
    shows as bands, and 32-bit ones do not filter everywhere. Values are normalised to 0…1 over the
    volume's range (over 0…255 for 8-bit data).

    Args:
        gpu: Where to put it.
        volume: What to show.
        center: World position of the scene's origin.
        fill: Upload the samples at once; else :meth:`fill` does.
    """

    def __init__(self, gpu: Gpu, volume: Volume, center: NDArray, fill: bool = True) -> None:
        self.gpu = gpu
        self.volume = volume
        nz, ny, nx = volume.values.shape
        self.size = (nx, ny, nz)
        self.blocks = tuple(-(-n // BLOCK) for n in self.size)
        limit = int(gpu.device.limits["max-texture-dimension-3d"])
        if max(self.size) > limit:
            raise GpuError(
                f"{gpu.info.name} takes volumes of at most {limit} voxels a side, "
                f"not {'x'.join(map(str, self.size))}; load it with fewer voxels"
            )
        low, high = (0.0, 255.0) if volume.values.dtype == np.uint8 else volume.value_range
        self.low, self.high = low, high if high > low else low + 1.0
        # indices are voxel centers; texture coordinates run from face to face
        index_from_texture = np.diag([nx, ny, nz, 1.0])
        index_from_texture[:3, 3] = -0.5
        scene_from_world = np.eye(4)
        scene_from_world[:3, 3] = -np.asarray(center, np.float64)
        self.scene_from_texture = scene_from_world @ volume.world_from_index @ index_from_texture
        self.texture_from_scene = np.linalg.inv(self.scene_from_texture)
        self.voxel = float(volume.spacing.mean())
        self.diagonal = float(np.linalg.norm(volume.spacing * np.array(self.size)))
        self.texture = gpu.texture(self.size, "r16float", dimension="3d", label="the volume")
        self.ranges = gpu.buffer(4 * int(np.prod(self.blocks)), label="block ranges")
        """Smallest and largest value of every block and the voxels next to it."""
        if fill:
            for _ in self.fill():
                gpu.finish()  # or copies of all slabs wait in memory at once

    def fill(self, slab: int = UPLOAD_BYTES) -> Iterator[float]:
        """Upload the samples and find their ranges; yields the share that is done.

        Args:
            slab: Roughly how many bytes are converted to half-floats at a time.
        """
        values = self.volume.values
        layers = max(1, slab // (4 * BLOCK * self.size[0] * self.size[1]))
        scale = np.float32(1.0 / (self.high - self.low))
        count = self.blocks[2]
        for first in range(0, count, layers):
            z = BLOCK * first
            part = values[z : z + BLOCK * layers].astype(np.float32)
            part -= np.float32(self.low)
            part *= scale
            self.gpu.write_texture(self.texture, part.astype(np.float16), origin=(0, 0, z))
            yield 0.6 * min(first + layers, count) / count
        unused = self.gpu.buffer(16)
        for first in range(0, count, layers):
            planes = min(layers, count - first)
            self.gpu.compute(
                "passes/volume/classify.wgsl",
                "find_ranges",
                (*self.blocks[:2], planes),
                {
                    "params": self.block_params(table_end=1.0, first=first),
                    "samples": self.texture,
                    "ranges": self.ranges,
                    "shown": unused,
                    "source": unused,
                    "target_": self.gpu.buffer(16),
                },
            )
            yield 0.6 + 0.4 * (first + planes) / count

    def block_params(
        self, *, table_end: float, axis: int = 0, reach: int = 0, first: int = 0
    ) -> dict[str, Any]:
        """The uniform of classify.wgsl."""
        return {
            "size": self.size,
            "block": BLOCK,
            "blocks": self.blocks,
            "table_end": table_end,
            "axis": axis,
            "reach": reach,
            "first": first,
        }

    def uniform(self, step: float, clip: Clip, center: NDArray, table_end: float) -> dict[str, Any]:
        """The ``Volume`` uniform of volume.wgsl.

        Args:
            step: Distance between samples in mean voxel edges.
            clip: Half-spaces that are kept, in world units.
            center: World position of the scene's origin.
            table_end: Last index of the transfer function's tables.
        """
        cuts = clip.equations()
        cuts[:, 3] += cuts[:, :3] @ np.asarray(center, np.float64)
        return {
            "texture_from_scene": self.texture_from_scene,
            "scene_from_texture": self.scene_from_texture,
            "size": self.size,
            "voxel": self.voxel,
            "blocks": self.blocks,
            "step": step * self.voxel,
            "cuts": np.pad(cuts, ((0, 32 - len(cuts)), (0, 0))),
            "cut_count": len(cuts),
            "table_end": table_end,
            "edges": self.volume.spacing * np.array(self.size) / self.voxel,
        }
