"""Tables in textures: index i lies at column i mod 8192 of row i div 8192 (wgsl/scene_types.wgsl).

Measured on lavapipe: a sequential vec4 load costs 5 ns from a texture and 43 ns from a storage
buffer, a random one 41 and 87 ns.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError
from scuro.gpu import Gpu

WIDTH = 1 << 13


def _rows(gpu: Gpu, count: int, what: str) -> int:
    rows = max(1, -(-count // WIDTH))
    if rows > gpu.max_texture:
        raise GpuError(
            f"{count:,} {what} are too many for {gpu.info.name}, which holds "
            f"{WIDTH * gpu.max_texture:,}; show fewer atoms or use larger instances"
        )
    return rows


def empty_table(gpu: Gpu, count: int, format: str, what: str) -> Any:
    """A table of ``count`` entries for shaders to write."""
    rows = _rows(gpu, count, what)
    return gpu.texture((WIDTH if rows > 1 else max(1, count), rows), format, label=what)


def fill_table(gpu: Gpu, texture: Any, first: int, data: NDArray) -> None:
    """Write the entries from ``first`` on."""
    done = 0
    while done < len(data):
        row, column = divmod(first + done, WIDTH)
        rows = (len(data) - done) // WIDTH if column == 0 else 0
        count = rows * WIDTH or min(len(data) - done, WIDTH - column)
        block = data[done : done + count].reshape(max(rows, 1), -1, *data.shape[1:])
        gpu.write_texture(texture, block, origin=(column, row, 0))
        done += count


_UPLOADED = 1 << 19
"""Entries that are handed over in one step."""


def filled_in_steps(
    gpu: Gpu, parts: Sequence[NDArray], format: str, what: str
) -> Generator[float, None, Any]:
    """A table of arrays one after another, in steps; yields the share that is done."""
    count = sum(map(len, parts))
    texture = empty_table(gpu, count, format, what)
    done = 0
    for data in parts:
        for start in range(0, len(data), _UPLOADED):
            here = data[start : start + _UPLOADED]
            fill_table(gpu, texture, done, here)
            done += len(here)
            yield done / count
    return texture


def _filled(gpu: Gpu, data: NDArray, format: str, what: str) -> Any:
    texture = empty_table(gpu, len(data), format, what)
    fill_table(gpu, texture, 0, data)
    return texture


def table(gpu: Gpu, data: NDArray[np.uint32], what: str) -> Any:
    """A table of four integers an entry, from (n, 4)."""
    return _filled(gpu, data, "rgba32uint", what)


def float_table(gpu: Gpu, data: NDArray[np.float32], what: str) -> Any:
    """A table of four floats an entry, from (n, 4)."""
    return _filled(gpu, data, "rgba32float", what)


def padded_bytes(count: int) -> int:
    """Size of a buffer of so many integers that :func:`table_from_buffers` can copy."""
    return 4 * WIDTH * max(1, -(-count // WIDTH))


def table_from_buffers(gpu: Gpu, buffers: Sequence[Any]) -> Any:
    """A table of one integer an entry, from buffers of :func:`padded_bytes`, one after another."""
    rows = [buffer.size // (4 * WIDTH) for buffer in buffers]
    texture = gpu.texture((WIDTH, _rows(gpu, sum(rows) * WIDTH, "grid entries")), "r32uint",
                          label="grid")  # fmt: skip
    recorder = gpu.recorder()
    for buffer, first in zip(buffers, np.cumsum([0, *rows]), strict=False):
        recorder.copy_buffer_to_rows(buffer, texture, int(first))
    recorder.submit()
    return texture


def table_bytes(texture: Any) -> int:
    """GPU memory of a table."""
    width, height, _ = texture.size
    return int(width) * int(height) * (4 if texture.format == "r32uint" else 16)
