"""Where one person stands before a model's scene, and what they chose there; draws nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.export.scene_file import Input
from scuro.passes.post.stereo import StereoSettings, eye_size
from scuro.render_names import SMALLEST_TEXT, text_size
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.points import scene_points
from scuro.scene.view import ViewSettings, view_camera
from scuro.viewer import navigate
from scuro.viewer.model import Model
from scuro.viewer.pick import Pick

SPIN = 30.0
"""Degrees a second."""
_PARALLAX = 0.08
"""Share of an eye's picture side by side that is left free for it."""


class Stance:
    """Camera, selection and habits of one person.

    Args:
        model: What is looked at; shared with others.
        size: Width and height of the picture in pixels.
    """

    def __init__(self, model: Model, size: tuple[int, int]) -> None:
        self.model = model
        self.size = size
        self.ratio = 1.0
        """Pixels of the picture to each logical pixel of its screen."""
        self.foot = 0.0
        """Share of the picture's height that something covers at its foot."""
        self.camera = self.initial_camera()
        self._place = self._shown_place()
        self._cameras: dict[Any, Camera] = {}
        """Where this view stood before what was shown earlier."""
        self._stereo = model.settings.stereo
        self.selection: list[Pick] = []
        self.spinning = False
        self._spun = 0.0
        self.profile = "scuro"
        """What drags do: a name in :data:`scuro.viewer.controls.PROFILES`."""
        self.windowing = False
        """Whether dragging sets window and level of a volume."""

    def initial_camera(self) -> Camera:
        """As the document says, for this size."""
        model, wanted = self.model, self.model.document.view
        points = model.player.points(wanted.focus) if wanted.position is None else None
        camera = view_camera(model.scene, wanted, self.aspect, points=points)
        return camera if wanted.position is not None else navigate.raised(camera, self.foot)

    @property
    def aspect(self) -> float:
        """Width over height of what an eye sees."""
        return self._aspect(self.model.settings.stereo)

    def _aspect(self, stereo: StereoSettings) -> float:
        width, height = eye_size(stereo, drawn_size(stereo, self.size))
        return width / height

    def _roomy(self, stereo: StereoSettings) -> float:
        """The same, with room at the sides for what parallax shifts."""
        beside = stereo.mode == "side-by-side"
        return self._aspect(stereo) * (1 - _PARALLAX if beside else 1.0)

    def _shown_place(self) -> Any:
        """What a camera belongs to: what was read, and from where it is first looked at."""
        return self.model.document.input, self.model.document.view

    def follow(self) -> None:
        """Stand before another scene where it was left, or as it says; see as much in stereo."""
        place, stereo = self._shown_place(), self.model.settings.stereo
        if place != self._place:
            self._cameras[self._place] = self.camera
            self.camera = self._cameras.get(place) or self._newly(place[0])
        elif stereo.mode != self._stereo.mode:
            before, after = self._roomy(self._stereo), self._roomy(stereo)
            self.camera = navigate.narrowed(self.camera, before, after, self._points())
        self._place, self._stereo = place, stereo

    def _newly(self, inputs: tuple[Input, ...]) -> Camera:
        """Where to stand before what was not seen before: from the same side if files came to
        those that are shown, where one stands if some went."""
        shown = self._place[0]
        if set(inputs) < set(shown):
            return self.camera
        return self._fitted() if set(inputs) > set(shown) else self.initial_camera()

    def _points(self) -> NDArray[np.float64]:
        """(n, 4) centres and radii that bound the scene, in all frames that can be played."""
        points = self.model.player.points()
        return scene_points(self.model.scene, outermost=True) if points is None else points

    @property
    def full_settings(self) -> Settings:
        """Of the picture that the view comes to rest at; ``scuro render`` makes the same one."""
        settings = self.model.settings.replace(
            size=drawn_size(self.model.settings.stereo, self.size)
        )
        if settings.text is None and text_size(settings) < SMALLEST_TEXT * self.ratio:
            settings = settings.replace(text=SMALLEST_TEXT * self.ratio / settings.px)
        return self.model.focused(settings, self.camera)

    def move(self, camera: Camera) -> None:
        """See the scene from elsewhere."""
        self.camera = camera

    def stir(self) -> None:
        """Something moves."""

    def spin(self, now: float) -> None:
        """Turn as far as the seconds since the last call tell."""
        if self._spun:
            self.camera = self.camera.orbited(SPIN * min(now - self._spun, 0.5), 0)
        self._spun = now

    def toggle_spin(self) -> None:
        """Start or stop turning about the vertical."""
        self.spinning = not self.spinning
        self._spun = 0.0
        self.stir()

    def fit(self) -> None:
        """See all of the scene, in all frames that can be played, from the same side."""
        self.move(self._fitted())

    def _fitted(self) -> Camera:
        points, bounds = self._points(), self.model.scene.bounds()
        aspect = self._roomy(self.model.settings.stereo)
        fitted = navigate.fit(self.camera, bounds, aspect, points if len(points) else None)
        return navigate.raised(fitted, self.foot)

    def select(self, found: Pick | None, add: bool = False) -> None:
        """Select what was picked, or nothing; with ``add``, besides what is selected."""
        if found is None:
            self.selection = self.selection if add else []
            return
        again = [p for p in self.selection if p.same_place(found)]
        if add and again:
            self.selection.remove(again[0])
        else:
            self.selection = [*(self.selection if add else []), found]

    def document(self) -> Any:
        """The document that makes this view's picture, at this size."""
        return replace(
            self.model.as_seen(self.camera),
            view=ViewSettings.of(self.camera),
            settings=self.full_settings,
        )


def drawn_size(stereo: StereoSettings, size: tuple[int, int]) -> tuple[int, int]:
    """A picture's size: side by side it is an even number of pixels wide."""
    width, height = size
    if stereo.mode == "side-by-side":
        width = max(2, width - width % 2)
    return width, height
