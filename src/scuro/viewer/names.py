"""Names, legends, scale bar and axes over a live picture.

What has a name is found out by a coarse survey a few times a second, of the picture that is shown
anyway. Between surveys names stay on their points of the scene's surfaces as the camera moves; they
come and go by fading, and one that is shown has its room before one that is not.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.errors import ScuroError
from scuro.passes.post.stereo import eye_size
from scuro.render_marks import Sight, gauge_marks, legends_of, shifted, tells_regions
from scuro.render_names import (
    Standing,
    name_extent,
    name_text,
    namer_of,
    taken_by,
    text_size,
    wanted,
)
from scuro.scene.projection import project
from scuro.style.labels import overlapping
from scuro.style.marks import Mark
from scuro.style.region_labels import RegionLabel, Survey, region_labels
from scuro.viewer.drawing import Drawn
from scuro.viewer.eyes import Eye, eye_at
from scuro.viewer.playbar import room

if TYPE_CHECKING:
    from scuro.render_settings import Settings
    from scuro.viewer.view import View

ACROSS = 160
"""Pixels across a survey."""
EVERY = 0.15
"""Seconds between surveys, at least."""
FADE = 0.25
"""Seconds in which a name comes or goes."""


@dataclass
class _Track:
    """A name on one point, from its coming to its going."""

    label: RegionLabel
    opacity: float = 0.0
    goal: float = 0.0
    found: bool = True
    """Whether the last survey had it."""
    fresh: bool = True
    """It begins to fade in with the next picture: this one may have been long in coming."""


class Names:
    """What is written over one view's picture.

    Args:
        view: Whose.
        clock: Seconds, for tests.
    """

    def __init__(self, view: View, clock: Callable[[], float]) -> None:
        self.view = view
        self._clock = clock
        self._tracks: dict[tuple[Hashable, Any], _Track] = {}
        self._seen: Drawn | None = None
        self._surveyed = self._last = -1e9
        self._asked: Any = None
        self._legend: tuple[Any, list[Mark]] = (None, [])
        self._told: Drawn | None = None
        self._told_at = -1e9

    @property
    def wait(self) -> float | None:
        """Seconds until something changes by itself; ``None`` if nothing does."""
        if any(track.opacity != track.goal for track in self._tracks.values()):
            return 1 / 30
        if self._named() and self.view.drawn is not None and self._seen is not self.view.drawn:
            return max(0.0, EVERY - (self._clock() - self._surveyed))
        if self._told is not None and self._told is not self.view.drawn:
            return max(0.0, EVERY - (self._clock() - self._told_at))
        return None

    def _named(self) -> bool:
        return self.view.model.settings.labels.show != "none"

    def marks(self, number: int = 0) -> list[Mark]:
        """What to draw now for one of the view's eyes, in its pixels; names lie in their depth."""
        settings = self.view.full_settings
        drawn = self.view.drawn
        if drawn is None:
            return []
        fixed = self._fixed(settings, drawn)
        eyes = drawn.eyes(settings.size)
        eye = next((e for e in eyes if e.number == number), eyes[0])
        names = self._names(settings, drawn, fixed, eye)
        return [*names, *(shifted(mark, eye.start) for mark in fixed)]

    def _fixed(self, settings: Settings, drawn: Drawn) -> list[Mark]:
        scene = self.view.model.scene
        marks = gauge_marks(scene, drawn.camera, settings)
        regions = tells_regions(scene, settings)
        if not regions:
            self._told = None
        if settings.legend.show:
            key = (settings, tuple(map(id, scene.items)), self.view.model.document.show)
            due = self._clock() - self._told_at >= EVERY
            if self._legend[0] != key or (regions and due and self._told is not drawn):
                try:
                    plays = self.view.model.player.length > 1
                    logical = [s / self.view.ratio for s in self.view.size]
                    free = room((logical[0], logical[1])) * self.view.ratio if plays else 0.0
                    sight = self._sight(settings, drawn) if regions else None
                    self._legend = (key, legends_of(scene, settings, free, sight))
                except ScuroError:  # the picture cannot be drawn either, and says why
                    self._legend = (key, [])
            marks += self._legend[1]
        return marks

    def _names(
        self, settings: Settings, drawn: Drawn, fixed: Sequence[Mark], eye: Eye
    ) -> list[Mark]:
        now = self._clock()
        elapsed, self._last = min(now - self._last, FADE), now
        if not self._named():
            if self._asked is not None:
                self.view.remark, self._asked, self._seen = "", None, None
                self._tracks.clear()
            return []
        asked = (settings.labels, settings.semantic)
        if asked != self._asked:
            self._asked, self._seen = asked, None
        if self._seen is not drawn and now - self._surveyed >= EVERY:
            self._survey(settings, drawn)
            self._seen, self._surveyed = drawn, now
        return self._laid_out(settings, drawn, fixed, eye, elapsed)

    def _survey(self, settings: Settings, drawn: Drawn) -> None:
        """Find out what there is to name; names stay on their points while these can be seen."""
        view = self.view
        scene = view.model.scene
        keep = {key: track.label.anchor for (key, _), track in self._tracks.items() if track.found}
        try:
            standing = Standing(drawn.camera, settings, view.renderer.accelerator(scene))
            levels = wanted(scene, standing)
            found = region_labels(self._look(drawn), namer_of(scene, settings), levels, keep)
            view.remark = ""
        except ScuroError as error:
            found, view.remark = [], str(error)
        for track in self._tracks.values():
            track.found = False
        for label in found:
            place = (label.key, label.anchor)
            track = self._tracks.setdefault(place, _Track(label))
            track.label, track.found = label, True

    def _sight(self, settings: Settings, drawn: Drawn) -> Sight:
        """What the picture shows, for a legend that goes with it."""
        self._told, self._told_at = drawn, self._clock()
        accelerator = self.view.renderer.accelerator(self.view.model.scene)
        return Sight(Standing(drawn.camera, settings, accelerator), self._look(drawn))

    def _look(self, drawn: Drawn) -> Survey:
        """One eye's picture: that of the left one side by side."""
        gpu = drawn.gpu
        eye = eye_at(drawn.eyes(drawn.size), 0.0)
        width, height = eye.size
        across = min(ACROSS, int(width))
        size = (across, max(1, round(across * height / width)))
        surveyed = gpu.texture(size, "rgba32uint", label="survey")
        recorder = gpu.recorder()
        resources = {
            "ids": drawn.resources["ids"],
            "surface": drawn.resources["surface"],
            "surveyed": surveyed,
            "look": {"size": eye.size, "end": width, "shift": -eye.shift},
        }
        recorder.compute("viewer/survey.wgsl", "main", size, resources)
        recorder.submit()
        found = gpu.read_texture(surveyed)
        depth = np.ascontiguousarray(found[..., 3]).view(np.float32)
        return Survey(found, depth, eye.camera)

    def _laid_out(
        self, settings: Settings, drawn: Drawn, fixed: Sequence[Mark], eye: Eye, elapsed: float
    ) -> list[Mark]:
        """Give names their room, those that are shown first; let all fade toward their goals.

        They are laid out once between the eyes.
        """
        tracks = sorted(self._tracks.items(), key=lambda t: (t[1].opacity == 0, -t[1].label.area))
        if not tracks:
            return []
        size = eye_size(settings.stereo, settings.size)
        text = text_size(settings)
        anchors = [track.label.anchor for _, track in tracks]
        places = project(drawn.camera, anchors, size)
        seen = eye.project(anchors)
        taken = [*taken_by(fixed)]
        shown: list[Mark] = []
        count = 0
        for (key, track), (x, y, depth), there in zip(tracks, places, seen, strict=True):
            w, h = name_extent(track.label.text, text)
            box = (x - w / 2, y - h / 2, x + w / 2, y + h / 2)
            fits = bool(
                track.found and depth > 0 and count < settings.labels.most
                and box[0] >= 0 and box[1] >= 0 and box[2] <= size[0] and box[3] <= size[1]
                and not overlapping(np.array(taken).reshape(-1, 4), np.array(box)).any()
            )  # fmt: skip
            if fits or track.opacity > 0:
                taken.append(box)
            count += fits
            track.goal = track.label.opacity if fits else 0.0
            step = 0.0 if track.fresh else elapsed / FADE
            track.fresh = False
            track.opacity += min(max(track.goal - track.opacity, -step), step)
            if track.opacity > 0 and depth > 0:
                there_x, there_y = float(there[0]), float(there[1])
                mark = name_text(track.label, there_x, there_y, settings, track.opacity)
                left, _, right, _ = mark.box
                if not eye.number or (eye.start <= left and right <= eye.start + size[0]):
                    shown.append(mark)  # nothing of it in the other eye's picture
            elif not track.found:
                del self._tracks[key]
        return shown
