"""Controls for whole groups of settings: a new setting has its control without any code here."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from scuro.errors import ScuroError
from scuro.settings import SettingsGroup, parameters, subgroups
from scuro.style.gauges import scene_unit
from scuro.viewer.panel.fields import Fields, label_of
from scuro.viewer.view import View


class Groups:
    """Draws groups; what cannot be is said, not done."""

    def __init__(self, view: View) -> None:
        self.view = view
        self.fields = Fields()
        self.message = ""

    def group(self, place: str, group: Any, without: tuple[str, ...] = ()) -> tuple[bool, Any]:
        """Controls of a group and, folded, of the groups in it.

        Args:
            place: Unique name in the panel.
            group: The settings.
            without: Names of those that are left out.

        Returns:
            Whether something was changed, and the settings to have.
        """
        from imgui_bundle import imgui

        changed, group = self.singles(place, group, without)
        for name, _ in subgroups(type(group)):
            if name not in without and imgui.tree_node(label_of(name)):
                inner_changed, inner = self.group(f"{place}.{name}", getattr(group, name))
                imgui.tree_pop()
                if inner_changed:
                    changed, group = True, group.replace(**{name: inner})
        return changed, group

    def singles(
        self, place: str, group: SettingsGroup, without: tuple[str, ...] = ()
    ) -> tuple[bool, Any]:
        """Controls of the settings that lie directly in a group."""
        from imgui_bundle import imgui

        changed, unit = False, scene_unit(self.view.model.scene)
        for p in parameters(type(group)):
            if p.name in without:
                continue
            if p.unit == "Å":  # of whatever is not measured in it, too
                p = replace(p, unit=unit)
            one, value = self.fields.edit(f"{place}.{p.name}", p, getattr(group, p.name))
            if one:
                try:
                    group, changed = group.replace(**{p.name: value}), True
                    self.message = ""
                except ScuroError as error:
                    self.message = str(error)
            if imgui.is_item_deactivated_after_edit():
                self.view.model.history.end_gesture()
        return changed, group


def heading(title: str, open: bool = False) -> bool:
    """A heading that folds what follows; whether it is unfolded."""
    from imgui_bundle import imgui

    flags = imgui.TreeNodeFlags_.default_open if open else 0
    return bool(imgui.collapsing_header(title, flags))


def buttons(*row: tuple[str, str, Any]) -> None:
    """A row of buttons: text, tooltip, and what to do; ``None`` for one that cannot be pressed."""
    from imgui_bundle import imgui

    for place, (text, tip, act) in enumerate(row):
        if place:
            imgui.same_line()
        imgui.begin_disabled(act is None)
        if imgui.button(text) and act is not None:
            act()
        imgui.end_disabled()
        if tip:
            imgui.set_item_tooltip(tip)


def words(text: str, color: tuple[float, float, float, float] | None = None) -> None:
    """Wrapped text."""
    from imgui_bundle import imgui

    if color is not None:
        imgui.push_style_color(imgui.Col_.text, imgui.ImVec4(*color))
    imgui.push_text_wrap_pos(0.0)
    imgui.text_unformatted(text)
    imgui.pop_text_wrap_pos()
    if color is not None:
        imgui.pop_style_color()
