"""The parts of the panel that open and save."""

from __future__ import annotations

import os.path
from collections.abc import Callable, Sequence

from scuro.errors import ScuroError
from scuro.viewer.panel.groups import Groups, buttons, heading
from scuro.viewer.player import play_options
from scuro.viewer.saving import Saving


class Files:
    """Opening scenes; saving pictures, films and scene files."""

    def __init__(self, groups: Groups, saving: Saving, listing: Callable[[], list[str]]) -> None:
        self._groups = groups
        self.view = groups.view
        self._saving = saving
        self._listing = listing
        self._beside = False
        """Whether what is opened comes to what is shown."""
        self._listed: dict[str, str] | None = None
        """Paths by the names they are shown with."""

    def open(self) -> None:
        """Another file or scene, in place of what is shown or beside it."""
        from imgui_bundle import imgui

        if not heading("Open"):
            self._listed = None
            return
        given, path = self._groups.fields.text("open", "file", "")
        imgui.set_item_tooltip("A file, PDB ID or scene file; press Enter")
        _, self._beside = imgui.checkbox("beside what is shown", self._beside)
        imgui.set_item_tooltip("As 'scuro render A B' shows both; else it takes their place")
        self._shown()
        if self._listed is None:
            self._listed = short_names(self._listing())
        if given and path:
            self._open(self._listed.get(path, path))
        for name, listed in self._listed.items():
            if imgui.selectable(name, False)[0]:
                self._open(listed)

    def _shown(self) -> None:
        """The files that are shown beside each other, to be taken away."""
        from imgui_bundle import imgui

        model = self.view.model
        lines = model.document.input
        for index, line in enumerate(lines if len(lines) > 1 else ()):
            if imgui.small_button(f"×##input{index}"):
                model.change(input=lines[:index] + lines[index + 1 :])
            imgui.set_item_tooltip("Take it away")
            imgui.same_line()
            imgui.text_unformatted(os.path.basename(line.path))

    def _open(self, path: str) -> None:
        view = self.view
        if self._beside:
            view.model.open_path(path, beside=True)
            return
        # what takes long to read is shown, and stood before, when it is there
        if view.model.open_path(path) and view.model.restyle is None:
            view.camera = view.initial_camera()
            view.stir()

    def save(self) -> None:
        """Pictures, films, scene files."""
        from imgui_bundle import imgui

        saving = self._saving
        imgui.separator_text("Picture")
        imgui.push_id("picture")
        changed, new = self._groups.singles("picture", saving.picture_settings)
        if changed:
            saving.picture_settings = new
        tip = "The same pixels as 'scuro render' makes of the scene file"
        buttons(("Save picture", tip, lambda: self._try(saving.picture)))
        imgui.pop_id()
        imgui.separator_text("Film")
        imgui.push_id("film")
        changed, chosen = self._groups.singles("film", saving.film_settings)
        if changed:
            saving.film_settings = chosen
        # not those that name files: a page must not have any file of this machine read
        changed, movie = self._groups.singles("movie", saving.movie, without=("keys", "to_look"))
        if changed:
            saving.movie = movie
        play = play_options(self.view.model.player)
        if play and not saving.movie.play and imgui.small_button("as it is played"):
            saving.movie = saving.movie.replace(**play, motion="none", length=None)
        buttons(
            (
                "Save film",
                "As 'scuro movie' makes it; the browser gets numbered frames as a ZIP file",
                lambda: self._try(saving.film),
            )
        )
        imgui.pop_id()
        imgui.separator_text("Scene")
        tip = "All of it, for 'scuro view', 'render' and 'movie'"
        buttons(("Save scene file", tip, saving.scene))

    def _try(self, act: Callable[[], None]) -> None:
        try:
            act()
        except ScuroError as error:
            self._groups.message = str(error)


def short_names(paths: Sequence[str]) -> dict[str, str]:
    """Paths by what is left of them without the folder that all are in."""
    if not paths:
        return {}
    folder = os.path.commonpath([os.path.dirname(path) for path in paths])
    return {os.path.relpath(path, folder): path for path in paths}
