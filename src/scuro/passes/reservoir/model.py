"""A reservoir on the GPU: its cells, the values at their vertices, and which cells are seen."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.gpu.texel import TEXEL
from scuro.passes.reservoir.pack import PackedReservoir
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.style.transfer import TransferFunction

ENTRIES = 1024
"""Entries of the transfer function's tables."""

LONGEST_ROW = 13
"""Texels in a row of the tables are at most 2 to this: WebGPU's smallest limit."""

THREADS = 65535 * 64
"""Along x, of the passes over columns."""

NO_VALUE = 65535
"""Of a cell, among 16-bit steps of the property's range."""


class ReservoirModel:
    """Tables of cells.wgsl.

    The geometry is uploaded once. :meth:`set_values` replaces what depends on a property or a time
    step, :meth:`set_transfer` what depends on the transfer function; neither touches the rest.

    Args:
        gpu: Where to.
        grid: The model.
        center: World position of the scene's origin.
        exaggeration: Factor on heights.
    """

    def __init__(
        self, gpu: Gpu, grid: CornerPointGrid, center: NDArray, exaggeration: float
    ) -> None:
        self.gpu, self.grid = gpu, grid
        self.center, self.exaggeration = np.asarray(center, np.float64), exaggeration
        packed = PackedReservoir(grid, self.center, exaggeration)
        self.mean_extents = packed.mean_extents
        """(3,) mean extent of cells along i, j, k, in scene units."""
        self.surfaces, self.slots = packed.surfaces, packed.slots
        self.column_words, self.column_count = packed.words, len(packed.columns)
        fields, voxels, listed = packed.areal_grid()
        power = math.ceil(math.log2(max(self.surfaces, len(voxels), len(listed))) / 2)
        self._row = 1 << min(power, LONGEST_ROW)
        low, high = grid.bounds * (1, 1, exaggeration) - self.center
        self.bounds = np.stack([low, high])
        """(2, 3) in scene space."""
        self.uniform = {
            **fields,
            "columns": grid.dimensions[:2],
            "tolerance": packed.tolerance,
            "extent": float(np.linalg.norm(high - low) / 2),
            "z_range": (low[2], high[2]),
            "row_power": self._row.bit_length() - 1,
            "row_mask": self._row - 1,
        }
        self.cells = packed
        self._geometry = {
            "pillars": self._table(packed.pillars.view(np.float32).reshape(-1, 4), "rgba32float"),
            "columns": self._table(packed.columns.view(np.uint32).reshape(-1, 4), "rgba32uint"),
            "depths": self._table(packed.depths, "rgba16uint"),
            "voxels": self._table(voxels, "rgba32uint"),
            "areal": self._table(listed, "r32uint"),
        }
        self._values = self._empty(self.surfaces, "rgba16uint")
        self._flags = self._empty(packed.words * self.column_count, "rg32uint")
        self._cell_values: Any = None
        self.low, self.high = 0.0, 1.0
        self._visible: Any = None
        self.colors: Any = None

    def _empty(self, count: int, format: str) -> Any:
        """A texture for so many texels in rows of one length."""
        return self.gpu.texture(
            (self._row, max(1, -(-count // self._row))), format, label="reservoir"
        )

    def _table(self, data: NDArray, format: str) -> Any:
        """A texture of (n[, channels]) in rows of one length."""
        texture = self._empty(len(data), format)
        whole = np.zeros((self._row * texture.size[1], *data.shape[1:]), data.dtype)
        whole[: len(data)] = data
        self.gpu.write_texture(texture, whole.reshape(-1, self._row, *data.shape[1:]))
        return texture

    @property
    def bytes(self) -> int:
        """GPU memory of cells, values and tables."""
        tables = [*self._geometry.values(), self._values, self._flags, self._cell_values]
        return sum(texture_bytes(table) for table in tables if table is not None)

    @property
    def bytes_per_cell(self) -> float:
        """Of an active cell."""
        return self.bytes / self.grid.active_count

    @property
    def unit(self) -> float:
        """The length that a transfer function's opacities are given for: a cell's least extent."""
        return float(self.mean_extents.min())

    @cached_property
    def resources(self) -> dict[str, Any]:
        """What cells.wgsl wants bound."""
        return {
            **self._geometry,
            "values": self._values,
            "flags": self._flags,
            "model": self.uniform,
        }

    def set_values(
        self, values: NDArray[np.float32], low: float, high: float, chosen: NDArray | None = None
    ) -> None:
        """Show a property: carry its values to the vertices.

        Args:
            values: (n_active,); cells without a finite value are holes.
            low: Value at the transfer function's lower end.
            high: Value at its upper end.
            chosen: (n_active,) which cells to show at all; all of them by default.
        """
        self.low, self.high = low, high if high > low else low + 1.0
        share = np.clip((values - self.low) / (self.high - self.low), 0, 1)
        held = np.isfinite(values)
        if chosen is not None:
            held &= chosen
        whole = np.full(self.surfaces, NO_VALUE, np.uint16)
        whole[self.slots[held]] = np.rint(share[held] * (NO_VALUE - 1)).astype(np.uint16)
        self._cell_values = self._table(whole, "r16uint")
        self._run("spread", {"values": self._values})
        self._mark()

    def set_transfer(self, transfer: TransferFunction, step: float) -> None:
        """Show through a transfer function, for samples ``step`` scene units apart."""
        table = transfer.table(self.low, self.high, ENTRIES)
        opacity = table[:, 3].astype(np.float64)
        extinction = -np.log1p(-opacity)
        steps = np.zeros((3, ENTRIES, 4), np.float32)
        steps[0, :, :3] = table[:, :3]
        steps[0, :, 3] = -np.expm1(-extinction * step / self.unit)
        # integrals over the value, by trapezoids, for whole segments at once
        weighted = np.concatenate([table[:, :3] * extinction[:, None], extinction[:, None]], 1)
        sums = np.cumsum((weighted[1:] + weighted[:-1]) / 2, axis=0)
        steps[1, 1:] = sums
        steps[2] = weighted
        self.extinction = extinction
        """(ENTRIES,) per :attr:`unit`."""
        self.colors = self.gpu.texture_from(steps, "rgba32float")
        shown = np.concatenate([[0], np.cumsum(opacity > 0)]).astype(np.uint32)
        self._visible = self.gpu.texture_from(shown[None], "r32uint")
        self._mark()

    def _mark(self) -> None:
        if self._visible is not None and self._cell_values is not None:
            self._run(
                "mark",
                {
                    "mark": {"words": self.column_words, "table_end": ENTRIES - 1},
                    "visible": self._visible,
                    "values": self._values,
                    "flags": self._flags,
                },
            )

    def _run(self, shader: str, resources: dict[str, Any]) -> None:
        threads = (min(self.column_count, THREADS), -(-self.column_count // THREADS))
        self.gpu.compute(
            f"passes/reservoir/{shader}.wgsl",
            "main",
            threads,
            {
                **self._geometry,
                "model": self.uniform,
                "cell_values": self._cell_values,
                **resources,
            },
        )


def texture_bytes(texture: Any) -> int:
    """GPU memory of a texture without mips."""
    dtype, channels = TEXEL[texture.format]
    return int(np.prod(texture.size)) * channels * np.dtype(dtype).itemsize
