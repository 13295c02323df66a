"""The pyramid of extinction coefficients that cones are traced through (Campagnolo 2021, 3.2.1)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.volume.classify import Classified

SLAB_BYTES = 64 << 20
"""Roughly how much one of the two scratch buffers may take."""

REACH = 3.0
"""Kernels are cut at so many standard deviations (7 × 7 × 7 taps for one voxel's)."""

LEAST_SIGMA = 0.25
"""Narrower Gaussians (thick slices) are taken so wide: they touch no neighbour anyway."""


class Pyramid:
    """A mip chain of half-floats: level k holds the opacity volume blurred by sigma · 2^k.

    Blurring is isotropic in space; levels are kept as extinction coefficients per mean voxel edge.

    Args:
        classified: Volume and transfer function.
        volume_uniform: The ``Volume`` uniform (cuts empty what they cut away).
        sigma: Standard deviation of the first level, in mean voxel edges times ``factor``.
        factor: 1, 2 or 4: voxels along each edge of the first level's voxels.
        solids: Texture that is 1 where surfaces fill space, or None.
        boxes: Average 2 × 2 × 2 texels instead of blurring, as a plain mip chain does.
        build: Fill it at once; else :meth:`build` does.
    """

    def __init__(
        self,
        classified: Classified,
        volume_uniform: Mapping[str, Any],
        *,
        sigma: float = 1.0,
        factor: int = 1,
        solids: Any = None,
        boxes: bool = False,
        build: bool = True,
    ) -> None:
        self.boxes = boxes
        self.gpu = classified.gpu
        self.classified = classified
        self.sigma = sigma * factor
        self.factor = factor
        grid = classified.grid
        full = tuple(-(-n // factor) for n in grid.size)
        self.levels = int(math.log2(max(full))) + 1
        self.sizes = [tuple(max(1, n >> k) for n in full) for k in range(self.levels)]
        self.texture = self.gpu.texture(
            full, "r16float", dimension="3d", mips=self.levels, label="extinction pyramid"
        )
        self._spacing = grid.volume.spacing / grid.voxel
        self._resources = {
            **classified.resources(),
            "volume": volume_uniform,
            "solids": solids or classified.grid.texture,
            "voxel_opacity": classified.voxel_opacity,
        }
        self._constants = {
            "HAS_CUTS": volume_uniform["cut_count"] > 0,
            "HAS_SOLIDS": solids is not None,
            "COARSE": factor > 1,
        }
        if build:
            for _ in self.build():
                pass

    @property
    def bytes(self) -> int:
        """Memory of the pyramid."""
        return sum(2 * math.prod(size) for size in self.sizes)

    def build(self, slab: int = SLAB_BYTES) -> Iterator[float]:
        """Fill all levels, pass by pass and slab by slab; yields the share that is done.

        Args:
            slab: Roughly how many bytes of a level are worked on at once.
        """
        size = self.classified.grid.size
        plans = []
        for k, out in enumerate(self.sizes):
            source = self.sizes[k - 1] if k else out
            # what is added in quadrature doubles the deviation from one level to the next
            added = self.sigma if k == 0 else math.sqrt(3) * self.sigma * 2 ** (k - 1)
            voxel = self._spacing * np.array(size) / np.array(source)
            plans.append((k, source, out, added / voxel))
        words = max(
            _words(source) * min(source[2], planes + 2 * self._halo(sigmas[2]) + 2)
            for _, source, _, sigmas in plans
            for planes in (self._planes(source, slab),)
        )
        words = max(words, 64)
        scratch = [self.gpu.buffer(4 * words, label="pyramid scratch") for _ in range(2)]
        total, done = sum(map(math.prod, self.sizes)), 0
        for plan in plans:
            for planes in self._build_level(*plan, scratch, slab):
                done += planes * math.prod(plan[2][:2])
                yield done / total
        for buffer in scratch:
            self.gpu.device.queue.read_buffer(buffer, 0, 4)  # done with them

    @staticmethod
    def _halo(sigma: float) -> int:
        return math.ceil(REACH * sigma) + 1

    @staticmethod
    def _planes(source: tuple[int, ...], slab: int) -> int:
        return max(1, slab // (4 * _words(source)))

    def _build_level(
        self,
        k: int,
        source: tuple[int, ...],
        out: tuple[int, ...],
        sigmas: NDArray,
        scratch: list[Any],
        slab: int,
    ) -> Iterator[int]:
        halo = self._halo(sigmas[2])
        ratio = source[2] / out[2]
        planes = max(1, int(self._planes(source, slab) / ratio))
        a, b = scratch
        for first in range(0, out[2], planes):
            count = min(planes, out[2] - first)
            low = max(0, math.floor(first * ratio) - halo)
            high = min(source[2], math.ceil((first + count) * ratio) + halo)
            fields: dict[str, Any] = {
                "source_size": source,
                "size": out,
                "factor": self.factor if k == 0 else 1,
                "source_mip": max(k - 1, 0),
                "source_first": low,
                "source_planes": high - low,
                "first": first,
                "planes": count,
            }
            rows = high - low
            record = self.gpu.recorder()
            steps = (
                (
                    "gather_level" if k else "gather_volume",
                    0,
                    (source[0], source[1], rows),
                    (source[0], source[1], rows),
                ),
                ("blur_x", 0, (source[0], source[1], rows), (out[0], source[1], rows)),
                ("blur_yz", 1, (out[0], source[1], rows), (out[0], out[1], rows)),
                ("blur_yz", 2, (out[0], out[1], rows), (out[0], out[1], count)),
            )
            for entry, axis, before, after in steps:
                sigma = LEAST_SIGMA if self.boxes else max(float(sigmas[axis]), LEAST_SIGMA)
                level = {
                    **fields,
                    "input": before,
                    "output": after,
                    "axis": axis,
                    "last": int(axis == 2),
                    "sigma": sigma,
                    # the two nearest of an even number of texels, or the one of an odd number
                    "reach": 0.75 if self.boxes else max(REACH * sigma, 0.5),
                }
                threads = (-(-after[0] // 2), after[1], after[2])
                record.compute(
                    "passes/volume/pyramid.wgsl",
                    entry,
                    threads,
                    {
                        **self._resources,
                        "level": level,
                        "pyramid": self._view(max(k - 1, 0)),
                        "from_": a,
                        "to": b,
                    },
                    self._constants,
                    label="pyramid",
                )
                a, b = b, a
                if after is not steps[-1][3]:
                    record.submit()
                    yield 0
                    record = self.gpu.recorder()
            record.copy_buffer_to_texture(a, self.texture, mip=k, first=first, planes=count)
            record.submit()
            yield count

    def _view(self, mip: int) -> Any:
        """All levels up to one: a level may not be read while it is written."""
        return self.texture.create_view(base_mip_level=0, mip_level_count=mip + 1)


def _words(size: tuple[int, ...]) -> int:
    """32-bit words of one plane of half-floats in rows padded to 256 bytes."""
    return -(-size[0] // 128) * 64 * size[1]
