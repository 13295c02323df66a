"""The panel: what one person sees beside the picture, under a few tabs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scuro.style.labels import Label
from scuro.viewer.handles import Handles
from scuro.viewer.jobs import Jobs
from scuro.viewer.overlay import selection_labels
from scuro.viewer.panel.files import Files
from scuro.viewer.panel.groups import Groups, buttons, words
from scuro.viewer.panel.looks import Looks
from scuro.viewer.panel.probe import ProbePart
from scuro.viewer.panel.sequence import SequenceStrip
from scuro.viewer.panel.tools import Tools
from scuro.viewer.panel.transfer_editor import TransferEditor
from scuro.viewer.probing import Probing
from scuro.viewer.saving import Deliver, Saving
from scuro.viewer.view import View

WIDTH = 330.0
"""Logical pixels of the panel; its labels stand to the right of the controls."""
_LABELS = 118.0
_WARNING = (1.0, 0.66, 0.42, 1.0)


class Panel:
    """What one person sees beside the picture.

    Args:
        view: The view it sets.
        handles: Of its clipping planes.
        probing: Its hand on the probe.
        jobs: Long works, which are shown and can be stopped.
        deliver: Where pictures and scene files go; see :class:`scuro.viewer.screen.Screen`.
        listing: Files to offer for opening.
        elsewhere: Whether files leave this machine: their paths are then absolute.
        told: Makes of an error's sentence what may be told.
    """

    def __init__(
        self,
        view: View,
        handles: Handles,
        probing: Probing,
        jobs: Jobs,
        deliver: Deliver,
        listing: Callable[[], list[str]],
        elsewhere: bool = False,
        told: Callable[[str], str] = str,
    ) -> None:
        self.view = view
        self._told = told
        self._probing = probing
        self.jobs = jobs
        self.saving = Saving(view, self.jobs, deliver, elsewhere)
        self._groups = Groups(view)
        self._files = Files(self._groups, self.saving, listing)
        self._looks = Looks(self._groups)
        self._tools = Tools(self._groups, handles)
        self._transfer = TransferEditor(view)
        self._sequence = SequenceStrip(view)
        self._probe = ProbePart(self._groups, probing, self.saving)
        self._tabs: dict[str, tuple[Callable[[], None], ...]] = {
            "Scene": (
                self._files.open, self._looks.shows, self._transfer.draw, self._sequence.draw,
                self._tools.selection,
            ),
            "Look": (self._looks.settings, self._looks.lights),
            "Tools": (self._tools.clipping, self._tools.planes, self._probe.draw, self._tools.keys),
            "Save": (self._files.save,),
        }  # fmt: skip
        self.open = True

    def key(self, key: str) -> bool:
        """Take a key, if it is the panel's."""
        if key == "Tab":
            self.open = not self.open
            return True
        return self._probing.key(key)

    def labels(self) -> list[Label]:
        """Names to show in the picture."""
        return selection_labels(self.view) if self._tools.names else []

    def draw(self, size: tuple[float, float]) -> None:
        """Draw the panel at the right of a screen of this logical size."""
        from imgui_bundle import imgui

        flags = imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
        flags |= imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_saved_settings
        if not self.open:
            imgui.set_next_window_pos((size[0] - 44, 8))
            imgui.begin("folded", None, flags | imgui.WindowFlags_.always_auto_resize)
            if imgui.arrow_button("unfold", imgui.Dir.left):
                self.open = True
            imgui.set_item_tooltip("Show the panel (Tab)")
            imgui.end()
            return
        imgui.set_next_window_pos((size[0] - WIDTH, 0))
        imgui.set_next_window_size((WIDTH, size[1]))
        imgui.begin("scuro", None, flags)
        imgui.push_item_width(WIDTH - _LABELS - 32)
        self._top()
        if imgui.begin_tab_bar("tabs"):
            for name, parts in self._tabs.items():
                if imgui.begin_tab_item(name)[0]:
                    imgui.begin_child("body")
                    imgui.push_item_width(WIDTH - _LABELS - 32)
                    for part in parts:
                        part()
                    imgui.pop_item_width()
                    imgui.end_child()
                    imgui.end_tab_item()
            imgui.end_tab_bar()
        imgui.pop_item_width()
        imgui.end()

    def _top(self) -> None:
        from imgui_bundle import imgui

        model, view = self.view.model, self.view
        buttons(
            ("Undo", "Ctrl+Z", model.undo if model.history.can_undo else None),
            ("Redo", "Ctrl+Y", model.redo if model.history.can_redo else None),
            ("Fit", "See all of it (key f)", view.fit),
            ("Spin", "Turn by itself (key i)", view.toggle_spin),
            ("Fold", "Hide the panel (Tab)", self._fold),
        )
        working = not view.complete
        width = WIDTH - 20 - (58 if working else 0)
        share = view.built if view.built is not None else min(view.share, 1.0)
        text = f"{view.status} · {1000 * view.drawing.seconds:.0f} ms"
        imgui.progress_bar(share if working else 0.0, (width, 0), text)
        imgui.set_item_tooltip("How far the picture is, and how long the last one took")
        if working:
            imgui.same_line()
            if imgui.button("Stop##view", (51, 0)):
                view.stop()
        for job in list(self.jobs.waiting):
            imgui.progress_bar(job.share, (WIDTH - 88, 0), f"{job.title} {job.share:.0%}")
            imgui.same_line()
            if imgui.button(f"Cancel##{id(job)}"):
                self.jobs.cancel(job)
        for said in (view.error, view.remark):
            if said:
                words(self._told(said), _WARNING)
        sources: tuple[Any, ...] = (model, self._groups, self.jobs)
        for number, source in enumerate(sources):
            if not source.message:
                continue
            if imgui.small_button(f"×##{number}"):
                source.message = ""
                continue
            imgui.set_item_tooltip("Read")
            imgui.same_line()
            failed = source is not self.jobs or self.jobs.failed
            words(self._told(source.message), _WARNING if failed else None)

    def _fold(self) -> None:
        self.open = False
