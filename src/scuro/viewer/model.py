"""The scene that all views show, and every change to it."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from scuro.errors import MissingExtraError, ScuroError, SettingsError
from scuro.export.scene_file import (
    Input,
    SceneFile,
    Show,
    is_scene_file,
    read_scene_file,
    write_scene_file,
)
from scuro.passes.compose.lighting import PRESETS
from scuro.probe.probe import Probe, ProbeSettings
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip
from scuro.scene.scene import Scene
from scuro.viewer.describing import cut_of, cuts_of, shows_of
from scuro.viewer.history import History, State
from scuro.viewer.player import Player
from scuro.viewer.restyle import Reading, Restyle

_LOOK = 0.1
"""Seconds between looks whether something is built."""


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
        if scene is not None and not document.clip:
            document = replace(document, clip=cuts_of(scene))
        if not document.show and self.scene.molecules:
            document = replace(document, show=shows_of(self.scene) or (Show(),))
        self.middle = self.scene.bounds().mean(axis=0)
        """(3,) the scene's middle when it was read, from which cuts without a point count."""
        self.history = History(State(document))
        self.player = Player(self)
        self._lighting = self.scene.lighting
        self.probe: Probe | None = None
        """The probe that all views share."""
        self.restyle: Restyle | Reading | None = None
        """What is built beside the pages, to be shown when it is there."""
        self._read: Reading | None = None
        self._start: Any = None
        self._eye: Any = None
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
        """All clipping planes, those of the navigation cube last."""
        return self.document.clipped(self.middle)

    def watch(self, watcher: Any) -> None:
        """Call ``watcher.scene_changed()`` after each change, as long as it lives."""
        self._watchers.add(watcher)

    def change(self, gesture: str | None = None, **changes: Any) -> bool:
        """Replace fields of the document (``settings``, ``show``, ``clip`` …), or the ``probe``.

        Returns:
            Whether it could be done; if not, all is as before and :attr:`message` says why. What
            takes long to build is shown later: :attr:`restyle` is there until then.
        """
        state = self.history.present
        given = dict(changes)
        if "probe" in changes:
            state = replace(state, probe=changes.pop("probe"))
        state = replace(state, document=replace(state.document, **changes))
        if self._built_beside(state, lambda: self.change(gesture, **given)):
            return True
        return self._apply(state, lambda: self.history.change(state, gesture))

    def undo(self) -> None:
        """Take the last change back."""
        self._step(self.history.undo, self.history.redo)

    def redo(self) -> None:
        """Make the change again that was taken back."""
        self._step(self.history.redo, self.history.undo)

    def _step(self, step: Callable[[], bool], back: Callable[[], bool]) -> None:
        if self.restyle is not None:
            self.restyle = None  # that is what is taken back
            self.tell()
            return
        before = self.history.present
        if not step():
            return
        state = self.history.present
        beside = self._built_beside(state, lambda: self._step(step, back), before)
        if beside or not self._apply(state, lambda: None, before):
            back()

    def _built_beside(
        self, state: State, then: Callable[[], object], before: State | None = None
    ) -> bool:
        """Begin to build what a state shows beside the pages, if that takes long.

        Args:
            state: What shall be shown.
            then: Shows it.
            before: What is shown, if that is not the history's present.
        """
        new, old = state.document, (before or self.history.present).document
        try:
            self._guard(new)
        except ScuroError:
            return False  # nothing is read before; _apply meets the same error, and tells it
        if new.input != old.input:
            if self._read is not None and self._read.document == new:
                return False
            reading = Reading(new, then)
            self.restyle = reading if reading.needed else None
            return reading.needed
        if new.load != old.load or not self.scene.molecules:
            return False
        if (new.show, new.clipping) == (old.show, old.clipping):
            return False
        try:
            restyle = Restyle(self.scene, new, then)
        except ScuroError:
            return False  # _apply meets the same error, and tells it
        self.restyle = restyle if restyle.needed else None
        return restyle.needed

    def tick(self) -> None:
        """Show what was built meanwhile."""
        restyle = self.restyle
        if restyle is None:
            return
        try:
            if restyle.tick():
                self.restyle = None
                self._read = restyle if isinstance(restyle, Reading) else None
                restyle.then()
        except ScuroError as error:
            self.restyle, self.message = None, str(error)
            self.tell()

    @property
    def wait(self) -> float | None:
        """Seconds until :meth:`tick` should be called again; ``None`` if nothing is built."""
        return None if self.restyle is None else _LOOK

    def open(self, document: SceneFile) -> bool:
        """Show another document; undo returns to this one."""
        self.restyle = None
        state = State(document)
        if self._built_beside(state, lambda: self.open(document)):
            return True
        return self._apply(state, lambda: self.history.change(state))

    def open_path(self, path: str, beside: bool = False) -> bool:
        """Show another file, or a scene file; :attr:`message` says why if that cannot be.

        Args:
            path: What to read.
            beside: Whether it comes to what is shown, as ``scuro render A B`` shows both.
        """
        shown, new = self.document, (Input(path=path),)
        # what was set of the other file's atoms, frames and places means nothing in this one
        document = SceneFile(input=new, light=shown.light, settings=shown.settings)
        if beside:
            document = replace(shown, input=shown.input + new)
        try:
            self._guard(document)
            if is_scene_file(path):
                if beside:
                    raise SettingsError(f"{path} is a scene of its own: open it by itself")
                document = read_scene_file(path)
        except ScuroError as error:
            self.message = str(error)
            return False
        return self.change(input=document.input) if beside else self.open(document)

    def _apply(self, state: State, commit: Callable[[], None], before: State | None = None) -> bool:
        """Bring the scene in line with a state; on an error leave it as it was."""
        before = before or self.history.present
        scene, player, probe = self.scene, self.player, self.probe
        try:
            self._guard(state.document)
            self._show(state, before)
            self.scene.bodies()  # a style or colour may turn out to be wrong only now
            state.document.clipped(self.middle)  # too many planes
            self._put_probe(state, before)
        except (ScuroError, ImportError) as error:
            self.scene, self.player, self.probe = scene, player, probe
            before.document.show_in(self.scene)
            missing = isinstance(error, ImportError)
            self.message = str(MissingExtraError("Probes", "viewer") if missing else error)
            return False
        self.message = ""
        commit()
        self.tell()
        return True

    def _show(self, state: State, before: State) -> None:
        document, old = state.document, before.document
        if document.input != old.input or not self.player.only_plays(document.load, old.load):
            self.scene = self._scene_of(document)
            self.middle = self.scene.bounds().mean(axis=0)
            self.player = Player(self)
        else:
            if document.load != old.load:
                self.player.show(document.load)
            document.show_in(self.scene)
        self._lighting = self.scene.lighting

    def _scene_of(self, document: SceneFile) -> Scene:
        read, self._read = self._read, None
        return document.scene() if read is None or read.document != document else read.scene

    def _put_probe(self, state: State, before: State) -> None:
        """Make, change or remove the probe; its atoms are sorted anew only if it must be."""
        settings = state.probe
        other = state.document.input != before.document.input
        if settings is None:
            self.probe = None
        elif self.probe is None or other or self.probe.settings.atoms != settings.atoms:
            start = self._start if self.probe is None else self.probe.position
            eye = self._eye if self.probe is None else None
            start = self.middle if start is None else start
            self.probe = Probe(self.scene, settings, start, eye)
        else:
            self.probe.settings = settings

    def tell(self) -> None:
        """Let all views draw anew."""
        for watcher in list(self._watchers):
            watcher.scene_changed()

    def set_probe(self, settings: ProbeSettings | None, start: Any = None, eye: Any = None) -> bool:
        """Put a probe into the scene at a place, or take it away.

        A place among atoms is moved out of them; where it is seen from ``eye``, to their surface.
        """
        self._start, self._eye = start, eye
        return self.change(probe=settings)

    def lighted(self) -> Any:
        """The lighting with the probe's light; ``None`` for the preset's."""
        if self.probe is None:
            return self._lighting
        return self.probe.lit(self._lighting or PRESETS[self.settings.lighting.preset])

    def dressed(self, camera: Camera) -> Scene:
        """The scene as a view draws it: with its clipping, and the probe's light and plane."""
        scene = self.scene
        scene.lighting = self.lighted()
        scene.clip = self.clip if self.probe is None else self.probe.clipped(self.clip, camera)
        return scene

    def focused(self, settings: Settings, camera: Camera) -> Settings:
        """The settings with the probe in focus, where there is depth of field for it."""
        if self.probe is None:
            return settings
        return self.probe.focused(settings, camera)

    def as_seen(self, camera: Camera) -> SceneFile:
        """The document with what the probe adds to it, so that a file makes the same picture."""
        document, probe = self.document, self.probe
        if probe is None:
            return document
        riding = probe.clipped(Clip(), camera).planes
        return replace(
            document,
            light=self.lighted().lights,
            clip=(*document.clip, *map(cut_of, riding)),
            settings=probe.focused(document.settings, camera),
        )

    def save(self, path: str | Path, document: SceneFile | None = None) -> None:
        """Write a scene file.

        Raises:
            SaveError: It cannot be written.
        """
        write_scene_file(path, document or self.document)
