"""The parts of the panel for cutting and asking: clipping, selection, keys."""

from __future__ import annotations

from scuro.scene.clip import Plane
from scuro.style.gauges import scene_unit
from scuro.viewer import navigate
from scuro.viewer.controls import KEYS, PROFILES
from scuro.viewer.handles import Handles
from scuro.viewer.measure import measures
from scuro.viewer.panel.groups import Groups, buttons, heading, words
from scuro.viewer.pick import sentence


class Tools:
    """Clipping by numbers, what is selected, what the keys do."""

    def __init__(self, groups: Groups, handles: Handles) -> None:
        self._groups = groups
        self.view = groups.view
        self._handles = handles
        self.names = False
        """Whether selected atoms carry their names."""

    def clipping(self) -> None:
        """Planes and the navigation cube."""
        from imgui_bundle import imgui

        if not heading("Clipping", open=True):
            return
        handles, model = self._handles, self.view.model
        has_cube = model.document.clipping.cube is not None
        has_atoms = bool(model.scene.molecules)
        cube = (
            "Navigation cube",
            "The rest shows as a backbone (key n)",
            None if has_cube else lambda: handles.toggle_cube("backbone"),
        )
        buttons(
            ("Plane", "A plane through the middle (key c)", handles.add_plane),
            (
                "Box",
                "Show only what is in a box (key b)",
                None if has_cube else lambda: handles.toggle_cube("none"),
            ),
            *((cube,) if has_atoms else ()),
        )
        _, handles.shown = imgui.checkbox("handles in the picture", handles.shown)
        for index, plane in enumerate(handles.planes):
            self._plane(index, plane)
        hidden: tuple[str, ...] = () if has_cube else ("cube", "cube_center", "cube_turn")
        if not (has_cube and has_atoms):
            hidden += ("cube_rest",)
        if not has_atoms:
            hidden += ("spare",)
        if len(model.scene.items) == len(model.scene.volumes) + len(model.scene.reservoirs):
            hidden += ("whole_atoms",)
        changed, clipping = self._groups.group("clipping", model.document.clipping, hidden)
        if changed:
            model.change("clipping", clipping=clipping)

    def _plane(self, index: int, plane: Plane) -> None:
        from imgui_bundle import imgui

        handles, model = self._handles, self.view.model
        unit = scene_unit(model.scene)
        imgui.push_id(f"plane{index}")
        chosen = handles.chosen == index
        if imgui.selectable(f"plane {index + 1}", chosen)[0]:
            handles.chosen = None if chosen else index
        # a pixel of the hand's way is one of the picture, whatever the scene's size
        speed = navigate.pixel_size(self.view.camera, self.view.size) * self.view.ratio
        label = f"point ({unit})" if unit else "point"
        moved, point = imgui.drag_float3(label, list(plane.point), speed, format="%.2f")
        done = imgui.is_item_deactivated_after_edit()
        turned, normal = imgui.drag_float3("normal", list(plane.normal), 0.01)
        if done or imgui.is_item_deactivated_after_edit():
            model.history.end_gesture()
        if (moved or turned) and any(normal):
            x, y, z = point
            u, v, w = normal
            handles.set(index, Plane((x, y, z), (u, v, w)), f"plane{index}")

        def act_on(act: str) -> None:
            handles.chosen = index
            getattr(handles, act)()

        buttons(
            ("Flip", "Keep the other side (key v)", lambda: act_on("flip")),
            ("Remove", "Key Delete", lambda: act_on("remove")),
        )
        imgui.pop_id()

    def planes(self) -> None:
        """Slice planes of a volume."""
        model = self.view.model
        if not model.scene.volumes or not heading("Slice planes", open=True):
            return
        changed, planes = self._groups.group("planes", model.settings.volume.planes)
        if changed:
            model.change("planes", settings=model.settings.replace(volume__planes=planes))

    def selection(self) -> None:
        """What is selected."""
        from imgui_bundle import imgui

        scene = self.view.model.scene
        if scene.volumes and len(scene.volumes) == len(scene.items):
            return  # clouds have nothing that a click could take
        if not heading("Selection", open=True):
            return
        _, self.names = imgui.checkbox("names in the picture", self.names)
        for found in self.view.selection:
            imgui.bullet()
            words(sentence(found))
        if not self.view.selection:
            thing = "a cell" if scene.reservoirs else "an atom"
            imgui.text_disabled(f"click {thing}; Shift+click adds")
            return
        for said in measures(
            [p.anchor for p in self.view.selection], scene_unit(self.view.model.scene)
        ):
            words(f"{said.kind}: {said.text}")
        buttons(("Clear", "Key Escape", lambda: self.view.select(None)))

    def keys(self) -> None:
        """What mouse and keys do."""
        from imgui_bundle import imgui

        view = self.view
        if heading("Mouse"):
            names = list(PROFILES)
            changed, index = imgui.combo("profile", names.index(view.profile), names)
            if changed:
                view.profile = names[index]
            for line in PROFILES[view.profile].help:
                words(line)
        if not heading("Keys"):
            return
        for keys, what in {**KEYS, "Tab": "fold the panel"}.items():
            imgui.text_disabled(keys)
            imgui.indent()
            words(what)
            imgui.unindent()
