"""Recording a frame's passes into one command buffer, and their timings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.gpu.errors import telling
from scuro.gpu.shader import Source
from scuro.gpu.texel import TEXEL

if TYPE_CHECKING:
    from scuro.gpu.gpu import Gpu

Resources = Mapping[str, Any]

_MAX_TIMED = 256


class Recorder:
    """Records passes into one command buffer; each is timed under its label."""

    def __init__(self, gpu: Gpu) -> None:
        self.gpu = gpu
        self._encoder = gpu.device.create_command_encoder()
        self._labels: list[str] = []
        self._queries: Any = None
        if gpu.has_timestamps:
            self._queries = gpu.device.create_query_set(type="timestamp", count=2 * _MAX_TIMED)

    def compute(
        self,
        shader: str | Source,
        entry: str,
        threads: Sequence[int],
        resources: Resources,
        constants: Mapping[str, float] | None = None,
        label: str = "",
        indirect: Any = None,
    ) -> None:
        """Record a compute pass.

        Args:
            shader: File of the package, e.g. ``"passes/compose/shade.wgsl"``.
            entry: Entry point in it.
            threads: How many invocations along x, y, z are needed; whole workgroups are started.
            resources: By declared name: textures, views, buffers, samplers, or a dictionary of
                field values for a uniform struct. Names the shader does not declare are ignored,
                so a frame's resources can be given whole.
            constants: Values of ``override`` constants.
            label: Name in the timings; the file's stem by default.
            indirect: Buffer with the three workgroup counts, in place of ``threads``.
        """
        program = self.gpu.programs.compute(shader, entry, constants or {})
        size = program.source.workgroups[entry]
        groups = [-(-int(t) // s) for t, s in zip((*threads, 1, 1, 1)[:3], size, strict=True)]
        label = label or program.name
        with telling(f"pass '{label}'"):
            bind_groups = program.bind(self.gpu, resources)
            run = self._encoder.begin_compute_pass(label=label, **self._timing(label))
            run.set_pipeline(program.pipeline)
            for index, group in enumerate(bind_groups):
                run.set_bind_group(index, group)
            if indirect is None:
                run.dispatch_workgroups(*groups)
            else:
                run.dispatch_workgroups_indirect(indirect, 0)
            run.end()

    def draw(
        self,
        shader: str | Source,
        targets: Mapping[str, Any],
        vertices: int,
        instances: int,
        resources: Resources,
        *,
        depth: Any = None,
        clear: bool = False,
        clear_value: tuple[float, float, float, float] = (0, 0, 0, 0),
        entries: tuple[str, str] = ("vertex", "fragment"),
        constants: Mapping[str, float] | None = None,
        topology: str = "triangle-list",
        blend: dict | None = None,
        label: str = "",
    ) -> None:
        """Record a draw of ``instances`` × ``vertices`` into ``targets`` (in the order given).

        Args:
            shader: File of the package.
            targets: Colour attachments: textures or views by name (names are for readers).
            vertices: Vertices an instance.
            instances: Number of instances.
            resources: As in :meth:`compute`.
            depth: Depth texture (reversed: nearer is greater), or ``None``.
            clear: Clear the targets to ``clear_value`` and depth to 0 (farthest) first.
            clear_value: Of every target.
            entries: Vertex and fragment entry points.
            constants: Values of ``override`` constants.
            topology: WebGPU primitive topology.
            blend: WebGPU blend state of every target, or ``None``.
            label: Name in the timings.
        """
        formats = tuple(
            t.format if hasattr(t, "format") else t.texture.format for t in targets.values()
        )
        program = self.gpu.programs.render(
            shader,
            entries,
            formats,
            depth.format if depth is not None else None,
            constants or {},
            topology,
            blend,
        )
        label = label or program.name
        load = "clear" if clear else "load"
        attachments = [
            {
                "view": t.create_view() if hasattr(t, "create_view") else t,
                "load_op": load,
                "store_op": "store",
                "clear_value": clear_value,
            }
            for t in targets.values()
        ]
        depth_attachment = None
        if depth is not None:
            depth_attachment = {
                "view": depth.create_view(),
                "depth_load_op": load,
                "depth_store_op": "store",
                "depth_clear_value": 0.0,
            }
        with telling(f"pass '{label}'"):
            bind_groups = program.bind(self.gpu, resources)
            run = self._encoder.begin_render_pass(
                color_attachments=attachments,
                depth_stencil_attachment=depth_attachment,
                label=label,
                **self._timing(label),
            )
            run.set_pipeline(program.pipeline)
            for index, group in enumerate(bind_groups):
                run.set_bind_group(index, group)
            if vertices and instances:
                run.draw(vertices, instances)
            run.end()

    def copy_buffer_to_texture(
        self, buffer: Any, texture: Any, *, mip: int = 0, first: int = 0, planes: int | None = None
    ) -> None:
        """Copy a buffer whose rows are padded to 256 bytes into a mip level, or a slab of it.

        Args:
            first: First plane (or layer) that is written.
            planes: How many; all of the level by default.
        """
        dtype, channels = TEXEL[texture.format]
        width, height, depth = (max(1, s >> mip) for s in texture.size)
        if texture.dimension != "3d":
            depth = texture.size[2]
        row = -(-width * channels * np.dtype(dtype).itemsize // 256) * 256
        self._encoder.copy_buffer_to_texture(
            {"buffer": buffer, "offset": 0, "bytes_per_row": row, "rows_per_image": height},
            {"texture": texture, "mip_level": mip, "origin": (0, 0, first)},
            (width, height, depth if planes is None else planes),
        )

    def copy_buffer_to_rows(self, buffer: Any, texture: Any, first: int) -> None:
        """Copy a buffer of whole rows into those of a table of 32-bit texels from ``first`` on."""
        row = 4 * texture.size[0]
        height = buffer.size // row
        self._encoder.copy_buffer_to_texture(
            {"buffer": buffer, "offset": 0, "bytes_per_row": row, "rows_per_image": height},
            {"texture": texture, "mip_level": 0, "origin": (0, first, 0)},
            (texture.size[0], height, 1),
        )

    def clear_texture(self, texture: Any, value: tuple[float, float, float, float]) -> None:
        """Fill a texture that render passes may draw into."""
        self._encoder.begin_render_pass(
            color_attachments=[
                {
                    "view": texture.create_view(),
                    "load_op": "clear",
                    "store_op": "store",
                    "clear_value": value,
                }
            ]
        ).end()

    def clear_buffer(self, buffer: Any) -> None:
        """Fill a buffer with zeros."""
        self._encoder.clear_buffer(buffer)

    def copy_texture(self, source: Any, target: Any, *, layer: int = 0) -> None:
        """Copy one texture into another of the same size and format, or into a layer of it."""
        self._encoder.copy_texture_to_texture(
            {"texture": source, "mip_level": 0, "origin": (0, 0, 0)},
            {"texture": target, "mip_level": 0, "origin": (0, 0, layer)},
            source.size,
        )

    def copy_region(
        self,
        source: Any,
        target: Any,
        source_origin: tuple[int, int],
        target_origin: tuple[int, int],
        size: tuple[int, int],
    ) -> None:
        """Copy a rectangle of one 2-D texture into another of the same format."""
        self._encoder.copy_texture_to_texture(
            {"texture": source, "mip_level": 0, "origin": (*source_origin, 0)},
            {"texture": target, "mip_level": 0, "origin": (*target_origin, 0)},
            (*size, 1),
        )

    def _timing(self, label: str) -> dict:
        if self._queries is None or len(self._labels) >= _MAX_TIMED:
            return {}
        index = 2 * len(self._labels)
        self._labels.append(label)
        return {
            "timestamp_writes": {
                "query_set": self._queries,
                "beginning_of_pass_write_index": index,
                "end_of_pass_write_index": index + 1,
            }
        }

    def flush(self) -> None:
        """Hand what was recorded to the GPU and go on recording; its timings are lost."""
        with telling("submitting a part of the frame"):
            self.gpu.device.queue.submit([self._encoder.finish()])
        self._encoder = self.gpu.device.create_command_encoder()
        self._labels = []

    def submit(self) -> Timings:
        """Hand everything recorded to the GPU; returns the timings, readable once it is done."""
        import wgpu

        buffer = None
        if self._labels:
            buffer = self.gpu.device.create_buffer(
                size=16 * len(self._labels),
                usage=wgpu.BufferUsage.QUERY_RESOLVE | wgpu.BufferUsage.COPY_SRC,
            )
            self._encoder.resolve_query_set(self._queries, 0, 2 * len(self._labels), buffer, 0)
        with telling("submitting the frame"):
            self.gpu.device.queue.submit([self._encoder.finish()])
        return Timings(self.gpu, self._labels, buffer)


class Timings:
    """Seconds per pass of one submitted recorder."""

    def __init__(self, gpu: Gpu, labels: list[str], buffer: Any) -> None:
        self._gpu, self._labels, self._buffer = gpu, labels, buffer

    @cached_property
    def seconds(self) -> dict[str, float]:
        """Seconds by label, passes of one label summed; empty without timestamps."""
        if self._buffer is None:
            return {}
        stamps = self._gpu.read_buffer(self._buffer, np.uint64).astype(np.int64).reshape(-1, 2)
        total: dict[str, float] = {}
        for label, (begin, end) in zip(self._labels, stamps, strict=True):
            # Vulkan time stamps are in nanoseconds in WebGPU
            total[label] = total.get(label, 0.0) + float(end - begin) * 1e-9
        return total
