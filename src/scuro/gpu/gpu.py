"""A GPU as the passes use it: resources by name, programs by file, one recorder a frame."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError
from scuro.gpu.device import AdapterInfo, open_device
from scuro.gpu.errors import telling
from scuro.gpu.program import Programs
from scuro.gpu.recorder import Recorder, Resources
from scuro.gpu.shader import Source
from scuro.gpu.texel import TEXEL

# formats that may be storage textures on every WebGPU device
_STORABLE = {
    "rgba8unorm", "rgba16float", "r32float", "rg32float", "rgba32float",
    "r32uint", "rg32uint", "rgba32uint", "r32sint", "rgba16uint",
}  # fmt: skip


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
        with telling(f"a {format} texture of {' x '.join(map(str, size))} for {label or 'a pass'}"):
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
        dtype, channels = TEXEL[texture.format]
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
        with telling(f"a buffer of {padded / 2**20:.1f} MiB for {label or 'a pass'}"):
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
        dtype, channels = TEXEL[texture.format]
        width, height, depth = (max(1, s >> mip) for s in texture.size)
        if texture.dimension != "3d":
            depth = texture.size[2]
        row = width * channels * np.dtype(dtype).itemsize
        with telling("reading back a picture"):
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
        dtype, channels = TEXEL[texture.format]
        with telling("reading back a pixel"):
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
        with telling("reading back a buffer"):
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

    def release(self) -> None:
        """Free what nobody holds any more, and the uniforms that were kept.

        Memory is taken in blocks of some 100 MB, which a single small buffer keeps.
        """
        self._uniforms.clear()
        self.finish()

    def finish(self) -> None:
        """Wait until everything submitted is done.

        Reads a word back: ``on_submitted_work_done_sync`` of wgpu-py 0.32 raises a TypeError.
        """
        self.read_buffer(self._fence, np.uint32)
