"""Sorting primitives and instances into the cells of their grids, on the GPU.

A counting sort in three kernels (``build.wgsl``); the prefix sum between them is numpy's, in a
thread. All in steps short enough for a window to draw between them.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.steps import in_thread, scaled
from scuro.trace.clear import clear_directions
from scuro.trace.grids import GridPlan
from scuro.trace.table import empty_table, padded_bytes, table_from_buffers

STEP = 1 << 17
"""Primitives, instances or cells that are sorted in one step."""
_WRITTEN = 1 << 20
"""Starts of cells that are handed over in one step."""
_COPIED = 2 * STEP
"""Cells or entries that are copied in one step."""
_CLEARED = 256
"""In so many grids at most rays are told where nothing lies ahead: each takes milliseconds."""
_EMPTY = 0x80000000
_CELL_BITS = 31
"""Of a cell that lists instances: its first entry and the span of their objects."""


def build_grids(
    gpu: Gpu, plan: GridPlan, slots: Any, instances: Any
) -> Generator[float, None, tuple[dict[str, Any], dict[str, int]]]:
    """The ``walked`` and ``refs`` tables of all grids together (wgsl/scene.wgsl), in steps.

    Args:
        gpu: Where to.
        plan: The grids.
        slots: Table of the primitives.
        instances: Table of the instances.

    Returns:
        The tables, and fields of the ``scene`` uniform by which they are read: ``refs_from``, what
        the number of an entry of ``walked`` is less than that of its reference (modulo 2³²), and
        how cells over instances tell the objects that they list.
    """
    sorter = _Sorter(gpu, plan, slots, instances)
    listing, spans = yield from scaled(sorter.list_instances(), 0.0, 0.2)
    walked, refs = yield from scaled(sorter.sort_primitives(), 0.2, 1.0)
    table = table_from_buffers(gpu, [listing, refs])
    first = listing.size // 4 - plan.cells
    yield 1.0
    return {"walked": walked, "refs": table}, {"refs_from": first % (1 << 32), **spans}


class _Sorter:
    """What the kernels share."""

    def __init__(self, gpu: Gpu, plan: GridPlan, slots: Any, instances: Any) -> None:
        self.gpu, self.plan = gpu, plan
        self.resources = {
            "items": gpu.buffer(16, label="no primitives to sort"),
            "grids": gpu.buffer(plan.grids, label="grids"),
            "slots": slots,
            "instances": instances,
            "supports": gpu.buffer(plan.supports, label="supports"),
        }

    def _run(self, entry: str, threads: int, **build: float) -> None:
        """One dispatch of a kernel."""
        growth = self.plan.growth
        uniform = {"first": 0, "grid": 0, "base": 0, "factor": growth.factor}
        uniform |= {"margin": growth.margin, "reach": self.plan.farthest, "count": threads}
        uniform |= {"support_edge": self.plan.supports.shape[1], "span_bits": 0, "span_shift": 0}
        uniform |= build
        code = self.plan.encoding
        uniform |= code.uniform(inner=uniform["grid"] > 0)
        resources = self.resources | {"build": uniform}
        self.gpu.compute("trace/build.wgsl", entry, (threads,), resources, constants=code.constants)

    def _sort(
        self, entry: str, steps: list[Any], cells: int, base: int, first: int
    ) -> Generator[float, None, tuple[Any, NDArray[np.int64]]]:
        """Count, sum up and fill; the filled references and how many each cell has.

        Args:
            entry: Kernel that visits the items of a step.
            steps: For each its arguments, or a function that prepares for it and gives them.
            cells: Cells of all grids.
            base: Number of the first entry of the first cell.
            first: Entries before the first in the buffer of references.
        """
        gpu, resources = self.gpu, self.resources
        resources["counts"] = gpu.buffer(4 * cells, label="grid counts")
        resources["cells"] = gpu.buffer(4 * cells, label="grid cells")
        resources["refs"] = gpu.buffer(16, label="no references yet")
        for number, step in enumerate(steps):
            self._run(f"count_{entry}", **(step() if callable(step) else step))
            yield 0.4 * (number + 1) / len(steps)
        lengths = gpu.read_buffer(resources["counts"], np.uint32)[:cells]
        starts, total = yield from scaled(in_thread(lambda: _summed(lengths, base)), 0.4, 0.5)
        yield 0.5
        resources["refs"] = gpu.buffer(padded_bytes(first + total), label="grid references")
        for start in range(0, cells, _WRITTEN):
            here = starts[start : start + _WRITTEN]
            gpu.write_buffer(resources["cells"], here, offset=4 * start)
            yield 0.5
        recorder = gpu.recorder()
        recorder.clear_buffer(resources["counts"])
        recorder.submit()
        for number, step in enumerate(steps):
            arguments = step() if callable(step) else step
            self._run(f"fill_{entry}", base=base - first, **arguments)
            yield 0.5 + 0.4 * (number + 1) / len(steps)
        for start in range(0, cells, STEP):
            count = min(STEP, cells - start)
            self._run("finish", count, base=base - first, first=start)
            yield 0.9 + 0.1 * (start + count) / cells
        return starts, lengths

    def list_instances(self) -> Generator[float, None, tuple[Any, dict[str, int]]]:
        """The buffer that becomes the front of ``refs``: all cells of the grids over instances,
        then what they list. And how cells tell the objects of what they list."""
        plan, gpu = self.plan, self.gpu
        cells = plan.listing_cells
        steps = [
            {"threads": min(STEP, first + number - start), "first": start, "grid": grid}
            for grid, runs in enumerate(plan.listed)
            for first, number in runs
            for start in range(first, first + number, STEP)
        ]
        starts, lengths = yield from scaled(
            self._sort("instances", steps, cells, cells, cells), 0.0, 0.9
        )
        # an empty cell tells where nothing lies ahead, another where its list begins
        empty = lengths == 0
        finding = in_thread(lambda: _clear_directions(plan.grids[: plan.over], empty))
        clear = yield from finding
        gpu.write_buffer(self.resources["refs"], np.where(empty, _EMPTY | clear, starts))
        spans = _spans(cells + int(lengths.sum(dtype=np.int64)), len(plan.supports))
        for start in range(0, cells, STEP):
            count = min(STEP, cells - start)
            self._run("span_objects", count, first=start, **spans)
            yield 0.9 + 0.1 * (start + count) / cells
        return self.resources["refs"], spans

    def _items(self) -> Iterator[NDArray[np.uint32]]:
        """Steps of primitives and their grids, (n, 2) each."""
        plan = self.plan
        waiting: list[NDArray] = []
        count = 0
        slots = list(plan.first_slots.values())
        for number, primitives in enumerate(plan.primitives):
            for start in range(0, len(primitives), STEP):
                part = primitives[start : start + STEP] + np.uint32(slots[number])
                grid = np.full(len(part), plan.over + number, np.uint32)
                waiting.append(np.stack([part, grid], 1))
                count += len(part)
                if count >= STEP:
                    yield np.concatenate(waiting)
                    waiting, count = [], 0
        if waiting:
            yield np.concatenate(waiting)

    def sort_primitives(self) -> Generator[float, None, tuple[Any, Any]]:
        """The table ``walked``, and the buffer of what its entries refer to."""
        plan, gpu = self.plan, self.gpu
        cells = plan.cells
        steps: list[Any] = []
        for items in self._items():
            buffer = gpu.buffer(items, label="primitives to sort")

            def visit(buffer: Any = buffer, count: int = len(items)) -> dict[str, int]:
                self.resources["items"] = buffer
                return {"threads": count}

            steps.append(visit)
            yield 0.0
        _, lengths = yield from scaled(self._sort("primitives", steps, cells, cells, 0), 0.0, 0.6)
        finding = in_thread(lambda: _clear_directions(plan.grids[plan.over :], lengths == 0))
        clear = yield from scaled(finding, 0.6, 0.7)
        total = cells + int(lengths.sum(dtype=np.int64))
        walked = empty_table(gpu, total, "rgba32uint", "grid entries")
        copied = {
            "slots": self.resources["slots"],
            "cells": self.resources["cells"],
            "counts": self.resources["counts"],
            "refs": self.resources["refs"],
            "walked": walked,
            "clear": gpu.buffer(clear, label="clear directions"),
        }
        for first in range(0, total, _COPIED):
            count = min(_COPIED, total - first)
            copying = {"copying": {"first": first, "cells": cells, "total": total}}
            gpu.compute("trace/copy.wgsl", "main", (count,), copied | copying)
            yield 0.7 + 0.3 * (first + count) / total
        return walked, self.resources["refs"]


def _summed(lengths: NDArray[np.uint32], base: int) -> tuple[NDArray[np.uint32], int]:
    """Where runs of these lengths start, one after another from ``base`` on; and the sum."""
    ends = np.cumsum(lengths, dtype=np.int64)
    starts = np.full(len(lengths), base, np.uint32)
    starts[1:] += ends[:-1].astype(np.uint32)
    return starts, int(ends[-1]) if len(ends) else 0


def _spans(total: int, objects: int) -> dict[str, int]:
    """How a cell's word tells its first and last object above one of ``total`` entries.

    Rays that are to pass a range of objects, such as a whole compartment, then pass cells that list
    nothing else at once. Where bits are short, neighbouring objects count as one.
    """
    needed = max(1, (objects - 1).bit_length())
    bits = min(needed, max(0, (_CELL_BITS - total.bit_length()) // 2))
    return {"span_bits": bits, "span_shift": needed - bits}


def _clear_directions(grids: NDArray, empty: NDArray[np.bool_]) -> NDArray[np.uint32]:
    """What :func:`clear_directions` tells of each cell of some grids, from whether it is empty."""
    bits = np.zeros(len(empty), np.uint32)
    for grid in grids[:_CLEARED]:
        first, dims = int(grid["cells"]), grid["dims"][::-1].astype(np.int64)
        run = slice(first, first + int(np.prod(dims)))
        bits[run] = clear_directions(empty[run].reshape(dims)).ravel()
    return bits
