"""One control for one setting, made from its type, range, unit and help."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from scuro.errors import SettingsError
from scuro.settings import Parameter, checked
from scuro.style.paint import srgb

_LOGARITHMIC = 100.0
"""Sliders whose largest value is so many times their smallest are logarithmic."""


class Fields:
    """Draws controls, and keeps text that is being typed until it is finished."""

    def __init__(self) -> None:
        self._typed: dict[str, str] = {}

    def edit(self, place: str, p: Parameter, value: Any) -> tuple[bool, Any]:
        """Draw the control of a setting.

        Args:
            place: Unique name of the setting in the panel.
            p: The setting.
            value: Its present value.

        Returns:
            Whether it was changed, and the value to have.
        """
        from imgui_bundle import imgui

        imgui.push_id(place)
        imgui.begin_group()
        try:
            changed, new = self._optional(place, p, value)
        finally:
            imgui.end_group()
            imgui.pop_id()
        imgui.set_item_tooltip(_tooltip(p).replace("%", "%%"))
        if changed:
            try:
                return True, checked(p, new)
            except SettingsError:
                return False, value
        return False, value

    def _optional(self, place: str, p: Parameter, value: Any) -> tuple[bool, Any]:
        from imgui_bundle import imgui

        if not p.optional:
            return self._value(place, p, value)
        if p.switch:
            _, on = imgui.checkbox("##on", value is not None)
        else:
            _, automatic = imgui.checkbox("auto##auto", value is None)
            on = not automatic
        imgui.same_line()
        if not on:
            imgui.text(label(p))
            return value is not None, None
        if value is None:
            return True, _start(p)
        taken = imgui.get_frame_height() + 7
        taken += 0 if p.switch else imgui.calc_text_size("auto").x + 7
        imgui.push_item_width(imgui.calc_item_width() - taken)
        try:
            return self._value(place, p, value)
        finally:
            imgui.pop_item_width()

    def _value(self, place: str, p: Parameter, value: Any) -> tuple[bool, Any]:
        if p.many:
            return self._many(place, p, value)
        if p.type is bool:
            from imgui_bundle import imgui

            return imgui.checkbox(label(p), value)
        if p.type is str:
            return self._word(place, p, value)
        return _number(label(p), p, value)

    def _many(self, place: str, p: Parameter, value: tuple) -> tuple[bool, Any]:
        """One row of numbers or words; their number is kept."""
        from imgui_bundle import imgui

        single = dataclasses.replace(p, many=False, length=None)
        changed, new = False, list(value)
        width = imgui.calc_item_width() / max(len(new), 1)
        for index, element in enumerate(value):
            imgui.push_item_width(width)
            if p.type is str:
                one, new[index] = self._word(f"{place}{index}", single, element, f"##{index}")
            else:
                one, new[index] = _number(f"##{index}", single, element, unit=False)
            imgui.pop_item_width()
            imgui.same_line(0, 2)
            changed |= one
        imgui.text(f"{label(p)} ({p.unit})" if p.unit else label(p))
        return changed, tuple(new)

    def _word(
        self, place: str, p: Parameter, value: str, title: str | None = None
    ) -> tuple[bool, str]:
        from imgui_bundle import imgui

        title = label(p) if title is None else title
        if p.choices:
            words = list(p.choices)
            changed, index = imgui.combo(title, words.index(value), words)
            return changed, words[index]
        if _is_color(p):
            r, g, b, _ = srgb(value)
            flags = imgui.ColorEditFlags_.no_inputs | imgui.ColorEditFlags_.no_label
            changed, rgb = imgui.color_edit3(f"##color{place}", [r, g, b], flags)
            if changed:
                return True, "#" + "".join(f"{round(c * 255):02x}" for c in rgb)
            imgui.same_line()
        return self.text(place, title, value)

    def text(self, place: str, title: str, value: str) -> tuple[bool, str]:
        """A line of text; it counts as changed when Enter is pressed or the field is left."""
        from imgui_bundle import imgui

        changed, typed = imgui.input_text(title, self._typed.get(place, value))
        if changed:
            self._typed[place] = typed
        if imgui.is_item_deactivated_after_edit():
            return True, self._typed.pop(place, value)
        if imgui.is_item_deactivated():
            self._typed.pop(place, None)
        return False, value

    def word_or_menu(
        self, place: str, title: str, value: str, known: tuple[str, ...]
    ) -> tuple[bool, str]:
        """A line of text with a menu of known words beside it."""
        from imgui_bundle import imgui

        imgui.push_id(place)
        width = imgui.calc_item_width()
        button = imgui.get_frame_height()
        imgui.push_item_width(width - button - 2)
        changed, word = self.text(place, "##text", value)
        imgui.pop_item_width()
        imgui.same_line(0, 2)
        if imgui.arrow_button("menu", imgui.Dir.down):
            imgui.open_popup("words")
        imgui.same_line()
        imgui.text(title)
        if imgui.begin_popup("words"):
            for one in known:
                if imgui.selectable(one, one == value)[0]:
                    changed, word = True, one
            imgui.end_popup()
        imgui.pop_id()
        return changed, word


def label(p: Parameter) -> str:
    """The setting's name in plain words."""
    return label_of(p.name)


def label_of(name: str) -> str:
    """A name of the settings in plain words."""
    return name.replace("_", " ")


def _number(title: str, p: Parameter, value: Any, unit: bool = True) -> tuple[bool, Any]:
    from imgui_bundle import imgui

    suffix = f" {p.unit}".replace("%", "%%") if unit and p.unit else ""
    flags = imgui.SliderFlags_.always_clamp
    low, high = p.low, p.high
    if low is not None and high is not None and low > 0 and high / low > _LOGARITHMIC:
        flags |= imgui.SliderFlags_.logarithmic
    whole = p.type is int
    form = ("%d" if whole else "%.4g") + suffix
    if low is not None and high is not None and high < 1e6:
        slider = imgui.slider_int if whole else imgui.slider_float
        return slider(title, p.type(value), p.type(low), p.type(high), form, flags)
    speed = max(abs(value) * 0.01, 0.2 if whole else 0.01)
    top: Any = 2**31 - 1 if whole else 3e38
    least: Any
    most: Any
    least, most = (-top if low is None else p.type(low)), (top if high is None else p.type(high))
    drag = imgui.drag_int if whole else imgui.drag_float
    return drag(title, p.type(value), speed, least, most, form, flags)


def _start(p: Parameter) -> Any:
    """The value a setting takes when it is no longer automatic."""
    if p.type is bool:
        one: Any = False
    elif p.type is str:
        one = p.choices[0] if p.choices else ""
    else:
        high = math.inf if p.high is None else p.high
        # the middle of a share, else what is nearest to 1
        start = 0.5 if (p.type, p.low, p.high) == (float, 0, 1) else 1.0
        one = p.type(min(max(start, p.low or 0.0), high))
    return (one,) * (p.length or 1) if p.many else one


def _is_color(p: Parameter) -> bool:
    """Whether a text setting is a colour: its default says so."""
    if p.optional or not p.default:
        return False
    try:
        srgb(p.default)
    except SettingsError:
        return False
    return True


def _tooltip(p: Parameter) -> str:
    low = "" if p.low is None else f"from {p.low:g} "
    high = "" if p.high is None else f"to {p.high:g} "
    span = f"{low}{high}{p.unit}".strip()
    return f"{p.help}\n{span}" if span else p.help
