"""The panel: everything that can be set, made from the settings' own definitions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from scuro.errors import ScuroError
from scuro.export.scene_file import Show
from scuro.scene.clip import Clip, Plane
from scuro.scene.lights import Light
from scuro.settings import SettingsGroup, parameters, subgroups
from scuro.style.color import CATEGORIES, VALUES
from scuro.style.representation import STYLES
from scuro.viewer.controls import KEYS
from scuro.viewer.fields import Fields
from scuro.viewer.handles import Handles
from scuro.viewer.labels import Label
from scuro.viewer.overlay import selection_labels
from scuro.viewer.pick import sentence
from scuro.viewer.probing import Probing
from scuro.viewer.sequence import SequenceStrip
from scuro.viewer.transfer_editor import TransferEditor
from scuro.viewer.view import View

WIDTH = 330.0
"""Logical pixels of the panel; its labels stand to the right of the controls."""
_LABELS = 130.0


class Panel:
    """What one person sees beside the picture.

    Args:
        view: The view it sets.
        handles: Of its clipping planes.
        probing: Its hand on the probe.
        deliver: Where pictures and scene files go; see :class:`scuro.viewer.screen.Screen`.
        listing: Files to offer for opening.
    """

    def __init__(
        self,
        view: View,
        handles: Handles,
        probing: Probing,
        deliver: Callable[[str, Callable[[Path], None]], str],
        listing: Callable[[], list[str]],
    ) -> None:
        self.view = view
        self.handles = handles
        self._probing = probing
        self._deliver = deliver
        self._listing = listing
        self._listed: list[str] | None = None
        self._fields = Fields()
        self._transfer = TransferEditor(view)
        self._sequence = SequenceStrip(view)
        self.open = True
        self.names = False
        """Whether selected atoms carry their names."""
        self.message = ""

    @property
    def wait(self) -> float | None:
        """Seconds until the panel changes something by itself."""
        return self._probing.wait

    def tick(self) -> None:
        """Do what time brings."""
        self._probing.tick()

    def key(self, key: str) -> bool:
        """Take a key, if it is the panel's."""
        if key == "Tab":
            self.open = not self.open
            return True
        return self._probing.key(key)

    def labels(self) -> list[Label]:
        """Names to show in the picture."""
        return selection_labels(self.view) if self.names else []

    def draw(self, size: tuple[float, float]) -> None:
        """Draw the panel at the right of a screen of this logical size."""
        from imgui_bundle import imgui

        height = size[1] if self.open else 0.0
        imgui.set_next_window_pos((size[0] - WIDTH, 0))
        imgui.set_next_window_size((WIDTH, height))
        imgui.set_next_window_bg_alpha(0.92)
        flags = imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
        imgui.set_next_window_collapsed(not self.open)
        self.open, _ = imgui.begin("scuro", None, flags)
        if self.open:
            imgui.push_item_width(WIDTH - _LABELS - 30)
            self._top()
            self._files()
            self._shows()
            self._transfer.draw(WIDTH - 40)
            self._settings()
            self._lights()
            self._clip()
            self._probing.panel(self._group, self._save)
            self._selection()
            self._sequence.draw()
            self._help()
            imgui.pop_item_width()
        imgui.end()

    # --- parts -------------------------------------------------------------------------------

    def _top(self) -> None:
        from imgui_bundle import imgui

        model, view = self.view.model, self.view
        imgui.begin_disabled(not model.history.can_undo)
        if imgui.button("Undo"):
            model.undo()
        imgui.end_disabled()
        imgui.same_line()
        imgui.begin_disabled(not model.history.can_redo)
        if imgui.button("Redo"):
            model.redo()
        imgui.end_disabled()
        imgui.same_line()
        if imgui.button("Fit"):
            view.fit()
        imgui.same_line()
        if imgui.button("Spin"):
            view.toggle_spin()
        imgui.same_line()
        if imgui.button("Picture"):
            self._save_picture()
        imgui.set_item_tooltip("Save the full picture as PNG: the same as 'scuro render' makes")
        imgui.same_line()
        if imgui.button("Scene"):
            self._save("scene.toml", lambda path: model.save(path, view.document()))
        imgui.set_item_tooltip("Save a scene file, which scuro opens and renders")
        done = "refined" if view.share >= 1 else f"refining {view.share:.0%}"
        text = f"{done} · {1000 * view.drawing.seconds:.0f} ms"
        imgui.progress_bar(min(view.share, 1.0), (-1, 0), text)
        for words in (view.error, model.message, self.message):
            if words:
                imgui.push_text_wrap_pos(0.0)
                imgui.text_colored((1.0, 0.6, 0.4, 1.0), words)
                imgui.pop_text_wrap_pos()

    def _save_picture(self) -> None:
        view = self.view

        def write(path: Path) -> None:
            document = view.document()
            image = view.renderer.render(
                view.model.dressed(view.camera), view.camera, view.full_settings
            )
            image.save(path, settings=document.as_dict())

        self._save("scuro.png", write)
        view.refresh()  # the picture was drawn into this view's textures

    def _save(self, name: str, write: Callable[[Path], None]) -> None:
        try:
            self.message = self._deliver(name, write)
        except ScuroError as error:
            self.message = str(error)

    def _files(self) -> None:
        from imgui_bundle import imgui

        if not imgui.collapsing_header("Open"):
            self._listed = None
            return
        given, path = self._fields.text("open", "file", "")
        imgui.set_item_tooltip("A file, PDB ID or scene file; press Enter")
        if given and path:
            self.view.model.open_path(path)
            self.view.fit()
        if self._listed is None:
            self._listed = self._listing()
        for listed in self._listed:
            if imgui.selectable(listed, False)[0]:
                self.view.model.open_path(listed)
                self.view.fit()

    def _shows(self) -> None:
        from imgui_bundle import imgui

        model = self.view.model
        shows = model.document.show
        if not model.scene.molecules or not imgui.collapsing_header("Show", _unfolded()):
            return
        for index, show in enumerate(shows):
            imgui.push_id(f"show{index}")
            changed, new = self._group(f"show{index}", show)
            word = _choice("styles", ("auto", *STYLES)), _choice("schemes", (*VALUES, *CATEGORIES))
            for key, chosen in zip(("style", "color"), word, strict=True):
                if chosen is not None:
                    changed, new = True, new.replace(**{key: chosen})
            if changed:
                model.change(f"show{index}", show=(*shows[:index], new, *shows[index + 1 :]))
            imgui.new_line()
            if len(shows) > 1 and imgui.small_button("Remove"):
                model.change(show=shows[:index] + shows[index + 1 :])
            imgui.separator()
            imgui.pop_id()
        if imgui.small_button("Add representation"):
            model.change(show=(*shows, Show(style="licorice", select="organic")))

    def _settings(self) -> None:
        """Every group of the picture's settings has its own heading."""
        from imgui_bundle import imgui

        model = self.view.model
        if imgui.collapsing_header("Picture"):
            changed, new = self._singles("settings", model.settings, without=("size",))
            if changed:
                model.change("settings", settings=new)
        for name, _ in subgroups(type(model.settings)):
            if not imgui.collapsing_header(name.replace("_", " ").capitalize()):
                continue
            imgui.push_id(name)
            changed, new = self._group(name, getattr(model.settings, name))
            imgui.pop_id()
            if changed:
                model.change(f"settings {name}", settings=model.settings.replace(**{name: new}))

    def _group(self, place: str, group: Any) -> tuple[bool, Any]:
        """Controls of a group and, folded, of the groups in it."""
        from imgui_bundle import imgui

        changed, group = self._singles(place, group)
        for name, _ in subgroups(type(group)):
            if imgui.tree_node(name.replace("_", " ")):
                inner_changed, inner = self._group(f"{place}.{name}", getattr(group, name))
                imgui.tree_pop()
                if inner_changed:
                    changed, group = True, group.replace(**{name: inner})
        return changed, group

    def _singles(
        self, place: str, group: SettingsGroup, without: tuple[str, ...] = ()
    ) -> tuple[bool, Any]:
        from imgui_bundle import imgui

        changed = False
        for p in parameters(type(group)):
            if p.name in without:
                continue
            one, value = self._fields.edit(f"{place}.{p.name}", p, getattr(group, p.name))
            if one:
                try:
                    group, changed = group.replace(**{p.name: value}), True
                except ScuroError as error:
                    self.message = str(error)
            if imgui.is_item_deactivated_after_edit():
                self.view.model.history.end_gesture()
        return changed, group

    def _lights(self) -> None:
        from imgui_bundle import imgui

        model = self.view.model
        if not imgui.collapsing_header("Lights of the scene"):
            return
        lights = model.document.light
        for index, light in enumerate(lights):
            if imgui.tree_node(f"{light.kind} {index + 1}"):
                changed, new = self._group(f"light{index}", light)
                if changed:
                    model.change(
                        f"light{index}", light=(*lights[:index], new, *lights[index + 1 :])
                    )
                if imgui.small_button("Remove"):
                    model.change(light=lights[:index] + lights[index + 1 :])
                imgui.tree_pop()
        if imgui.small_button("Add light"):
            model.change(light=(*lights, Light()))

    def _clip(self) -> None:
        from imgui_bundle import imgui

        if not imgui.collapsing_header("Clipping"):
            return
        handles, model = self.handles, self.view.model
        _, handles.shown = imgui.checkbox("handles", handles.shown)
        for text, act in (("Plane", handles.add_plane), ("Box", handles.add_box)):
            imgui.same_line()
            if imgui.small_button(text):
                act()
        for index, plane in enumerate(handles.planes):
            imgui.push_id(f"plane{index}")
            moved, point = imgui.drag_float3("point", list(plane.point), 0.1)
            turned, normal = imgui.drag_float3("normal", list(plane.normal), 0.01)
            if (moved or turned) and any(normal):
                planes = list(handles.planes)
                planes[index] = Plane((*point,), (*normal,))  # type: ignore[arg-type]
                model.change(f"plane{index}", clip=Clip(tuple(planes)))
            for text, act in (("Flip", handles.flip), ("Remove", handles.remove)):
                if imgui.small_button(text):
                    handles.chosen = index
                    act()
                imgui.same_line()
            imgui.new_line()
            imgui.pop_id()

    def _selection(self) -> None:
        from imgui_bundle import imgui

        if not imgui.collapsing_header("Selection", _unfolded()):
            return
        _, self.names = imgui.checkbox("names in the picture", self.names)
        for found in self.view.selection:
            imgui.bullet_text(sentence(found).replace("%", "%%"))
        if not self.view.selection:
            imgui.text_disabled("click an atom; Shift+click adds")

    def _help(self) -> None:
        from imgui_bundle import imgui

        if not imgui.collapsing_header("Keys"):
            return
        for keys, what in {**KEYS, "Tab": "fold the panel"}.items():
            imgui.text_disabled(keys)
            imgui.push_text_wrap_pos(0.0)
            imgui.text(what)
            imgui.pop_text_wrap_pos()


def _choice(title: str, words: tuple[str, ...]) -> str | None:
    """A menu of known words, for settings that also take others; the one chosen now."""
    from imgui_bundle import imgui

    chosen = None
    if imgui.small_button(title):
        imgui.open_popup(title)
    imgui.same_line()
    if imgui.begin_popup(title):
        for word in words:
            if imgui.selectable(word, False)[0]:
                chosen = word
        imgui.end_popup()
    return chosen


def _unfolded() -> int:
    """Flags of headings that are open at first."""
    from imgui_bundle import imgui

    return int(imgui.TreeNodeFlags_.default_open)
