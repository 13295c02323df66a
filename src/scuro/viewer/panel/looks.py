"""The parts of the panel that say how the scene looks: techniques, lights, representations."""

from __future__ import annotations

from scuro.export.scene_file import Show
from scuro.scene.lights import Light
from scuro.settings import subgroups
from scuro.style.color import CATEGORIES, VALUES
from scuro.style.representation import STYLES
from scuro.viewer.panel.fields import label_of
from scuro.viewer.panel.groups import Groups, buttons, heading

_NEEDS = {
    "volume": "volumes",
    "reservoir": "reservoirs",
    "strategy": "reservoirs",
    "semantic": "bodies",
}
"""Groups of settings that mean nothing to scenes without these."""


class Looks:
    """Representations, light and techniques."""

    def __init__(self, groups: Groups) -> None:
        self._groups = groups
        self.view = groups.view

    def shows(self) -> None:
        """How the molecules are shown."""
        from imgui_bundle import imgui

        model = self.view.model
        shows = model.document.show or (Show(),)  # what nobody chose can be changed, too
        if not model.scene.molecules or not heading("Representations", open=True):
            return
        for index, show in enumerate(shows):
            imgui.push_id(f"show{index}")
            changed, new = False, show
            for key, known in (("style", ("auto", *STYLES)), ("color", (*VALUES, *CATEGORIES))):
                one, word = self._groups.fields.word_or_menu(
                    f"show{index}.{key}", key, getattr(new, key), known
                )
                if one:
                    changed, new = True, new.replace(**{key: word})
            hidden = ("style", "color", "optional")
            one, new = self._groups.group(f"show{index}", new, without=hidden)
            changed |= one
            if changed:
                model.change(f"show{index}", show=(*shows[:index], new, *shows[index + 1 :]))
            if len(shows) > 1 and imgui.small_button("Remove"):
                model.change(show=shows[:index] + shows[index + 1 :])
            imgui.separator()
            imgui.pop_id()
        added = Show(style="licorice", select="organic", optional=True)
        buttons(("Add representation", "", lambda: model.change(show=(*shows, added))))

    def settings(self) -> None:
        """Every group of the picture's settings has its own heading."""
        from imgui_bundle import imgui

        model = self.view.model
        if heading("Picture", open=True):
            changed, new = self._groups.singles("settings", model.settings, without=("size",))
            if changed:
                model.change("settings", settings=new)
        for name, _ in subgroups(type(model.settings)):
            needed = _NEEDS.get(name)
            if needed is not None and not self._has(needed):
                continue
            # the techniques that make this project are not hidden behind a click
            if not heading(label_of(name).capitalize(), open=name in ("lighting", "occlusion")):
                continue
            imgui.push_id(name)
            changed, new = self._groups.group(name, getattr(model.settings, name))
            imgui.pop_id()
            if changed:
                model.change(f"settings {name}", settings=model.settings.replace(**{name: new}))

    def _has(self, needed: str) -> bool:
        scene = self.view.model.scene
        if needed == "bodies":
            return bool(scene.bodies())
        return bool(getattr(scene, needed))

    def lights(self) -> None:
        """Lights of the scene's own, instead of the preset's."""
        from imgui_bundle import imgui

        model = self.view.model
        if not heading("Lights of the scene"):
            return
        lights = model.document.light
        for index, light in enumerate(lights):
            if imgui.tree_node(f"{light.kind} {index + 1}"):
                changed, new = self._groups.group(f"light{index}", light)
                if changed:
                    model.change(
                        f"light{index}", light=(*lights[:index], new, *lights[index + 1 :])
                    )
                if imgui.small_button("Remove"):
                    model.change(light=lights[:index] + lights[index + 1 :])
                imgui.tree_pop()
        buttons(
            (
                "Add light",
                "Lights of your own take the place of the preset's",
                lambda: model.change(light=(*lights, Light())),
            )
        )
