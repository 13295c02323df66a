"""What lies over the picture: axis cross, scale bar, measures, labels, handles, hover text."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.style.gauges import nice_length, scene_unit
from scuro.style.labels import Label, placed
from scuro.style.marks import Rect
from scuro.viewer import navigate
from scuro.viewer.cube import EDGES
from scuro.viewer.handles import MOVE, PUSH, ROCK, TILT, Handles
from scuro.viewer.measure import Measure, measures
from scuro.viewer.pick import atom_name
from scuro.viewer.theme import ACCENT, INK, PAPER
from scuro.viewer.view import View

if TYPE_CHECKING:
    from scuro.viewer.navigate import Size

_AXES = (("x", 0xFF4444E6), ("y", 0xFF44B844), ("z", 0xFFE67844))
"""Colours as ImGui packs them: alpha, blue, green, red."""
_HANDLE, _EDGE = 0xFFE8E4E0, 0xB0302820
"""Handles are light with a dark rim: seen on every picture."""
_CROSS_GROUND = 0xB0FFFFFF
_CROSS = 26.0
"""Pixels from the middle of the axis cross to its tips."""
_BAR = 120.0
"""Longest scale bar, pixels."""


def draw_overlay(
    view: View,
    handles: Handles,
    size: Size,
    labels: Sequence[Label],
    hover: tuple[str, Size | None],
) -> None:
    """Draw over the picture with ImGui, behind its windows.

    Args:
        view: Whose camera and selection.
        handles: Of its clipping planes.
        size: Logical pixels of the picture.
        labels: Names to show at places.
        hover: What is under the pointer, in words, and where it is.
    """
    from imgui_bundle import imgui

    paper = imgui.get_background_draw_list()
    # where a picture of the view would have its own, these are drawn already
    if not view.model.settings.axes.show:
        _cross(paper, view, (50, size[1] - 50))
    if not view.model.settings.scale_bar.show:
        _scale_bar(paper, view, size)
    found = measures([p.anchor for p in view.selection], scene_unit(view.model.scene))
    taken = [_measure(paper, view, size, measure) for measure in found]
    _labels(paper, view, size, labels, [box for box in taken if box is not None])
    if handles.shown:
        _handles(paper, view, handles, size)
    if view.windowing:
        _text(paper, (14, 12), "window and level: drag; w ends it")
    words, pointer = hover
    if words and pointer is not None:
        _hover(paper, pointer, size, words)


def _hover(paper: Any, pointer: Size, size: Size, words: str) -> None:
    """Beside the pointer, inside the picture."""
    from imgui_bundle import imgui

    width, height = imgui.calc_text_size(words)
    x = min(pointer[0] + 16, size[0] - width - 8)
    y = pointer[1] + 18 if pointer[1] + 22 + height < size[1] else pointer[1] - height - 12
    _text(paper, (max(x, 6), max(y, 4)), words)


def _cross(paper: Any, view: View, middle: Size) -> None:
    from imgui_bundle import imgui

    rows = view.camera.view_from_world()[:3, :3]
    tips = [(rows[:, axis], *_AXES[axis]) for axis in range(3)]
    paper.add_circle_filled(middle, _CROSS + 14, _CROSS_GROUND, 48)
    # the axis that points away is drawn first
    for direction, name, color in sorted(tips, key=lambda tip: tip[0][2]):
        tip = (middle[0] + _CROSS * direction[0], middle[1] - _CROSS * direction[1])
        paper.add_line(middle, tip, color, 2.5)
        length = math.hypot(direction[0], direction[1])
        if length > 0.2:  # beyond the tip; an axis along the line of sight has none
            x, y = (middle[n] + (_CROSS + 8) * direction[n] * s for n, s in ((0, 1), (1, -1)))
            width, height = imgui.calc_text_size(name)
            paper.add_text((x - width / 2, y - height / 2), color, name)


def _scale_bar(paper: Any, view: View, size: Size) -> None:
    pixel = navigate.pixel_size(view.camera, size)
    length, text = nice_length(_BAR * pixel, scene_unit(view.model.scene))
    right, y = size[0] - 20, size[1] - 20
    left = right - length / pixel
    paper.add_rect_filled((left - 1, y - 1), (right + 1, y + 4), PAPER)
    paper.add_rect_filled((left, y), (right, y + 3), INK)
    _text(paper, (left, y - 20), text)


def _labels(
    paper: Any, view: View, size: Size, labels: Sequence[Label], taken: Sequence[Rect]
) -> None:
    from imgui_bundle import imgui

    if not labels:
        return
    extents = []
    for label in labels:
        width, height = imgui.calc_text_size(label.text)
        extents.append((width, height))
    places = navigate.project(view.camera, [label.position for label in labels], size)
    for index, corner in placed(places, extents, size, taken=taken):
        _text(paper, corner, labels[index].text)


def selection_labels(view: View) -> list[Label]:
    """The names of the selected atoms."""
    return [
        Label(atom_name(p.molecule, p.element), tuple(p.anchor.tolist()))
        for p in view.selection
        if p.molecule is not None
    ]


def _measure(paper: Any, view: View, size: Size, measure: Measure) -> Rect | None:
    """Draw a measure; what its words cover."""
    from imgui_bundle import imgui

    places = navigate.project(view.camera, measure.points, size)
    if not (places[:, 2] > 0).all():
        return None
    for a, b in itertools.pairwise(places):
        paper.add_line(tuple(a[:2]), tuple(b[:2]), ACCENT, 2.0)
    x, y = (places[:, :2].mean(axis=0) + np.array([6.0, 4.0])).tolist()
    _text(paper, (x, y), measure.text)
    width, height = imgui.calc_text_size(measure.text)
    return x - 3, y - 2, x + width + 3, y + height + 2


def _handles(paper: Any, view: View, handles: Handles, size: Size) -> None:
    from imgui_bundle import imgui

    every = handles.all()
    if not every:
        return
    corners = handles.corners()
    if corners is not None:
        places = navigate.project(view.camera, corners, size)
        seen = [(a, b) for a, b in EDGES if (places[[a, b], 2] > 0).all()]
        for ink, width in ((_EDGE, 3.0), (_HANDLE, 1.5)):
            for a, b in seen:
                paper.add_line(tuple(places[a, :2]), tuple(places[b, :2]), ink, width)
    for number, ring in enumerate(handles.rings()):
        around = navigate.project(view.camera, ring, size)
        if (around[:, 2] > 0).all():
            points = [imgui.ImVec2(x, y) for x, y in around[:, :2].tolist()]
            color = ACCENT if handles.chosen == number else _HANDLE
            for ink, width in ((_EDGE, 3.0), (color, 1.5)):
                paper.add_polyline(points, ink, width, imgui.ImDrawFlags_.closed)
    places = navigate.project(view.camera, [h.world for h in every], size)
    roots = navigate.project(view.camera, [h.root for h in every], size)
    for handle, place, root in zip(every, places, roots, strict=True):
        if not (place[2] > 0 and root[2] > 0):
            continue
        chosen = handle.kind in (PUSH, TILT, ROCK) and handles.chosen == handle.number
        held = handles.held is not None and handles.held.kind == handle.kind
        held = held and handles.held is not None and handles.held.number == handle.number
        color = ACCENT if chosen or held else _HANDLE
        middle = (place[0], place[1])
        if handle.root != handle.world:
            paper.add_line((root[0], root[1]), middle, _EDGE, 4.0)
            paper.add_line((root[0], root[1]), middle, color, 2.0)
        radius = 7.0 if handle.kind in (PUSH, MOVE) else 5.0
        paper.add_circle_filled(middle, radius + 1.5, _EDGE)
        paper.add_circle_filled(middle, radius, color)


def arrow(paper: Any, view: View, size: Size, start: Any, vector: Any, color: int) -> None:
    """An arrow from a world point along a world vector."""
    places = navigate.project(view.camera, [start, np.add(start, vector)], size)
    if not (places[:, 2] > 0).all():
        return
    a, b = places[:, :2]
    paper.add_line(tuple(a), tuple(b), color, 3.0)
    along = b - a
    length = float(np.hypot(*along))
    if length > 1:
        along = along / length * min(10.0, length / 2)
        side = np.array([-along[1], along[0]]) * 0.5
        paper.add_triangle_filled(tuple(b), tuple(b - along + side), tuple(b - along - side), color)


def _text(paper: Any, corner: Size, text: str) -> None:
    """Dark text on a light ground: readable on every picture."""
    from imgui_bundle import imgui

    width, height = imgui.calc_text_size(text)
    x, y = corner
    paper.add_rect_filled((x - 3, y - 2), (x + width + 3, y + height + 2), PAPER, 3.0)
    paper.add_text((x, y), INK, text)
