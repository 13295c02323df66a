"""What lies over the picture: axis cross, scale bar, measures, labels, handles, hover text."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.style.gauges import inks, nice_length, scene_unit
from scuro.style.labels import Label, placed
from scuro.style.marks import Rect
from scuro.style.paint import linear_rgba
from scuro.viewer import navigate
from scuro.viewer.cube import EDGES
from scuro.viewer.eyes import Eye, eye_at, pictures
from scuro.viewer.handles import MOVE, PUSH, ROCK, TILT, Handles
from scuro.viewer.marks import packed
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
_CROSS_GROUND = 0xB0
"""Alpha of what lies behind the axis cross."""
_CROSS = 26.0
"""Pixels from the middle of the axis cross to its tips."""
_BAR = 120.0
"""Longest scale bar, pixels."""


def draw_hung(view: View, handles: Handles, eye: Eye, labels: Sequence[Label]) -> None:
    """Draw what hangs on places of the scene with ImGui, behind its windows, for one eye.

    Args:
        view: Whose selection.
        handles: Of its clipping planes.
        eye: Who sees it, in logical pixels.
        labels: Names to show at places.
    """
    from imgui_bundle import imgui

    paper = imgui.get_background_draw_list()
    found = measures([p.anchor for p in view.selection], scene_unit(view.model.scene))
    taken = [_measure(paper, eye, measure) for measure in found]
    _labels(paper, view, eye, labels, [box for box in taken if box is not None])
    if handles.shown:
        _handles(paper, handles, eye)


def draw_flat(view: View, eyes: Sequence[Eye], hover: tuple[str, Size | None]) -> None:
    """Draw what lies on the picture itself: side by side on both, without parallax.

    Args:
        view: Whose picture.
        eyes: Who sees it, in logical pixels.
        hover: What is under the pointer, in words, and where it is.
    """
    from imgui_bundle import imgui

    paper = imgui.get_background_draw_list()
    words, pointer = hover
    ink, ground = inks(linear_rgba(view.model.settings.background))
    over = None if pointer is None else eye_at(eyes, pointer[0])
    for eye in pictures(eyes):
        # where a picture of the view would have its own, these are drawn already
        if not view.model.settings.axes.show:
            # as in pictures: above, where the legend has the corner
            legend = view.model.settings.legend
            above = legend.show and legend.corner == "lower left"
            disc = packed((*ground[:3], _CROSS_GROUND))
            _cross(paper, view, (eye.start + 50, 50 if above else eye.size[1] - 50), disc)
        if not view.model.settings.scale_bar.show:
            _scale_bar(paper, view, eye, packed(ink), packed((*ground[:3], 230)))
        if view.windowing:
            _text(paper, (eye.start + 14, 12), "window and level: drag; w ends it")
        if words and pointer is not None and over is not None:
            place = (pointer[0] - over.start + eye.start, pointer[1])
            if eye.start != over.start:  # the pointer itself is in one picture only
                paper.add_circle(place, 5.0, _EDGE, 24, 3.5)
                paper.add_circle(place, 5.0, _HANDLE, 24, 1.5)
            _hover(paper, place, eye, words)


def _hover(paper: Any, pointer: Size, eye: Eye, words: str) -> None:
    """Beside the pointer, inside the picture."""
    from imgui_bundle import imgui

    width, height = imgui.calc_text_size(words)
    x = min(pointer[0] + 16, eye.start + eye.size[0] - width - 8)
    below = pointer[1] + 22 + height < eye.size[1]
    y = pointer[1] + 18 if below else pointer[1] - height - 12
    _text(paper, (max(x, eye.start + 6), max(y, 4)), words)


def _cross(paper: Any, view: View, middle: Size, disc: int) -> None:
    from imgui_bundle import imgui

    rows = view.camera.view_from_world()[:3, :3]
    tips = [(rows[:, axis], *_AXES[axis]) for axis in range(3)]
    paper.add_circle_filled(middle, _CROSS + 14, disc, 48)
    # the axis that points away is drawn first
    for direction, name, color in sorted(tips, key=lambda tip: tip[0][2]):
        tip = (middle[0] + _CROSS * direction[0], middle[1] - _CROSS * direction[1])
        paper.add_line(middle, tip, color, 2.5)
        length = math.hypot(direction[0], direction[1])
        if length > 0.2:  # beyond the tip; an axis along the line of sight has none
            x, y = (middle[n] + (_CROSS + 8) * direction[n] * s for n, s in ((0, 1), (1, -1)))
            width, height = imgui.calc_text_size(name)
            paper.add_text((x - width / 2, y - height / 2), color, name)


def _scale_bar(paper: Any, view: View, eye: Eye, ink: int, ground: int) -> None:
    pixel = navigate.pixel_size(view.camera, eye.size)
    length, text = nice_length(_BAR * pixel, scene_unit(view.model.scene))
    right, y = eye.start + eye.size[0] - 20, eye.size[1] - 20
    left = right - length / pixel
    paper.add_rect_filled((left - 1, y - 1), (right + 1, y + 4), ground)
    paper.add_rect_filled((left, y), (right, y + 3), ink)
    _text(paper, (left, y - 20), text, ink, ground)


def _labels(
    paper: Any, view: View, eye: Eye, labels: Sequence[Label], taken: Sequence[Rect]
) -> None:
    from imgui_bundle import imgui

    if not labels:
        return
    extents = []
    for label in labels:
        width, height = imgui.calc_text_size(label.text)
        extents.append((width, height))
    anchors = [label.position for label in labels]
    # both eyes see them laid out alike, each at its anchor's depth
    places = navigate.project(view.camera, anchors, eye.size)
    moved = eye.project(anchors) - places
    free = [(left - eye.start, top, right - eye.start, low) for left, top, right, low in taken]
    for index, (x, y) in placed(places, extents, eye.size, taken=free):
        _text(paper, (x + moved[index, 0], y + moved[index, 1]), labels[index].text)


def selection_labels(view: View) -> list[Label]:
    """The names of the selected atoms."""
    return [
        Label(atom_name(p.molecule, p.element), tuple(p.anchor.tolist()))
        for p in view.selection
        if p.molecule is not None
    ]


def _measure(paper: Any, eye: Eye, measure: Measure) -> Rect | None:
    """Draw a measure; what its words cover."""
    from imgui_bundle import imgui

    places = eye.project(measure.points)
    if not (places[:, 2] > 0).all():
        return None
    for ink, width in ((_EDGE, 4.0), (ACCENT, 2.0)):
        for a, b in itertools.pairwise(places):
            paper.add_line(tuple(a[:2]), tuple(b[:2]), ink, width)
    x, y = (places[:, :2].mean(axis=0) + np.array([6.0, 4.0])).tolist()
    _text(paper, (x, y), measure.text)
    width, height = imgui.calc_text_size(measure.text)
    return x - 3, y - 2, x + width + 3, y + height + 2


def _handles(paper: Any, handles: Handles, eye: Eye) -> None:
    from imgui_bundle import imgui

    every = handles.all()
    if not every:
        return
    corners = handles.corners()
    if corners is not None:
        places = eye.project(corners)
        seen = [(a, b) for a, b in EDGES if (places[[a, b], 2] > 0).all()]
        for ink, width in ((_EDGE, 3.0), (_HANDLE, 1.5)):
            for a, b in seen:
                paper.add_line(tuple(places[a, :2]), tuple(places[b, :2]), ink, width)
    for number, ring in enumerate(handles.rings()):
        around = eye.project(ring)
        if (around[:, 2] > 0).all():
            points = [imgui.ImVec2(x, y) for x, y in around[:, :2].tolist()]
            color = ACCENT if handles.chosen == number else _HANDLE
            for ink, width in ((_EDGE, 3.0), (color, 1.5)):
                paper.add_polyline(points, ink, width, imgui.ImDrawFlags_.closed)
    places = eye.project([h.world for h in every])
    roots = eye.project([h.root for h in every])
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


def arrow(paper: Any, eye: Eye, start: Any, vector: Any, color: int) -> None:
    """An arrow with a light rim from a world point along a world vector, as an eye sees it."""
    places = eye.project([start, np.add(start, vector)])
    if not (places[:, 2] > 0).all():
        return
    a, b = places[:, :2]
    length = float(np.hypot(*(b - a)))
    if length <= 1:
        return
    along = (b - a) / length
    side = np.array([-along[1], along[0]])
    for ink, rim in ((_HANDLE, 1.5), (color, 0.0)):
        head = min(10.0, length / 2) + 2 * rim
        tip, foot = b + 2 * rim * along, b + (2 * rim - head) * along
        wide = (0.5 * head + rim) * side
        paper.add_line(tuple(a), tuple(foot), ink, 3.0 + 2 * rim)
        paper.add_triangle_filled(tuple(tip), tuple(foot + wide), tuple(foot - wide), ink)


def _text(paper: Any, corner: Size, text: str, ink: int = INK, ground: int = PAPER) -> None:
    """Text on a ground of its own: readable on every picture."""
    from imgui_bundle import imgui

    width, height = imgui.calc_text_size(text)
    x, y = corner
    paper.add_rect_filled((x - 3, y - 2), (x + width + 3, y + height + 2), ground, 3.0)
    paper.add_text((x, y), ink, text)
