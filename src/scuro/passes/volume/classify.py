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
        iso: Data value of the isosurface shown instead, if any.
    """

    def __init__(
        self, grid: VolumeGrid, transfer: TransferFunction, iso: float | None = None
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
        self.integrals = self.gpu.texture_from(_integrals(self.extinction)[None], "rgba32float")
        voxel_opacity = -np.expm1(-self.extinction)
        self.voxel_opacity = self.gpu.texture_from(voxel_opacity[None], "r32float")
        self.iso = None if iso is None else (iso - grid.low) / (grid.high - grid.low)

    @property
    def table_end(self) -> float:
        return ENTRIES - 1.0

    @property
    def ready(self) -> bool:
        """Whether :attr:`distances` were found."""
        return "distances" in self.__dict__

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
            "integrals": self.integrals,
            "distances": self.distances,
        }


def _integrals(extinction: NDArray[np.float64]) -> NDArray[np.float32]:
    """(ENTRIES, 4) what segments.wgsl takes differences of; see volume.wgsl for the columns.

    The first integral comes as two single-precision numbers: differences of one would drown thin
    matter whose values lie beyond those of dense matter.
    """
    entry = np.arange(len(extinction), dtype=np.float64)
    moment = extinction * entry

    def summed(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2)])

    total = summed(extinction)
    coarse = total.astype(np.float32)
    fine = total - coarse
    return np.stack([coarse, fine, extinction, summed(moment)], axis=1).astype(np.float32)
