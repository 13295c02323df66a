"""Large pictures are drawn in parts: rectangles with margins that hide what ends at their edges."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scuro.passes.geometry.tiles import MAX_TILES, TILE

_ALIGN = 16
"""Parts begin at multiples of this, so that patterns and reduced pictures continue across them."""
_EDGE = 1280
"""Usual edge of a part in samples: bounds what the GPU holds."""
_MOST = TILE * math.isqrt(MAX_TILES)
"""Largest edge of a part in samples."""


_SHARE = 1 / 4
_LEAST, _FARTHEST = 64, 512


def screen_reach(height: int) -> int:
    """Samples that techniques of screen space look about, in a picture so many samples high.

    A share of the height, so that sizes look alike, but bounded: it is the margin of parts.
    """
    return min(max(round(height * _SHARE), _LEAST), _FARTHEST)


@dataclass(frozen=True)
class Part:
    """A rectangle of the picture, in output pixels."""

    origin: tuple[int, int]
    """First pixel drawn."""
    size: tuple[int, int]
    """Width and height of what is drawn, margins included."""
    keep: tuple[int, int, int, int]
    """Left, top, right, bottom of the pixels kept, within the whole picture."""
    eye: int = 0
    """-1 left, 1 right, 0 for a picture that is not stereo."""
    shift: int = 0
    """Where this eye's picture begins in one that shows both side by side."""

    @property
    def rows(self) -> slice:
        """Rows of the finished picture that this part gives."""
        return slice(self.keep[1], self.keep[3])

    @property
    def columns(self) -> slice:
        """Columns of the finished picture that this part gives."""
        return slice(self.keep[0] + self.shift, self.keep[2] + self.shift)

    @property
    def inside(self) -> tuple[slice, slice]:
        """Rows and columns of the drawn rectangle that are kept."""
        left, top, right, bottom = self.keep
        x, y = self.origin
        return slice(top - y, bottom - y), slice(left - x, right - x)


def fits(size: tuple[int, int], scale: int, max_texture: int) -> bool:
    """Whether a picture of ``scale`` × ``scale`` samples a pixel can be drawn at once."""
    width, height = size[0] * scale, size[1] * scale
    tiles = -(-width // TILE) * -(-height // TILE)
    return tiles <= MAX_TILES and max(width, height) <= max_texture


def split(
    size: tuple[int, int],
    *,
    scale: int,
    margin: int,
    max_texture: int,
    edge: int = _EDGE,
    rows: int | None = None,
) -> list[Part]:
    """Rows of parts, left to right and top to bottom, that together make the picture.

    Args:
        size: Width and height of the picture in output pixels.
        scale: Samples along a pixel's edge.
        margin: Output pixels that each part draws beyond what is kept.
        max_texture: Largest edge of a texture, in samples.
        edge: Largest edge of a part, in samples.
        rows: Most rows that a part shall keep.
    """
    width, height = size
    if fits(size, scale, max_texture):
        return [Part((0, 0), size, (0, 0, width, height))]
    margin = _aligned(margin)
    # wide margins are worth larger parts
    edge = min(max(edge // scale, 4 * margin), max_texture // scale, _MOST // scale)
    step = max((edge - 2 * margin - _ALIGN) // _ALIGN * _ALIGN, _ALIGN)
    down = step if rows is None else max(min(step, rows // _ALIGN * _ALIGN), _ALIGN)
    # all parts are of one size, so that one set of textures serves them all; the last ends with the
    # picture, for what lies beyond it must not be known to its part alone
    drawn = _ending(width, step + 2 * margin), _ending(height, down + 2 * margin)
    parts = []
    for top in range(0, height, down):
        for left in range(0, width, step):
            x = min(max(left - margin, 0), width - drawn[0])
            y = min(max(top - margin, 0), height - drawn[1])
            keep = (left, top, min(left + step, width), min(top + down, height))
            parts.append(Part((x, y), drawn, keep))
    return parts


def bands(size: tuple[int, int], *, margin: int, count: int) -> list[Part]:
    """About ``count`` parts of the picture's full width, from top to bottom.

    Args:
        size: Width and height of the picture in output pixels.
        margin: Output pixels that each part draws beyond what is kept.
        count: How many parts are wanted; there may be fewer.
    """
    width, height = size
    margin = -(-margin // _ALIGN) * _ALIGN
    step = -(-height // (count * _ALIGN)) * _ALIGN
    parts = []
    for top in range(0, height, step):
        bottom = min(top + step, height)
        y = max(top - margin, 0)
        drawn = (width, min(bottom + margin, height) - y)
        parts.append(Part((0, y), drawn, (0, top, width, bottom)))
    return parts


def _ending(length: int, drawn: int) -> int:
    """``drawn`` or a little more, so that an aligned part of that size can end at ``length``."""
    return length - max(length - drawn, 0) // _ALIGN * _ALIGN


def _aligned(length: int) -> int:
    return -(-length // _ALIGN) * _ALIGN
