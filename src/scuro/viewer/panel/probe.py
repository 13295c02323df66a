"""The probe's part of the panel."""

from __future__ import annotations

import numpy as np

from scuro.probe.probe import MOST_PLACES
from scuro.viewer.panel.groups import Groups, buttons, heading
from scuro.viewer.probing import Probing
from scuro.viewer.saving import Saving


class ProbePart:
    """Its settings, where it is, what it feels, and its path."""

    def __init__(self, groups: Groups, probing: Probing, saving: Saving) -> None:
        self._groups = groups
        self._probing = probing
        self._saving = saving

    def draw(self) -> None:
        """Draw it."""
        from imgui_bundle import imgui

        probing = self._probing
        if not probing.view.model.scene.molecules or not heading("Probe", open=True):
            return
        changed, _ = imgui.checkbox("probe in the scene", probing.probe is not None)
        imgui.set_item_tooltip("A sphere that cannot enter the atoms (key p)")
        if changed:
            probing.toggle()
        changed, settings = self._groups.group("probe", probing.settings)
        if changed:
            probing.change(settings)
        probe = probing.probe
        if probe is None:
            return
        x, y, z = probe.position
        imgui.text(f"at {x:.2f}, {y:.2f}, {z:.2f} Å")
        imgui.text(f"force {float(np.linalg.norm(probe.force)):.3g} pN")
        _, probe.recording = imgui.checkbox("record its path", probe.recording)
        imgui.set_item_tooltip(f"Ends at {MOST_PLACES:,} places")
        imgui.same_line()
        imgui.text_disabled(f"{len(probe.path)} places")
        some = bool(probe.path)
        buttons(
            (
                "Stop" if probing.replaying else "Replay",
                "Go along the path again",
                probing.replay if probing.path else None,
            ),
            (
                "Save path",
                "To render it: name it besides the structure, or open both from a scene file",
                (lambda: self._saving.deliver("probe-path.json", probe.save_path))
                if some
                else None,
            ),
            ("Forget", "", probe.path.clear if some else None),
        )
