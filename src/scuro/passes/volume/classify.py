"""A transfer function on the GPU: its tables, and which blocks of the volume it leaves empty."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.volume.grid import VolumeGrid
from scuro.style.transfer import TransferFunction

ENTRIES = 1024
"""Entries of the tables."""

REACH = 31
"""Largest empty distance that is told, in blocks."""


class Classified:
    """A volume as a transfer function shows it.

    Args:
        grid: The volume.
        transfer: The transfer function.
        step: Distance between samples along primary rays, in mean voxel edges.
        iso: Data value of the isosurface shown instead, if any.
    """

    def __init__(
        self, grid: VolumeGrid, transfer: TransferFunction, step: float, iso: float | None = None
    ) -> None:
        self.grid = grid
        self.gpu = grid.gpu
        table = transfer.table(grid.low, grid.high, ENTRIES)
        if iso is not None:
            # everything above the isovalue is solid, in the color that the isovalue has
            values = np.linspace(grid.low, grid.high, ENTRIES)
            table[:, 3] = np.where(values >= iso, 0.999, 0.0)
        opacity = table[:, 3].astype(np.float64)
        self.extinction: NDArray[np.float64] = -np.log1p(-opacity)
        table[:, 3] = self.extinction
        # textures, not buffers: software adapters load from them several times faster
        self.colors = self.gpu.texture_from(table[None], "rgba32float")
        corrected = -np.expm1(-self.extinction * step)
        self.step_opacity = self.gpu.texture_from(corrected[None], "r32float")
        voxel_opacity = -np.expm1(-self.extinction)
        self.voxel_opacity = self.gpu.texture_from(voxel_opacity[None], "r32float")
        self.iso = None if iso is None else (iso - grid.low) / (grid.high - grid.low)

    @property
    def table_end(self) -> float:
        return ENTRIES - 1.0

    @cached_property
    def distances(self) -> Any:
        """Buffer: for every block, the Chebyshev distance in blocks to the nearest occupied one."""
        grid, gpu = self.grid, self.gpu
        if self.iso is None:
            visible = self.extinction > 0
        else:
            # blocks that the surface crosses or fills
            visible = np.linspace(0, 1, ENTRIES) >= self.iso
        shown = np.concatenate([[0], np.cumsum(visible)]).astype(np.uint32)
        count = int(np.prod(grid.blocks))
        now, other = gpu.buffer(4 * count), gpu.buffer(4 * count, label="empty distances")
        resources = {
            "samples": grid.texture,
            "ranges": grid.ranges,
            "shown": gpu.buffer(shown),
        }
        record = gpu.recorder()
        shader = "passes/volume/classify.wgsl"
        params = grid.block_params(table_end=self.table_end, reach=REACH)
        record.compute(
            shader,
            "find_occupied",
            grid.blocks,
            {**resources, "params": params, "source": other, "target_": now},
            label="empty space",
        )
        for axis in range(3):
            params = grid.block_params(table_end=self.table_end, axis=axis, reach=REACH)
            record.compute(
                shader,
                "spread",
                grid.blocks,
                {**resources, "params": params, "source": now, "target_": other},
                label="empty space",
            )
            now, other = other, now
        record.submit()
        return now

    def resources(self) -> dict[str, Any]:
        """What volume.wgsl wants bound, but for the uniform."""
        return {
            "samples": self.grid.texture,
            "trilinear": self.gpu.level_sampler,
            "value_sampler": self.gpu.nearest_sampler
            if self.grid.volume.labels
            else self.gpu.level_sampler,
            "colors": self.colors,
            "step_opacity": self.step_opacity,
            "distances": self.distances,
        }
