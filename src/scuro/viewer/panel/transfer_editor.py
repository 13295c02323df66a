"""The transfer function over the histogram: points of opacity to be dragged."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import ScuroError
from scuro.kept import kept_with
from scuro.scene.reservoir import ReservoirItem
from scuro.settings import parameters
from scuro.style.transfer import TransferFunction
from scuro.style.transfer_choose import choose_transfer
from scuro.viewer.panel.fields import Fields
from scuro.viewer.panel.groups import buttons, heading, words
from scuro.viewer.view import View
from scuro.viewer.windowing import toggle_windowing

_HEIGHT = 120.0
_REACH = 8.0
"""Pixels within which a press takes a point."""
_BINS = 64
_GROUND, _LINE, _POINT, _RIM = 0xFF1E1A18, 0xFFFFFFFF, 0xFF2A90FF, 0xFF201A16
_BRIEF = "drag points"
_HELP = "drag a point; double click adds one, right click removes it"
_OPAQUE = "cells and slices are opaque: opacity comes with show volume"
_COLORMAPS = (
    "auto", "gray", "viridis", "magma", "inferno", "plasma", "cividis", "turbo", "jet", "hot",
    "bone", "coolwarm", "RdBu", "Spectral", "terrain", "YlGnBu",
)  # fmt: skip
"""Offered; every name that matplotlib knows can be typed."""


@dataclass(frozen=True)
class _Subject:
    """What is edited: a volume or a reservoir's property."""

    group: str
    """Of the settings."""
    low: float
    high: float
    counts: NDArray
    """(64,) values in each bin of the range."""
    transfer: TransferFunction
    title: str = ""
    """The property and its unit."""
    opaque: bool = False
    """Whether it is shown without opacity: as cells or slices."""


class TransferEditor:
    """Edits colours and opacity of the scene's volume or reservoir."""

    def __init__(self, view: View) -> None:
        self.view = view
        self._fields = Fields()
        self._held: int | None = None

    def draw(self) -> None:
        """The editor; nothing where there is nothing to edit."""
        scene = self.view.model.scene
        if not (scene.volumes or scene.reservoirs):
            return
        if not heading("Transfer function", open=True):
            return
        try:
            subject = self._subject()
        except ScuroError as error:
            words(str(error))
            return
        self._graph(subject)
        self._colors(subject)
        if subject.group == "volume":
            self._window(subject)

    def _subject(self) -> _Subject:
        scene, settings = self.view.model.scene, self.view.model.settings
        if scene.volumes:
            item = scene.volumes[0]
            volume, chosen = item.volume, settings.volume
            low, high = volume.value_range
            transfer = item.shown or choose_transfer(
                volume, chosen.transfer, chosen.opacity, chosen.window, chosen.level
            )
            counts = volume.histogram.reshape(_BINS, -1).sum(axis=1)
            return _Subject("volume", low, high, counts, transfer)
        from scuro.style.reservoir import item_transfer, property_range

        reservoir = scene.reservoirs[0]
        low, high = property_range(reservoir.grid, reservoir.shown_property)
        counts = _counts(reservoir, reservoir.shown_property, reservoir.settings.time, low, high)
        name = reservoir.shown_property
        unit = reservoir.grid.property_unit(name)
        title = f"{name} ({unit})" if unit else name
        opaque = reservoir.show != "volume"
        return _Subject("reservoir", low, high, counts, item_transfer(reservoir), title, opaque)

    # --- the graph ---------------------------------------------------------------------------

    def _graph(self, subject: _Subject) -> None:
        from imgui_bundle import imgui

        width = imgui.get_content_region_avail().x
        low, span = subject.low, (subject.high - subject.low) or 1.0
        x0, y0 = imgui.get_cursor_screen_pos()
        imgui.invisible_button("transfer", (width, _HEIGHT))
        active, hovered = imgui.is_item_active(), imgui.is_item_hovered()
        mouse_x, mouse_y = imgui.get_mouse_pos()
        value = low + min(max((mouse_x - x0) / width, 0.0), 1.0) * span
        opacity = min(max(1 - (mouse_y - y0) / _HEIGHT, 0.0), 1.0)
        points = [list(p) for p in subject.transfer.opacities] if not subject.opaque else []
        places = [(x0 + (v - low) / span * width, y0 + (1 - a) * _HEIGHT) for v, a in points]
        near = _nearest(places, mouse_x, mouse_y)
        shown = self._held if active else near if hovered else None
        _paint(imgui.get_window_draw_list(), subject, (x0, y0), width, places, shown)
        if subject.opaque:
            self._held = None  # colours alone: nothing to drag
        elif hovered and imgui.is_mouse_double_clicked(0) and near is None:
            self._set(subject, sorted([*points, [value, opacity]]), None)
        elif hovered and imgui.is_mouse_clicked(1) and near is not None and len(points) > 1:
            self._set(subject, points[:near] + points[near + 1 :], None)
        elif hovered and imgui.is_mouse_clicked(0):
            self._held = near
        elif active and self._held is not None and self._held < len(points):
            # a point stays between its neighbours, so that their order is kept
            left = points[self._held - 1][0] if self._held else low
            right = points[self._held + 1][0] if self._held + 1 < len(points) else subject.high
            points[self._held] = [min(max(value, left), right), opacity]
            self._set(subject, points, "transfer")
        elif not active and self._held is not None:
            self._held = None
            self.view.model.history.end_gesture()
        help = _OPAQUE if subject.opaque else _HELP
        imgui.text_disabled(f"{subject.low:.4g}")
        imgui.set_item_tooltip(help)
        brief = subject.title or _BRIEF
        if hovered or active:  # not beside the pointer: that would hide what is edited
            text = f"{value:.4g}" if subject.opaque else f"{value:.4g}: opacity {opacity:.2f}"
            imgui.same_line((width - imgui.calc_text_size(text).x) / 2)
            imgui.text(text)
        else:
            imgui.same_line((width - imgui.calc_text_size(brief).x) / 2)
            imgui.text_disabled(brief)
            imgui.set_item_tooltip(help)
        text = f"{subject.high:.4g}"
        imgui.same_line(width - imgui.calc_text_size(text).x)
        imgui.text_disabled(text)

    def _set(self, subject: _Subject, points: Any, gesture: str | None) -> None:
        text = " ".join(f"{v:.6g}:{a:.4g}" for v, a in points)
        self._change(gesture, **{f"{subject.group}__opacity": text})

    def _change(self, gesture: str | None, **changes: Any) -> None:
        model = self.view.model
        try:
            settings = model.settings.replace(**changes)
        except ScuroError as error:
            model.message = str(error)
            return
        model.change(gesture, settings=settings)

    # --- colours, window and level -----------------------------------------------------------

    def _colors(self, subject: _Subject) -> None:
        group = getattr(self.view.model.settings, subject.group)
        changed, word = self._fields.word_or_menu("colors", "colors", group.transfer, _COLORMAPS)
        if changed:
            self._change(None, **{f"{subject.group}__transfer": word})
        reset: dict[str, Any] = {f"{subject.group}__opacity": ""}
        if subject.group == "volume":
            reset |= {"volume__window": None, "volume__level": None}
        differs = any(getattr(group, name.partition("__")[2]) not in ("", None) for name in reset)
        act = (lambda: self._change(None, **reset)) if differs else None
        buttons(("Reset", "The opacity that suits the data", act))

    def _window(self, subject: _Subject) -> None:
        from imgui_bundle import imgui

        view, settings = self.view, self.view.model.settings.volume
        imgui.same_line()
        changed, _ = imgui.checkbox("window by dragging", view.windowing)
        imgui.set_item_tooltip(
            "Drag in the picture: to the right widens the window, up raises its level (key w)"
        )
        if changed:
            toggle_windowing(view)
        span = (subject.high - subject.low) or 1.0
        by_name = {p.name: p for p in parameters(type(settings))}
        window = span if settings.window is None else settings.window
        level = (subject.low + subject.high) / 2 if settings.level is None else settings.level
        for name, value, low, high in (
            ("window", window, span / 256, 2 * span),
            ("level", level, subject.low - span / 2, subject.high + span / 2),
        ):
            moved, new = imgui.slider_float(name, value, low, high, "%.4g")
            imgui.set_item_tooltip(by_name[name].help)
            if moved:
                both = {"volume__window": window, "volume__level": level}
                self._change("window", **both | {f"volume__{name}": new})
            if imgui.is_item_deactivated_after_edit():
                view.model.history.end_gesture()


@kept_with
def _counts(item: ReservoirItem, name: str, step: int, low: float, high: float) -> NDArray:
    """How many cells have values in each bin."""
    values = item.grid.values(name, step)
    return np.histogram(values[np.isfinite(values)], _BINS, (low, high))[0]


def _paint(
    paper: Any, subject: _Subject, corner: Any, width: float, places: Any, shown: int | None
) -> None:
    """Histogram (logarithmic, coloured by the transfer function), line and points."""
    x0, y0 = corner
    bottom = y0 + _HEIGHT
    paper.add_rect_filled((x0, y0), (x0 + width, bottom), _GROUND, 3.0)
    counts = np.log1p(subject.counts)
    heights = counts / max(counts.max(), 1e-9) * (_HEIGHT - 4)
    span = subject.high - subject.low
    middles = subject.low + (np.arange(_BINS) + 0.5) / _BINS * span
    colors = np.round(subject.transfer.color(middles) * 255).astype(int)
    for index, (height, (r, g, b)) in enumerate(zip(heights, colors.tolist(), strict=True)):
        # whole pixels: soft edges side by side would show as seams
        left, right = (int(x0 + n * width / _BINS) for n in (index, index + 1))
        color = 0xFF000000 | b << 16 | g << 8 | r
        paper.add_rect_filled((left, int(bottom - height)), (right, int(bottom)), color)
    paper.push_clip_rect((x0 - 6, y0 - 6), (x0 + width + 6, bottom + 6))
    for a, b in itertools.pairwise(places):
        paper.add_line(a, b, _RIM, 4.0)
        paper.add_line(a, b, _LINE, 1.5)
    for index, place in enumerate(places):
        paper.add_circle_filled(place, 5.5, _RIM)
        paper.add_circle_filled(place, 4.0, _POINT if index == shown else _LINE)
    paper.pop_clip_rect()


def _nearest(places: list[tuple[float, float]], x: float, y: float) -> int | None:
    if not places:
        return None
    away = [abs(px - x) + abs(py - y) for px, py in places]
    nearest = int(np.argmin(away))
    return nearest if away[nearest] <= _REACH else None
