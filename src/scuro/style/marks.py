"""Marks over a finished picture: text, boxes, lines and colour strips, in the picture's pixels.

What a legend, a label or a scale bar consists of. They are laid out once for the whole picture and
drawn by whoever shows it: into pixels here (also into a band of a picture drawn in parts), or with
ImGui in the viewer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import as_file, files
from typing import Any

import numpy as np
from numpy.typing import NDArray

Color = tuple[int, int, int, int]
"""sRGB and alpha, 0 to 255."""
Rect = tuple[float, float, float, float]
"""Left, top, right, bottom."""
FONT = files("scuro") / "data/fonts/Roboto-Regular.ttf"
_FINE = 4
"""Lines are drawn so many times finer: Pillow's have no smooth edges."""
_SEEN_BY = {-1: slice(0, 1), 0: slice(0, 3), 1: slice(1, 3)}
"""Colour channels that an eye sees through red-cyan glasses."""
ASCENT, DESCENT, CAPITALS = 0.93, 0.24, 0.711
"""Of the font, in sizes: how far letters reach above and below their line, and capitals' height."""


@dataclass(frozen=True)
class Text:
    """Words on a line."""

    text: str
    x: float
    y: float
    """Where the line is that the letters stand on."""
    size: float
    """Of the font."""
    color: Color
    halo: Color | None = None
    """Colour of a rim around the letters."""
    align: str = "l"
    """Whether ``x`` is their left end, middle or right end: ``l``, ``m``, ``r``."""
    eye: int = 0
    """Who sees them through red-cyan glasses: -1 the left eye alone, 1 the right one, 0 both."""

    @property
    def rim(self) -> float:
        """How wide the halo is."""
        return 0.0 if self.halo is None else halo_width(self.size)

    @property
    def box(self) -> Rect:
        """What it covers."""
        width = text_width(self.text, self.size)
        left = self.x - {"l": 0.0, "m": 0.5, "r": 1.0}[self.align] * width
        rim = self.rim
        return (
            left - rim,
            self.y - ASCENT * self.size - rim,
            left + width + rim,
            self.y + DESCENT * self.size + rim,
        )


@dataclass(frozen=True)
class Box:
    """A filled rectangle."""

    box: Rect
    color: Color


@dataclass(frozen=True)
class Line:
    """A line through points."""

    points: tuple[tuple[float, float], ...]
    color: Color
    width: float

    @property
    def box(self) -> Rect:
        """What it covers."""
        x, y = zip(*self.points, strict=True)
        wide = self.width + 1
        return min(x) - wide, min(y) - wide, max(x) + wide, max(y) + wide


@dataclass(frozen=True)
class Strip:
    """A rectangle whose colour changes from left to right."""

    box: Rect
    colors: tuple[tuple[int, int, int], ...]
    """At equal steps, from the left edge to the right one."""


Mark = Text | Box | Line | Strip


def halo_width(size: float) -> float:
    """How wide a rim letters of a size have."""
    return max(1.0, float(round(size / 7)))


@lru_cache(maxsize=32)
def _font(size: float) -> Any:
    from PIL import ImageFont

    with as_file(FONT) as path:
        return ImageFont.truetype(str(path), size)


@lru_cache(maxsize=8192)
def text_width(text: str, size: float) -> float:
    """Width of words, in the unit of ``size``."""
    return float(_font(size).getlength(text))


def covered(marks: Sequence[Mark]) -> Rect | None:
    """The rectangle around marks; ``None`` if there are none."""
    if not marks:
        return None
    boxes = np.array([mark.box for mark in marks])
    left, top = boxes[:, :2].min(axis=0).tolist()
    right, bottom = boxes[:, 2:].max(axis=0).tolist()
    return left, top, right, bottom


def paint(pixels: NDArray[np.uint8], marks: Sequence[Mark], top: int = 0) -> NDArray[np.uint8]:
    """A picture, or some of its rows, with marks on it.

    Args:
        pixels: (rows, width, 4) straight alpha.
        marks: In pixels of the whole picture; later ones lie on earlier ones.
        top: Number of the first row.
    """
    from PIL import Image

    pixels = np.array(pixels)
    for rows, columns, seen, stamp in _stamps(marks, pixels.shape[:2], top):
        under = Image.fromarray(np.ascontiguousarray(pixels[rows, columns]), "RGBA")
        made = np.asarray(Image.alpha_composite(under, stamp))
        pixels[rows, columns, seen] = made[..., seen]
        pixels[rows, columns, 3] = made[..., 3]
    return pixels


def paint_linear(
    linear: NDArray[np.float32], marks: Sequence[Mark], top: int = 0
) -> NDArray[np.float32]:
    """The same for premultiplied linear light (rows, width, 4): it encodes to what :func:`paint`
    makes."""
    linear = np.array(linear)
    for rows, columns, seen, stamp in _stamps(marks, linear.shape[:2], top):
        over = np.asarray(stamp, np.float32) / 255
        under = linear[rows, columns]
        alpha = under[..., 3:]
        own = np.divide(under[..., :3], alpha, out=np.zeros_like(under[..., :3]), where=alpha > 0)
        whole = over[..., 3:] + alpha * (1 - over[..., 3:])
        share = np.divide(over[..., 3:], whole, out=np.zeros_like(whole), where=whole > 0)
        mixed = over[..., :3] * share + _encoded(own) * (1 - share)
        own[..., seen] = _decoded(mixed)[..., seen]
        touched = over[..., 3:] > 0
        made = np.concatenate([own * whole, whole], axis=-1)
        linear[rows, columns] = np.where(touched, made, under)
    return linear


def _encoded(linear: NDArray) -> NDArray:
    linear = np.maximum(linear, 0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _decoded(srgb: NDArray) -> NDArray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _stamps(
    marks: Sequence[Mark], shape: tuple[int, ...], top: int
) -> Iterator[tuple[slice, slice, slice, Any]]:
    """For each mark that meets the rows: rows, columns and channels, and its RGBA picture there."""
    from PIL import Image, ImageDraw

    height, width = shape[:2]
    for mark in marks:
        left, high, right, low = mark.box
        x0, y0, x1, y1 = int(left) - 1, int(high) - 1, int(right) + 2, int(low) + 2
        seen = max(x0, 0), max(y0, top), min(x1, width), min(y1, top + height)
        if seen[0] >= seen[2] or seen[1] >= seen[3]:
            continue
        # drawn whole, then cut: what is drawn must not depend on what is seen of it
        fine = _FINE if isinstance(mark, Line) else 1
        stamp = Image.new("RGBA", (fine * (x1 - x0), fine * (y1 - y0)), (*_ground(mark)[:3], 0))
        _draw(ImageDraw.Draw(stamp), mark, x0, y0)
        if fine > 1:
            stamp = stamp.reduce(fine)
        stamp = stamp.crop((seen[0] - x0, seen[1] - y0, seen[2] - x0, seen[3] - y0))
        channels = _SEEN_BY[mark.eye if isinstance(mark, Text) else 0]
        yield slice(seen[1] - top, seen[3] - top), slice(seen[0], seen[2]), channels, stamp


def _ground(mark: Mark) -> Color:
    """What colour transparent pixels around a mark have: edges are mixed with it."""
    if isinstance(mark, Strip):
        return (0, 0, 0, 0)
    return mark.halo if isinstance(mark, Text) and mark.halo is not None else mark.color


def _draw(draw: Any, mark: Mark, x0: int, y0: int) -> None:
    """One mark into a picture whose upper left pixel is (x0, y0)."""
    if isinstance(mark, Text):
        options: dict[str, Any] = {}
        if mark.halo is not None:
            options = {"stroke_width": int(mark.rim), "stroke_fill": mark.halo}
        draw.text((mark.x - x0, mark.y - y0), mark.text, mark.color, _font(mark.size),
                  anchor=f"{mark.align}s", **options)  # fmt: skip
        return
    left, top, right, bottom = mark.box
    if isinstance(mark, Box):
        draw.rectangle((round(left) - x0, round(top) - y0, round(right) - x0 - 1,
                        round(bottom) - y0 - 1), fill=mark.color)  # fmt: skip
    elif isinstance(mark, Line):
        points = [(_FINE * (x - x0) - 0.5, _FINE * (y - y0) - 0.5) for x, y in mark.points]
        draw.line(points, fill=mark.color, width=max(1, round(_FINE * mark.width)), joint="curve")
    else:
        colors = np.array(mark.colors, float)
        first, last = round(left), round(right)
        at = (np.arange(first, last) + 0.5 - left) / (right - left) * (len(colors) - 1)
        for x, place in zip(range(first, last), at, strict=True):
            rgb = [np.interp(place, np.arange(len(colors)), channel) for channel in colors.T]
            draw.line((x - x0, round(top) - y0, x - x0, round(bottom) - y0 - 1),
                      fill=(*(round(c) for c in rgb), 255))  # fmt: skip
