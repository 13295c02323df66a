"""Legends: what the colours of a picture mean, and how that is laid out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.style.marks import Box, Color, Line, Mark, Strip, Text, text_width

STEPS = 64
"""Colours of a strip."""
MOST_SWATCHES = 12
_LINE = 1.35
"""Height of a line, in sizes of letters."""
_NARROW, _WIDE, _STEP = 8.0, 26.0, 3.0
"""Width of a legend at least and at most, and its steps, in sizes of letters: one whose words
change from frame to frame changes its width seldom."""
_STRIP_WIDE = 17.0
"""Width at least of one with a strip."""
_MOST_ACROSS = 0.45
"""Share of a picture's width that wide legends may take."""
_PLOT, _STRIP, _TICK = 3.6, 0.9, 0.3
"""Heights of histogram, colours and ticks, in sizes of letters."""
_MOST_TICKS = 5


@dataclass(frozen=True)
class Legend:
    """What one thing's colours mean: along a strip from low to high, or one by one."""

    title: str
    """The property, with its unit."""
    lines: tuple[str, ...] = ()
    """What else is to be said: the model, a date."""
    low: float = 0.0
    high: float = 1.0
    strip: tuple[tuple[int, int, int], ...] = ()
    """sRGB at equal steps from low to high."""
    ends: tuple[str, str] | None = None
    """Words in place of numbers below the strip."""
    bars: tuple[float, ...] = ()
    """A histogram over the strip, 0 to 1."""
    curve: tuple[float, ...] = ()
    """Opacity over the strip, 0 to 1 of its greatest."""
    swatches: tuple[tuple[tuple[int, int, int], str], ...] = ()
    """Colours with their names."""
    more: int = 0
    """Names that there was no room for."""

    def height(self, text: float) -> float:
        """In pixels, for letters of a size."""
        lines = 1 + len(self.lines) + len(self.swatches) + bool(self.more)
        plot = (_PLOT if self.bars or self.curve else 0.3) + _STRIP + _TICK + _LINE
        return text * (_LINE * lines + (plot if self.strip else 0.0) + 0.6)

    def width(self, text: float) -> float:
        """Likewise, for all of its words and numbers."""
        words = [text_width(line, text) for line in (self.title, *self.lines)]
        words += [text_width(name, text) + 1.7 * text for _, name in self.swatches]
        if self.ends is not None:
            words.append(sum(text_width(end, text) for end in self.ends) + text)
        least = text * (_STRIP_WIDE if self.strip else _NARROW)
        return max(least, max(words) + 1.4 * text + 1)


def ticks(low: float, high: float, most: int = _MOST_TICKS) -> list[float]:
    """Round numbers from low to high, at most so many, a step of 1, 2 or 5 apart."""
    span = high - low
    power = 10.0 ** math.floor(math.log10(span / most))
    found: list[float] = []
    for factor in (1, 2, 5, 10, 20):
        step = factor * power
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        found = [n * step for n in range(first, last + 1)]
        if len(found) <= most:
            break
    return found


def tick_text(value: float, values: Sequence[float]) -> str:
    """A tick's number, with no more digits than tell it from its neighbours."""
    step = abs(values[1] - values[0]) if len(values) > 1 else abs(value) or 1.0
    largest = max(abs(v) for v in values)
    if largest >= 1e6 or (largest and largest < 1e-4):
        return f"{value:.3g}"
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return f"{value:.{digits}f}".replace("-", "−")


def legend_marks(
    legends: Sequence[Legend],
    size: tuple[int, int],
    text: float,
    corner: str,
    ink: Color,
    paper: Color,
) -> list[Mark]:
    """Legends in a corner of a picture, one over the other; those without room are left out.

    Args:
        legends: What there is to tell.
        size: Of the picture.
        text: Height of letters.
        corner: ``lower left`` and the like.
        ink: Of letters.
        paper: Behind them.
    """
    margin = text
    wanted = max((legend.width(text) for legend in legends), default=0.0) / text
    wanted = min(_NARROW + _STEP * math.ceil((wanted - _NARROW) / _STEP), _WIDE) * text
    wanted = min(wanted, max(_STRIP_WIDE * text, _MOST_ACROSS * size[0]))
    width = min(wanted, size[0] - 2 * margin)
    vertical, horizontal = corner.split()
    left = margin if horizontal == "left" else size[0] - margin - width
    marks: list[Mark] = []
    edge = margin if vertical == "upper" else size[1] - margin
    for legend in legends:
        tall = legend.height(text)
        top = edge if vertical == "upper" else edge - tall
        if marks and (top < margin or top + tall > size[1] - margin):
            break
        marks += _marks(legend, (left, top), width, text, ink, paper)
        edge = top + tall + margin / 2 if vertical == "upper" else top - margin / 2
    return marks


def _marks(
    legend: Legend, corner: tuple[float, float], width: float, text: float, ink: Color, paper: Color
) -> Iterator[Mark]:
    left, top = corner
    x0, x1 = left + 0.7 * text, left + width - 0.7 * text
    yield Box((left, top, left + width, top + legend.height(text)), paper)
    y = top + 0.3 * text
    faint = (*(round(0.62 * i + 0.38 * p) for i, p in zip(ink[:3], paper[:3], strict=True)), 255)
    for n, line in enumerate((legend.title, *legend.lines)):
        y += _LINE * text
        yield Text(_fitted(line, text, x1 - x0), x0, y - 0.35 * text, text,
                   ink if n == 0 else faint)  # type: ignore[arg-type]  # fmt: skip
    if legend.strip:
        tall = _PLOT * text if legend.bars or legend.curve else 0.3 * text
        yield from _plot(legend, (x0, y, x1, y + tall), ink, paper, text)
        y += tall
        yield Strip((x0, y, x1, y + _STRIP * text), legend.strip)
        y += _STRIP * text
        yield from _axis(legend, x0, x1, y, text, ink)
        y += (_TICK + _LINE) * text
    for color, name in legend.swatches:
        y += _LINE * text
        yield Box((x0, y - 1.1 * text, x0 + 1.2 * text, y - 0.25 * text), (*color, 255))
        yield Text(_fitted(name, text, x1 - x0 - 1.7 * text), x0 + 1.7 * text, y - 0.35 * text,
                   text, ink)  # fmt: skip
    if legend.more:
        y += _LINE * text
        yield Text(f"and {legend.more} more", x0 + 1.7 * text, y - 0.35 * text, text, ink)


def _plot(
    legend: Legend, box: tuple[float, float, float, float], ink: Color, paper: Color, text: float
) -> Iterator[Mark]:
    """The histogram as bars, the opacity as a curve, both to the box's full height."""
    x0, y0, x1, y1 = box
    y0 += 0.3 * text
    mixed = (round(0.28 * i + 0.72 * p) for i, p in zip(ink[:3], paper[:3], strict=True))
    bar: Color = (*mixed, 255)  # type: ignore[assignment]
    edges = np.linspace(x0, x1, len(legend.bars) + 1)
    for n, share in enumerate(legend.bars):
        if share > 0:
            yield Box((float(edges[n]), y1 - share * (y1 - y0), float(edges[n + 1]), y1), bar)
    if legend.curve:
        x = np.linspace(x0, x1, len(legend.curve))
        points = [(float(a), y1 - o * (y1 - y0)) for a, o in zip(x, legend.curve, strict=True)]
        yield Line(tuple(points), ink, max(1.0, text / 10))


def _axis(
    legend: Legend, x0: float, x1: float, y: float, text: float, ink: Color
) -> Iterator[Mark]:
    """Ticks below the strip, and their numbers, as many as there is room for."""
    base = y + (_TICK + 0.9) * text
    if legend.ends is not None:
        yield Text(legend.ends[0], x0, base, text, ink)
        yield Text(legend.ends[1], x1, base, text, ink, align="r")
        return
    for most in range(_MOST_TICKS, 1, -1):
        values = ticks(legend.low, legend.high, most)
        words = [tick_text(v, values) for v in values]
        room = sum(text_width(w, text) + 0.8 * text for w in words)
        if room <= x1 - x0 + 0.8 * text:
            break
    span = legend.high - legend.low
    for value, word in zip(values, words, strict=True):
        x = x0 + (value - legend.low) / span * (x1 - x0)
        yield Line(((x, y), (x, y + _TICK * text)), ink, max(1.0, text / 12))
        half = text_width(word, text) / 2
        # numbers stay within the legend
        yield Text(word, min(max(x, x0 + half - 0.4 * text), x1 - half + 0.4 * text), base, text,
                   ink, align="m")  # fmt: skip


def _fitted(words: str, text: float, room: float) -> str:
    """Words, cut where they would not fit."""
    if text_width(words, text) <= room:
        return words
    while words and text_width(words + "…", text) > room:
        words = words[:-1]
    return words.rstrip() + "…"


def opacity_curve(opacity: NDArray) -> tuple[float, ...]:
    """(n,) opacities in shares of the greatest."""
    top = max(float(opacity.max()), 1e-9)
    return tuple((opacity / top).tolist())


def strip_colors(rgb: NDArray) -> tuple[tuple[int, int, int], ...]:
    """(n, 3) sRGB 0 to 1 as a strip's colours."""
    return tuple((r, g, b) for r, g, b in np.rint(255 * rgb).astype(int).tolist())


def bar_shares(counts: NDArray) -> tuple[float, ...]:
    """A histogram's counts as heights: square roots, so that one tall bin does not flatten all."""
    return tuple(np.sqrt(counts / max(int(counts.max(initial=1)), 1)).tolist())
