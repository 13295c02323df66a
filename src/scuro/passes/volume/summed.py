"""The summed-volume table of the method of Schlegel et al. 2011, one of the peers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scuro.errors import GpuError
from scuro.passes.volume.classify import Classified


def summed_table(classified: Classified, volume_uniform: Mapping[str, Any]) -> Any:
    """Buffer of extinction summed from the first voxel to each, in 1024ths, modulo 2³².

    Raises:
        GpuError: The table is larger than the adapter binds; other methods do without it.
    """
    gpu, size = classified.gpu, classified.grid.size
    bytes_ = 4 * size[0] * size[1] * size[2]
    if bytes_ > gpu.max_binding:
        raise GpuError(
            f"the summed-area table needs {bytes_ / 2**20:.0f} MiB, but {gpu.info.name} binds at "
            f"most {gpu.max_binding / 2**20:.0f}; read the volume with --voxels-limit or choose "
            "another --volume-light"
        )
    table = gpu.buffer(bytes_, label="summed extinction")
    shader = "passes/volume/summed.wgsl"
    bound = {**classified.resources(), "volume": volume_uniform, "table": table}
    record = gpu.recorder()
    record.compute(shader, "fill", size, {**bound, "along": {"axis": 0}}, label="summed table")
    for axis in range(3):
        lines = [n for i, n in enumerate(size) if i != axis]
        record.compute(
            shader, "add_up", lines, {**bound, "along": {"axis": axis}}, label="summed table"
        )
    record.submit()
    return table
