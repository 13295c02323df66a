"""The textures and tables that frames draw into and go on from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.gpu import Gpu

if TYPE_CHECKING:
    from scuro.passes.frame import Frame

_IDLE = 8
"""Frames after which a texture that none of them used is freed: its technique is off."""


class TargetPool:
    """Textures kept between frames by name, size and format."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._size: tuple[int, int] | None = None
        self._held: dict[str, tuple[tuple, Any]] = {}
        self._lasting: set[str] = set()
        self._used: dict[str, int] = {}
        self._frames = 0
        self.frame: Frame | None = None
        """The last frame that drew into these textures: what they hold is its."""
        self._buffers: dict[str, tuple[tuple, Any]] = {}
        self._tables: dict[str, tuple[Any, Any]] = {}

    def begin(self, size: tuple[int, int]) -> None:
        """A frame of this size begins: free the textures that one of another size left, and those
        that are no longer used.

        Made anew one by one, small ones would settle in the gaps between large ones, and keep the
        blocks of memory that those were in. What the frame does not use would stay for ever.
        """
        freed = self._age()
        if size != self._size:
            self._size, self.frame = size, None
            freed |= self._clear()
        if freed:
            self._gpu.release()

    @property
    def _pools(self) -> list[TargetPool]:
        return [value for _, value in self._tables.values() if isinstance(value, TargetPool)]

    def _age(self) -> bool:
        """Forget textures that were idle too long; says whether there were any."""
        self._frames += 1
        idle = [name for name in self._held if self._frames - self._used[name] > _IDLE]
        for name in idle:
            del self._held[name]
        inner = [pool._age() for pool in self._pools]
        return bool(idle) or any(inner)

    def _clear(self) -> bool:
        """Forget all but what has to last; says whether there was anything."""
        forgotten = self._held.keys() - self._lasting
        for name in forgotten:
            del self._held[name]
        self._buffers.clear()
        inner = [pool._clear() for pool in self._pools]
        return bool(forgotten) or any(inner)

    def get(
        self,
        name: str,
        size: Sequence[int],
        format: str,
        attachment: bool = False,
        lasting: bool = False,
    ) -> Any:
        """The texture of that name, made anew if size or format changed.

        A ``lasting`` one outlives frames of other sizes; none outlives more than a few that do not
        use it.
        """
        if lasting:
            self._lasting.add(name)
        self._used[name] = self._frames
        key = (*size, format, attachment)
        held = self._held.get(name)
        if held is None or held[0] != key:
            texture = self._gpu.texture(size, format, attachment=attachment, label=name)
            self._held[name] = held = (key, texture)
        return held[1]

    def buffer(self, name: str, size: int, indirect: bool = False) -> Any:
        """The buffer of that name, made anew if its size changed."""
        key = (size, indirect)
        held = self._buffers.get(name)
        if held is None or held[0] != key:
            self._buffers[name] = held = (
                key,
                self._gpu.buffer(size, label=name, indirect=indirect),
            )
        return held[1]

    def table(self, name: str, key: Any, make: Callable[[], Any]) -> Any:
        """What ``make`` gives, kept under ``name`` as long as ``key`` stays the same."""
        held = self._tables.get(name)
        if held is None or held[0] != key:
            self._tables[name] = held = (key, make())
        return held[1]

    @property
    def bytes(self) -> int:
        """GPU memory held by textures, those of pools within it too."""
        texel = {"r32float": 4, "rg32float": 8, "rgba8unorm": 4, "depth32float": 4, "r32uint": 4}
        own = sum(
            int(np.prod(key[:-2])) * texel.get(key[-2], 16 if "32" in key[-2] else 8)
            for key, _ in self._held.values()
        )
        return own + sum(pool.bytes for pool in self._pools)
