"""Marks drawn by ImGui: what pictures have written over them, over a live one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from scuro.style.marks import Box, Color, Line, Mark, Text, text_width

_LINE = 2400 / 2048
"""Height of ImGui's lines, which is what its sizes of fonts are, in sizes of letters."""
_ASCENT = 1900 / 2048
_AROUND = [(math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4]


def draw_marks(paper: Any, marks: Sequence[Mark], ratio: float) -> None:
    """Draw marks into an ImGui draw list.

    Args:
        paper: The draw list.
        marks: In physical pixels.
        ratio: Of those to a logical pixel.
    """
    for mark in marks:
        if isinstance(mark, Text):
            _text(paper, mark, ratio)
        elif isinstance(mark, Line):
            points = [(x / ratio, y / ratio) for x, y in mark.points]
            for a, b in itertools.pairwise(points):
                paper.add_line(a, b, packed(mark.color), max(1.0, mark.width / ratio))
        else:
            left, top, right, bottom = (round(v) / ratio for v in mark.box)
            if isinstance(mark, Box):
                paper.add_rect_filled((left, top), (right, bottom), packed(mark.color))
                continue
            edges = np.linspace(left, right, len(mark.colors)).tolist()
            colors = [packed((*color, 255)) for color in mark.colors]
            for (a, b), (one, two) in zip(
                itertools.pairwise(edges), itertools.pairwise(colors), strict=True
            ):
                paper.add_rect_filled_multi_color((a, top), (b, bottom), one, two, two, one)


def _text(paper: Any, mark: Text, ratio: float) -> None:
    from imgui_bundle import imgui

    font, size = imgui.get_font(), _LINE * mark.size / ratio
    share = {"l": 0.0, "m": 0.5, "r": 1.0}[mark.align]
    x = (mark.x - share * text_width(mark.text, mark.size)) / ratio
    y = (mark.y - _ASCENT * mark.size) / ratio
    if mark.halo is not None:
        rim = mark.rim / ratio
        for dx, dy in _AROUND:
            paper.add_text(font, size, (x + rim * dx, y + rim * dy), packed(mark.halo), mark.text)
    paper.add_text(font, size, (x, y), packed(mark.color), mark.text)


def packed(color: Color) -> int:
    """As ImGui packs colours: alpha, blue, green, red."""
    r, g, b, a = color
    return a << 24 | b << 16 | g << 8 | r
