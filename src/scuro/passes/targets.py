"""The textures and tables that frames draw into and go on from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.gpu import Gpu

if TYPE_CHECKING:
    from scuro.passes.frame import Frame

_IDLE = 8
"""Frames after which what none of them used is freed: its technique is off."""


@dataclass(eq=False)
class _Kept:
    """A texture, buffer or table, what it was made for, and the last frame that used it."""

    key: Any
    made: Any
    used: int


class TargetPool:
    """Textures, buffers and tables kept between frames by name, and by what they were made for."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._size: tuple[int, int] | None = None
        self._textures: dict[str, _Kept] = {}
        self._lasting: set[str] = set()
        self._buffers: dict[str, _Kept] = {}
        self._tables: dict[str, _Kept] = {}
        self._frames = 0
        self.frame: Frame | None = None
        """The last frame that drew into these textures: what they hold is its."""

    def begin(self, size: tuple[int, int]) -> None:
        """A frame of this size begins: free the textures that one of another size left, and what
        is no longer used.

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
        made = [kept.made for kept in self._tables.values()]
        return [table for table in made if isinstance(table, TargetPool)]

    def _age(self) -> bool:
        """Forget what was idle too long; says whether there was anything."""
        self._frames += 1
        freed = False
        for held in (self._textures, self._buffers, self._tables):
            idle = [name for name, kept in held.items() if self._frames - kept.used > _IDLE]
            for name in idle:
                del held[name]  # a pool with its frame, which holds all that it drew with
            freed |= bool(idle)
        inner = [pool._age() for pool in self._pools]
        return freed or any(inner)

    def _clear(self) -> bool:
        """Forget all but what has to last; says whether there was anything."""
        forgotten = self._textures.keys() - self._lasting
        for name in forgotten:
            del self._textures[name]
        self._buffers.clear()
        inner = [pool._clear() for pool in self._pools]
        return bool(forgotten) or any(inner)

    def _keep(self, held: dict[str, _Kept], name: str, key: Any, make: Callable[[], Any]) -> Any:
        """What is held under a name, made anew if the key changed."""
        kept = held.get(name)
        if kept is None or kept.key != key:
            kept = held[name] = _Kept(key, make(), self._frames)
        kept.used = self._frames
        return kept.made

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
        return self._keep(
            self._textures,
            name,
            (*size, format, attachment),
            lambda: self._gpu.texture(size, format, attachment=attachment, label=name),
        )

    def buffer(self, name: str, size: int, indirect: bool = False) -> Any:
        """The buffer of that name, made anew if its size changed."""
        return self._keep(
            self._buffers,
            name,
            (size, indirect),
            lambda: self._gpu.buffer(size, label=name, indirect=indirect),
        )

    def table(self, name: str, key: Any, make: Callable[[], Any]) -> Any:
        """What ``make`` gives, kept under ``name`` as long as ``key`` stays the same.

        Like all else it is forgotten after a few frames that do not ask for it.
        """
        return self._keep(self._tables, name, key, make)

    @property
    def bytes(self) -> int:
        """GPU memory held by textures, those of pools within it too."""
        texel = {"r32float": 4, "rg32float": 8, "rgba8unorm": 4, "depth32float": 4, "r32uint": 4}
        keys = [kept.key for kept in self._textures.values()]
        own = sum(
            int(np.prod(key[:-2])) * texel.get(key[-2], 16 if "32" in key[-2] else 8)
            for key in keys
        )
        return own + sum(pool.bytes for pool in self._pools)
