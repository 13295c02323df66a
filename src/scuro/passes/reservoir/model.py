"""A reservoir on the GPU: its cells, the values at their vertices, and which cells are seen."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.passes.reservoir.pack import COLUMN, PILLAR, PackedReservoir
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.style.transfer import TransferFunction

ENTRIES = 1024
"""Entries of the transfer function's tables."""

ROW = 65535 * 64
"""Threads along x of the passes over columns."""


class ReservoirModel:
    """Buffers of cells.wgsl.

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
        flag_words = packed.words * self.column_count
        fields, table, heights = packed.areal_grid()
        low, high = grid.bounds * (1, 1, exaggeration) - self.center
        self.bounds = np.stack([low, high])
        """(2, 3) in scene space."""
        self.uniform = {
            **fields,
            "columns": grid.dimensions[:2],
            "tolerance": packed.tolerance,
            "extent": float(np.linalg.norm(high - low) / 2),
            "flag_words": flag_words,
            "pad": 0,
            "z_range": (low[2], high[2]),
        }
        self.cells = packed
        self._geometry = {
            "pillars": gpu.buffer(_structs(packed.pillars, PILLAR), label="pillars"),
            "columns": gpu.buffer(_structs(packed.columns, COLUMN), label="columns"),
            "depths": gpu.buffer(packed.depths, label="corner depths"),
            "areal": gpu.buffer(table, label="areal grid"),
            "heights": gpu.buffer(heights, label="areal heights"),
        }
        self._values = gpu.buffer(8 * self.surfaces, label="vertex values")
        self._flags = gpu.buffer(8 * flag_words, label="cell flags")
        self.low, self.high = 0.0, 1.0
        self._visible: Any = None
        self.colors: Any = None

    @property
    def bytes(self) -> int:
        """GPU memory of cells, values and tables."""
        buffers = [*self._geometry.values(), self._values, self._flags]
        return sum(int(b.size) for b in buffers)

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
        whole = np.full(self.surfaces, -1, np.float32)
        whole[self.slots[held]] = share[held]
        # kept only while the passes run: vertices are all that rendering reads
        self._cell_values = self.gpu.buffer(whole, label="cell values")
        self._run("spread")
        self._mark()

    def set_transfer(self, transfer: TransferFunction, step: float) -> None:
        """Show through a transfer function, for samples ``step`` scene units apart."""
        table = transfer.table(self.low, self.high, ENTRIES)
        opacity = table[:, 3].astype(np.float64)
        extinction = -np.log1p(-opacity)
        steps = np.empty((2 * ENTRIES, 4), np.float32)
        steps[:ENTRIES, :3] = table[:, :3]
        steps[:ENTRIES, 3] = -np.expm1(-extinction * step / self.unit)
        # integrals over the value, by trapezoids, for whole segments at once
        weighted = np.concatenate([table[:, :3] * extinction[:, None], extinction[:, None]], 1)
        sums = np.cumsum((weighted[1:] + weighted[:-1]) / 2, axis=0)
        steps[ENTRIES] = 0
        steps[ENTRIES + 1 :] = sums
        self.extinction = extinction
        """(ENTRIES,) per :attr:`unit`."""
        self.colors = self.gpu.buffer(steps, label="transfer function")
        shown = np.concatenate([[0], np.cumsum(opacity > 0)]).astype(np.uint32)
        self._visible = self.gpu.buffer(shown, label="visible entries")
        self._mark()

    def _mark(self) -> None:
        if self._visible is not None:
            self._run("mark")

    def _run(self, entry: str) -> None:
        visible = self._visible or self.gpu.buffer(16)
        average = {
            "words": self.uniform["flag_words"],
            "column_words": self.column_words,
            "table_end": ENTRIES - 1,
            "pad": 0,
        }
        resources = self.resources | {
            "average": average,
            "cell_values": self._cell_values,
            "visible": visible,
        }
        threads = (min(self.column_count, ROW), -(-self.column_count // ROW))
        self.gpu.compute("passes/reservoir/average.wgsl", entry, threads, resources)


def _structs(table: NDArray, dtype: np.dtype) -> NDArray[np.uint32]:
    """A structured table as words."""
    return np.ascontiguousarray(table, dtype).view(np.uint32)
