"""The transfer function over the histogram: points of opacity to be dragged."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from scuro.errors import ScuroError
from scuro.style.transfer_choose import choose_transfer
from scuro.viewer.view import View

_HEIGHT = 110.0
_REACH = 8.0
"""Pixels within which a press takes a point."""
_GROUND, _LINE, _POINT = 0xFF262626, 0xFFFFFFFF, 0xFF20A0FF


class TransferEditor:
    """Edits ``settings.volume.opacity`` of the scene's volume; colours follow the colour map."""

    def __init__(self, view: View) -> None:
        self.view = view
        self._held: int | None = None

    def draw(self, width: float) -> None:
        """The editor, so wide; nothing where there is no volume."""
        from imgui_bundle import imgui

        model = self.view.model
        if not model.scene.volumes or not imgui.collapsing_header("Transfer function"):
            return
        volume = model.scene.volumes[0].volume
        settings = model.settings.volume
        try:
            transfer = choose_transfer(
                volume, settings.transfer, settings.opacity, settings.window, settings.level
            )
        except ScuroError as error:
            imgui.text_wrapped(str(error))
            return
        low, high = volume.value_range
        span = (high - low) or 1.0
        x0, y0 = imgui.get_cursor_screen_pos()
        imgui.invisible_button("transfer", (width, _HEIGHT))
        active, hovered = imgui.is_item_active(), imgui.is_item_hovered()
        mouse_x, mouse_y = imgui.get_mouse_pos()
        value = low + min(max((mouse_x - x0) / width, 0.0), 1.0) * span
        opacity = min(max(1 - (mouse_y - y0) / _HEIGHT, 0.0), 1.0)
        points = [list(p) for p in transfer.opacities]
        places = [(x0 + (v - low) / span * width, y0 + (1 - a) * _HEIGHT) for v, a in points]
        self._paint(imgui.get_window_draw_list(), volume, transfer, (x0, y0), width, places)
        if hovered:
            imgui.set_tooltip(f"{value:g}: opacity {opacity:.2f}\ndouble click adds, right removes")
        near = _nearest(places, mouse_x, mouse_y)
        if hovered and imgui.is_mouse_double_clicked(0) and near is None:
            self._set(sorted([*points, [value, opacity]]), None)
        elif hovered and imgui.is_mouse_clicked(1) and near is not None and len(points) > 1:
            self._set(points[:near] + points[near + 1 :], None)
        elif hovered and imgui.is_mouse_clicked(0):
            self._held = near
        elif active and self._held is not None and self._held < len(points):
            # a point stays between its neighbours, so that their order is kept
            left = points[self._held - 1][0] if self._held else low
            right = points[self._held + 1][0] if self._held + 1 < len(points) else high
            points[self._held] = [min(max(value, left), right), opacity]
            self._set(points, "transfer")
        elif not active:
            self._held = None

    def _set(self, points: Any, gesture: str | None) -> None:
        text = " ".join(f"{v:.6g}:{a:.4g}" for v, a in points)
        model = self.view.model
        model.change(gesture, settings=model.settings.replace(volume__opacity=text))

    def _paint(
        self, paper: Any, volume: Any, transfer: Any, corner: Any, width: float, places: Any
    ) -> None:
        """Histogram (logarithmic, coloured by the transfer function), line and points."""
        x0, y0 = corner
        bottom = y0 + _HEIGHT
        paper.add_rect_filled((x0, y0), (x0 + width, bottom), _GROUND)
        counts = np.log1p(volume.histogram.reshape(64, 4).sum(axis=1))
        heights = counts / max(counts.max(), 1e-9) * _HEIGHT
        low, high = volume.value_range
        middles = low + (np.arange(64) + 0.5) / 64 * (high - low)
        colors = np.round(transfer.color(middles) * 255).astype(int)
        for index, (height, (r, g, b)) in enumerate(zip(heights, colors.tolist(), strict=True)):
            left = x0 + index * width / 64
            color = 0xFF000000 | b << 16 | g << 8 | r
            paper.add_rect_filled((left, bottom - height), (left + width / 64, bottom), color)
        for a, b in itertools.pairwise(places):
            paper.add_line(a, b, _LINE, 1.5)
        for place in places:
            paper.add_circle_filled(place, 4.0, _POINT)


def _nearest(places: list[tuple[float, float]], x: float, y: float) -> int | None:
    away = [abs(px - x) + abs(py - y) for px, py in places]
    nearest = int(np.argmin(away))
    return nearest if away[nearest] <= _REACH else None
