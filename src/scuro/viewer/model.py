"""The scene that all views show, and every change to it."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from scuro.errors import ScuroError
from scuro.export.scene_file import (
    Input,
    SceneFile,
    Show,
    is_scene_file,
    read_scene_file,
    write_scene_file,
)
from scuro.passes.compose.lighting import PRESETS
from scuro.probe.probe import Probe
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip
from scuro.scene.scene import Scene
from scuro.settings import parameters
from scuro.style.options import Representation
from scuro.viewer.history import History, State


class Model:
    """One scene for all who look at it.

    Args:
        document: What to show and how.
        scene: The scene already read from the document, if it was.
        guard: Raises :class:`ScuroError` for a document that must not be shown; a server keeps
            to its files with it.

    Raises:
        LoadError: An input cannot be read.
    """

    def __init__(
        self,
        document: SceneFile,
        scene: Scene | None = None,
        guard: Callable[[SceneFile], None] = lambda document: None,
    ) -> None:
        self._guard = guard
        self.scene = scene or document.scene()
        if not document.show and self.scene.molecules:
            document = replace(document, show=_shows(self.scene) or (Show(),))
        self.history = History(State(document, self.scene.clip))
        self._input = document.input, document.load
        self._lighting = self.scene.lighting
        self.probe: Probe | None = None
        """The probe that all views share."""
        self._watchers: weakref.WeakSet[Any] = weakref.WeakSet()
        self.message = ""
        """The last error's sentence, for people."""

    @property
    def document(self) -> SceneFile:
        return self.history.present.document

    @property
    def settings(self) -> Settings:
        return self.document.settings

    @property
    def clip(self) -> Clip:
        return self.history.present.clip

    def watch(self, watcher: Any) -> None:
        """Call ``watcher.scene_changed()`` after each change, as long as it lives."""
        self._watchers.add(watcher)

    def change(self, gesture: str | None = None, **changes: Any) -> bool:
        """Replace fields of the state (``clip``) or of its document (``settings``, ``show``, …).

        Returns:
            Whether it could be done; if not, all is as before and :attr:`message` says why.
        """
        state = self.history.present
        if "clip" in changes:
            state = replace(state, clip=changes.pop("clip"))
        state = replace(state, document=replace(state.document, **changes))
        return self._apply(state, lambda: self.history.change(state, gesture))

    def undo(self) -> None:
        """Take the last change back."""
        self._step(self.history.undo, self.history.redo)

    def redo(self) -> None:
        """Make the change again that was taken back."""
        self._step(self.history.redo, self.history.undo)

    def _step(self, step: Callable[[], bool], back: Callable[[], bool]) -> None:
        if step() and not self._apply(self.history.present, lambda: None):
            back()

    def open(self, document: SceneFile) -> bool:
        """Show another document; undo returns to this one."""
        state = State(document)
        return self._apply(state, lambda: self.history.change(state))

    def open_path(self, path: str) -> bool:
        """Show another file, or a scene file; :attr:`message` says why if that cannot be."""
        document = replace(self.document, input=(Input(path=path),), show=())
        try:
            self._guard(document)
            if is_scene_file(path):
                document = read_scene_file(path)
        except ScuroError as error:
            self.message = str(error)
            return False
        return self.open(document)

    def _apply(self, state: State, commit: Callable[[], None]) -> bool:
        """Bring the scene in line with a state; on an error leave it as it was."""
        before = self.scene
        document = state.document
        try:
            self._guard(document)
            if (document.input, document.load) != self._input:
                self.scene = document.scene()
            else:
                document.show_in(self.scene)
            self._lighting = self.scene.lighting
            self.scene.bodies()  # a style or colour may turn out to be wrong only now
        except ScuroError as error:
            self.scene = before
            self.document.show_in(self.scene)
            self.message = str(error)
            return False
        if self.scene is not before:
            self.probe = None  # it was among other atoms
        self._input = document.input, document.load
        self.message = ""
        commit()
        self._tell()
        return True

    def _tell(self) -> None:
        for watcher in list(self._watchers):
            watcher.scene_changed()

    def set_probe(self, probe: Probe | None) -> None:
        """Put a probe into the scene, or take it away."""
        self.probe = probe
        self.message = ""
        self._tell()

    def probe_moved(self) -> None:
        """The probe is elsewhere: views draw anew."""
        self._tell()

    def dressed(self, camera: Camera) -> Scene:
        """The scene as a view draws it: with its clipping, and the probe's light and plane."""
        scene, probe = self.scene, self.probe
        scene.lighting, scene.clip = self._lighting, self.clip
        if probe is not None:
            scene.lighting = probe.lit(self._lighting or PRESETS[self.settings.lighting.preset])
            scene.clip = probe.clipped(self.clip, camera)
        return scene

    def save(self, path: str | Path, document: SceneFile | None = None) -> None:
        """Write a scene file.

        Raises:
            SaveError: It cannot be written.
        """
        write_scene_file(path, document or self.document)


def _shows(scene: Scene) -> tuple[Show, ...]:
    """How a scene made in a program shows its first molecule, as the document has it."""
    sizes = {p.name for p in parameters(Representation)}
    return tuple(
        Show(
            style=shown.style,
            color=shown.color,
            select=shown.select,
            opacity=shown.material.opacity,
            sizes=Representation(**{k: v for k, v in shown.options if k in sizes}),
        )
        for shown in scene.molecules[0].shown
    )
