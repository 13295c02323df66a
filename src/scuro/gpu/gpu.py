"""A GPU as the passes use it: resources by name, programs by file, one recorder a frame."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError
from scuro.gpu.device import AdapterInfo, open_device
from scuro.gpu.program import Programs
from scuro.gpu.shader import Source

_TEXEL = {
    "r8unorm": (np.uint8, 1),
    "r8uint": (np.uint8, 1),
    "rgba8unorm": (np.uint8, 4),
    "rgba8unorm-srgb": (np.uint8, 4),
    "r16float": (np.float16, 1),
    "rg16float": (np.float16, 2),
    "rgba16float": (np.float16, 4),
    "r32float": (np.float32, 1),
    "rg32float": (np.float32, 2),
    "rgba32float": (np.float32, 4),
    "r32uint": (np.uint32, 1),
    "rg32uint": (np.uint32, 2),
    "rgba32uint": (np.uint32, 4),
    "r32sint": (np.int32, 1),
    "depth32float": (np.float32, 1),
}
# formats that may be storage textures on every WebGPU device
_STORABLE = {
    "rgba8unorm", "rgba16float", "r32float", "rg32float", "rgba32float",
    "r32uint", "rg32uint", "rgba32uint", "r32sint",
}  # fmt: skip

Resources = Mapping[str, Any]


@contextmanager
def _telling(what: str) -> Iterator[None]:
    """Turn the native layer's errors into one sentence that says what was asked for."""
    try:
        yield
    except GpuError:
        raise
    except Exception as error:
        kind = type(error).__name__
        if "OutOfMemory" in kind:
            raise GpuError(
                f"the GPU is out of memory: {what}; "
                "lower --size, the samples or the resolution of the technique"
            ) from None
        if "lost" in str(error).lower():
            raise GpuError(f"the GPU was lost during {what}; lower --size or the samples") from None
        if kind.startswith("GPU"):
            raise GpuError(f"{what}: {error}") from error
        raise


class Gpu:
    """One open device, the programs compiled for it, and ways to make resources.

    Args:
        choice: See :func:`scuro.gpu.device.open_device`.
        default_limits: Stay within WebGPU's default limits.
    """

    def __init__(self, choice: str | None = None, *, default_limits: bool = False) -> None:
        self.device, self.info = open_device(choice, default_limits=default_limits)
        self.programs = Programs(self.device)
        self._uniforms: OrderedDict[bytes, Any] = OrderedDict()

    info: AdapterInfo

    @property
    def has_timestamps(self) -> bool:
        return "timestamp-query" in self.device.features

    @property
    def filters_float32(self) -> bool:
        """Whether 32-bit float textures can be sampled with linear filtering."""
        return "float32-filterable" in self.device.features

    @property
    def max_binding(self) -> int:
        """Largest storage buffer a shader can see, in bytes."""
        return int(self.device.limits["max-storage-buffer-binding-size"])

    @property
    def max_texture(self) -> int:
        """Largest width or height of a 2-D texture."""
        return int(self.device.limits["max-texture-dimension-2d"])

    def texture(
        self,
        size: Sequence[int],
        format: str,
        *,
        dimension: str = "2d",
        mips: int = 1,
        attachment: bool = False,
        label: str = "",
    ) -> Any:
        """A texture for shaders to read and, where the format allows, to write.

        Args:
            size: (width, height) or (width, height, depth or layers).
            format: WebGPU format.
            dimension: ``2d`` or ``3d``.
            mips: Number of mip levels.
            attachment: Whether render passes draw into it.
            label: Shown in errors.
        """
        import wgpu

        usage = wgpu.TextureUsage.TEXTURE_BINDING
        if not format.startswith("depth"):
            usage |= wgpu.TextureUsage.COPY_SRC | wgpu.TextureUsage.COPY_DST
        if format in _STORABLE:
            usage |= wgpu.TextureUsage.STORAGE_BINDING
        if attachment or format.startswith("depth"):
            usage |= wgpu.TextureUsage.RENDER_ATTACHMENT
        extent = (*size, 1)[:3]
        with _telling(
            f"a {format} texture of {' x '.join(map(str, size))} for {label or 'a pass'}"
        ):
            return self.device.create_texture(
                size=extent,
                format=format,
                dimension=dimension,
                mip_level_count=mips,
                usage=usage,
                label=label,
            )

    def texture_from(self, data: NDArray, format: str, *, dimension: str = "2d") -> Any:
        """A texture filled from ([depth,] height, width[, channels])."""
        base = 3 if dimension == "3d" else 2
        size = data.shape[:base][::-1]
        texture = self.texture(size, format, dimension=dimension)
        self.write_texture(texture, data)
        return texture

    def write_texture(
        self, texture: Any, data: NDArray, *, mip: int = 0, origin: tuple[int, int, int] = (0, 0, 0)
    ) -> None:
        """Copy ``data`` ([depth,] height, width[, channels]) into a texture."""
        dtype, channels = _TEXEL[texture.format]
        array = np.ascontiguousarray(data, dtype)
        if channels > 1:
            array = array.reshape(*array.shape[:-1], channels)
            shape = array.shape[:-1]
        else:
            shape = array.shape
        depth, height, width = (1, 1, *shape)[-3:]
        self.device.queue.write_texture(
            {"texture": texture, "mip_level": mip, "origin": origin},
            array,
            {
                "offset": 0,
                "bytes_per_row": width * channels * array.itemsize,
                "rows_per_image": height,
            },
            (width, height, depth),
        )

    def buffer(self, data: NDArray | int, *, label: str = "", indirect: bool = False) -> Any:
        """A storage buffer of so many bytes, or filled from an array (padded to 16 bytes).

        ``indirect`` buffers can hold the workgroup counts of a dispatch.
        """
        import wgpu

        flags = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC | wgpu.BufferUsage.COPY_DST
        if indirect:
            flags |= wgpu.BufferUsage.INDIRECT
        size = data if isinstance(data, int) else data.nbytes
        # an empty array must still hold one element of whatever struct the shader declares
        padded = max(256, -(-size // 16) * 16)
        if padded > self.max_binding:
            raise GpuError(
                f"{label or 'a buffer'} needs {padded / 2**20:.0f} MiB, but {self.info.name} binds "
                f"at most {self.max_binding / 2**20:.0f} MiB at once; show fewer atoms or use "
                "an adapter with larger buffers"
            )
        with _telling(f"a buffer of {padded / 2**20:.1f} MiB for {label or 'a pass'}"):
            buffer = self.device.create_buffer(size=padded, usage=flags, label=label)
            if not isinstance(data, int) and size:
                self.write_buffer(buffer, data)
            return buffer

    def write_buffer(self, buffer: Any, data: NDArray, offset: int = 0) -> None:
        """Copy an array into a buffer (its byte count must be a multiple of four)."""
        self.device.queue.write_buffer(buffer, offset, np.ascontiguousarray(data))

    def uniform(self, content: bytes) -> Any:
        """A uniform buffer with this content; the same content gives the same buffer."""
        import wgpu

        found = self._uniforms.get(content)
        if found is None:
            size = max(16, -(-len(content) // 16) * 16)
            found = self.device.create_buffer_with_data(
                data=content.ljust(size, b"\0"), usage=wgpu.BufferUsage.UNIFORM
            )
            self._uniforms[content] = found
            if len(self._uniforms) > 512:
                self._uniforms.popitem(last=False)
        else:
            self._uniforms.move_to_end(content)
        return found

    @cached_property
    def _fence(self) -> Any:
        return self.buffer(16, label="fence")

    @cached_property
    def linear_sampler(self) -> Any:
        """Linear filtering between texels and mips, clamped to the edge."""
        return self.device.create_sampler(
            mag_filter="linear", min_filter="linear", mipmap_filter="linear"
        )

    @cached_property
    def level_sampler(self) -> Any:
        """Linear filtering within a mip level, none between levels; clamped to the edge."""
        return self.device.create_sampler(
            mag_filter="linear", min_filter="linear", mipmap_filter="nearest"
        )

    @cached_property
    def nearest_sampler(self) -> Any:
        """The nearest texel, clamped to the edge."""
        return self.device.create_sampler()

    def read_texture(self, texture: Any, *, mip: int = 0) -> NDArray:
        """A texture's content as ([depth,] height, width[, channels])."""
        dtype, channels = _TEXEL[texture.format]
        width, height, depth = (max(1, s >> mip) for s in texture.size)
        if texture.dimension != "3d":
            depth = texture.size[2]
        row = width * channels * np.dtype(dtype).itemsize
        with _telling("reading back a picture"):
            data = self.device.queue.read_texture(
                {"texture": texture, "mip_level": mip, "origin": (0, 0, 0)},
                {"offset": 0, "bytes_per_row": row, "rows_per_image": height},
                (width, height, depth),
            )
        array = np.frombuffer(data, dtype).reshape(depth, height, width, channels)
        if texture.dimension != "3d" and depth == 1:
            array = array[0]
        return array[..., 0] if channels == 1 else array

    def read_texel(self, texture: Any, x: int, y: int) -> NDArray:
        """One texel of a 2-D texture: (channels,)."""
        dtype, channels = _TEXEL[texture.format]
        with _telling("reading back a pixel"):
            data = self.device.queue.read_texture(
                {"texture": texture, "mip_level": 0, "origin": (x, y, 0)},
                {
                    "offset": 0,
                    "bytes_per_row": channels * np.dtype(dtype).itemsize,
                    "rows_per_image": 1,
                },
                (1, 1, 1),
            )
        return np.frombuffer(data, dtype, channels)

    def read_buffer(self, buffer: Any, dtype: Any = np.float32) -> NDArray:
        """A buffer's content as a flat array."""
        with _telling("reading back a buffer"):
            return np.frombuffer(self.device.queue.read_buffer(buffer), dtype)

    def recorder(self) -> Recorder:
        """Start recording passes, to be submitted together."""
        return Recorder(self)

    def compute(
        self,
        shader: str | Source,
        entry: str,
        threads: Sequence[int],
        resources: Resources,
        constants: Mapping[str, float] | None = None,
    ) -> None:
        """Run one compute pass now; see :meth:`Recorder.compute`."""
        recorder = self.recorder()
        recorder.compute(shader, entry, threads, resources, constants)
        recorder.submit()

    def finish(self) -> None:
        """Wait until everything submitted is done.

        Reads a word back: ``on_submitted_work_done_sync`` of wgpu-py 0.32 raises a TypeError.
        """
        self.read_buffer(self._fence, np.uint32)


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
        with _telling(f"pass '{label}'"):
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
        with _telling(f"pass '{label}'"):
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
        dtype, channels = _TEXEL[texture.format]
        width, height, depth = (max(1, s >> mip) for s in texture.size)
        if texture.dimension != "3d":
            depth = texture.size[2]
        row = -(-width * channels * np.dtype(dtype).itemsize // 256) * 256
        self._encoder.copy_buffer_to_texture(
            {"buffer": buffer, "offset": 0, "bytes_per_row": row, "rows_per_image": height},
            {"texture": texture, "mip_level": mip, "origin": (0, 0, first)},
            (width, height, depth if planes is None else planes),
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
        with _telling("submitting the frame"):
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


_MAX_TIMED = 256
