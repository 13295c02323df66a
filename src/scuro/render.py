"""The frame, top to bottom."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from scuro.errors import SettingsError
from scuro.gpu import Gpu, Timings
from scuro.image import Image
from scuro.passes.begin import begun
from scuro.passes.compose.context import draw_context
from scuro.passes.compose.lighting import with_implied
from scuro.passes.compose.shade import encode, shade
from scuro.passes.filter.temporal import History
from scuro.passes.frame import Frame
from scuro.passes.geometry.visibility import draw_visibility
from scuro.passes.occlusion.occlusion import draw_occlusion, prepare_occlusion
from scuro.passes.part import Part
from scuro.passes.post.antialias import filter_down
from scuro.passes.post.attention import draw_attention
from scuro.passes.post.cues import draw_cues
from scuro.passes.post.focus import draw_focus
from scuro.passes.post.fxaa import draw_fxaa, smooth_picture
from scuro.passes.post.stereo import eye_size, join_eyes, keep_left_eye
from scuro.passes.reservoir.frame import Reservoirs
from scuro.passes.semantic.pipeline import shade_semantic
from scuro.passes.semantic.recolor import color_by_level, object_colors
from scuro.passes.semantic.still import draw_still
from scuro.passes.shadow.shadow import draw_shadows, prepare_shadows
from scuro.passes.targets import TargetPool
from scuro.passes.transparent.layers import Layers, opaque_only
from scuro.passes.volume.frame import Volumes
from scuro.passes.volume.front import volume_front
from scuro.reference.path import PathTracer
from scuro.render_marks import ACROSS, picture_marks
from scuro.render_names import Names
from scuro.render_parts import parts_of
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene
from scuro.style.marks import paint
from scuro.style.region_labels import Survey
from scuro.trace import Accelerator
from scuro.trace.kept import Accelerators


class Renderer:
    """Draws scenes on one GPU and keeps between frames what did not change.

    Args:
        device: Adapter number or part of its name; the best one by default.
        gpu: An open GPU to share instead.
    """

    patience = 0.03
    """Seconds for which :meth:`prepare` builds before its caller has a turn."""

    def __init__(self, device: str | None = None, *, gpu: Gpu | None = None) -> None:
        self.gpu = gpu or Gpu(device)
        self.targets = TargetPool(self.gpu)
        self.accelerators = Accelerators(self.gpu)
        self._volumes = Volumes()
        self.reservoirs = Reservoirs()
        self._paths = PathTracer()
        self._layers = Layers()
        self._small = TargetPool(self.gpu)
        self.history = History()
        """What frames drawn with ``accumulate`` found."""
        self.breathe: Callable[[float], None] | None = None
        """Called between pieces of long passes: see :attr:`Frame.breathe`."""

    def accelerator(self, scene: Scene) -> Accelerator:
        """The scene's acceleration structure, rebuilt only if a body was replaced."""
        return self.accelerators.scene(scene)

    def holds(self, scene: Scene) -> bool:
        """Whether a frame of the scene needs no new acceleration structure or volume."""
        if not self.accelerators.hold(scene):
            return False
        return self._volumes.holds(scene, self.accelerator(scene).center)

    def restart(self) -> None:
        """Forget what earlier frames of the same picture gathered."""
        self._paths = PathTracer()
        self._volumes.restart()
        self._layers = Layers()
        self.history = History()

    def sibling(self) -> Renderer:
        """A renderer for another view of the same scene.

        It has textures of its own and shares what was built from the scene.
        """
        other = copy.copy(self)
        other.targets = TargetPool(self.gpu)
        other.restart()
        return other

    def frame(
        self,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        part: Part | None = None,
        *,
        accumulate: bool = False,
    ) -> Frame:
        """Record one frame, or a part of it, up to ``picture``; the last pass is not submitted yet.

        Args:
            scene: What to draw.
            camera: From where.
            settings: How.
            part: Which part; all of the picture by default.
            accumulate: Go on from the frames drawn so before (:attr:`history`): while the camera
                rests, occlusion and area shadows become the mean over all of them; where it
                moves, they start from what the frame before knew of the same surface.

        Raises:
            SettingsError: The picture is too large to be drawn at once: see :meth:`parts`.
        """
        if part is None:
            part, *more = self.parts(settings)
            if more:
                raise SettingsError(
                    "this picture is drawn in parts, which cannot be one frame: lower the size or "
                    "--antialias, and draw one eye at a time"
                )
        if settings.stereo.mode == "red-cyan":
            left = self._colored(scene, camera, settings, replace(part, eye=-1))
            draw_fxaa(left)
            keep_left_eye(left)
            left.recorder.submit()
            frame = self._colored(scene, camera, settings, replace(part, eye=1))
            draw_fxaa(frame)
            join_eyes(frame)
            encode(frame)
        else:
            frame = self._colored(scene, camera, settings, part, accumulate)
            encode(frame)
            smooth_picture(frame)
        return frame

    def prepare(self, scene: Scene, camera: Camera, settings: Settings) -> Iterator[float]:
        """Build in slices what a picture needs first and keeps for those that follow.

        :meth:`frame` builds it, too, but all at once; a viewer would stand still meanwhile.

        Yields:
            The share of a part of the work that is done; nothing if all is there.
        """
        scene.show_reservoirs(settings.reservoir)
        yield from self._patiently(self.accelerators.context_in_steps(scene))
        part = self.parts(settings)[0]
        frame = self._begun(scene, camera, with_implied(settings), part)
        if frame.settings.renderer != "path" and frame.settings.semantic.mode == "off":
            yield from self._patiently(prepare_occlusion(frame))
            yield from self._patiently(prepare_shadows(frame))
        yield from self._patiently(self._volumes.prepare(frame, scene))

    def _patiently(self, steps: Iterator[float]) -> Iterator[float]:
        """Those of the steps at whose end the caller's turn has come."""
        begun = time.perf_counter()
        for share in steps:
            self.gpu.finish()  # a step is not done when it is submitted
            if time.perf_counter() - begun > self.patience:
                yield share
                begun = time.perf_counter()

    def _colored(
        self,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        part: Part,
        accumulate: bool = False,
    ) -> Frame:
        """Record what makes ``color``: geometry, occlusion, shadow, compose, post."""
        settings = with_implied(settings)
        frame = self._begun(scene, camera, settings, part)
        if accumulate and not part.eye and settings.renderer != "path":
            frame.history = self.history
            view = frame.resources["view"]
            view["frame"] = self.history.begin(view, frame.size)
        with opaque_only(frame):
            draw_visibility(frame)
        if settings.renderer != "path":
            self._paths = PathTracer()  # its sums may be gone when it goes on, and its scene
        if settings.renderer == "path":
            by_level = settings.semantic.palette or settings.semantic.mode != "off"
            colors = None
            if by_level:
                colors = object_colors(frame, scene.hierarchy(settings.semantic.parts))
            self._paths.draw(frame, colors)
        elif settings.semantic.mode == "off":
            if settings.semantic.palette:
                color_by_level(frame, scene.hierarchy())
            draw_occlusion(frame)
            draw_shadows(frame)
        else:
            shade_semantic(frame, scene.hierarchy(settings.semantic.parts))
        if frame.history is not None:
            frame.history.end(frame)
        context = self.accelerators.context(scene)
        lights = settings.renderer != "path" and settings.semantic.mode == "off"
        shades_last = lights and context is None and not _covered(frame, scene)
        if lights and not shades_last:
            shade(frame)
        if context is not None:
            draw_context(frame, context, scene.clip.cutting)
        if lights:
            self._layers.draw(frame, _light)
        draw_attention(frame, scene)
        self._volumes.draw(frame, scene)
        self.reservoirs.draw(frame, scene)
        with volume_front(frame, scene):
            draw_cues(frame, shading=shades_last)
        draw_focus(frame, scene)
        draw_still(frame)
        filter_down(frame)
        return frame

    def _begun(self, scene: Scene, camera: Camera, settings: Settings, part: Part) -> Frame:
        """A frame with its scene, view and lights, before anything is drawn."""
        scene.show_reservoirs(settings.reservoir)
        accelerator = self.accelerator(scene)
        frame = begun(self.gpu, self.targets, accelerator, scene, camera, settings, part)
        frame.breathe = self.breathe
        return frame

    def parts(self, settings: Settings, bands: int = 1, rows: int | None = None) -> list[Part]:
        """The parts in which a picture is drawn: see :func:`~scuro.render_parts.parts_of`."""
        return parts_of(with_implied(settings), self.gpu.max_texture, bands, rows)

    def frames(
        self, scene: Scene, camera: Camera, settings: Settings, rows: int | None = None
    ) -> Iterator[tuple[Part, Frame]]:
        """Draw a picture part by part; each frame is finished when it is given, until the next.

        ``rows`` are the most that parts of a large picture shall keep.
        """
        for part in self.parts(settings, rows=rows):
            frame = self.frame(scene, camera, settings, part)
            self.timings: Timings = frame.recorder.submit()
            yield part, frame

    def render(
        self,
        scene: Scene,
        camera: Camera | None = None,
        settings: Settings | None = None,
        names: Names | None = None,
    ) -> Image:
        """Draw a scene.

        Args:
            scene: What to draw.
            camera: From where; by default all of the scene is seen.
            settings: How; the defaults otherwise.
            names: Labels in place of those that the picture by itself would have.
        """
        settings = settings or Settings()
        scene.show_reservoirs(settings.reservoir)
        camera = camera or self.fitted(scene, settings)
        width, height = settings.size
        pixels = np.empty((height, width, 4), np.uint8)
        count = 0
        for part, frame in self.frames(scene, camera, settings):
            drawn = self.gpu.read_texture(frame.resources["picture"])
            pixels[part.rows, part.columns] = drawn[part.inside]
            count += 1
        marks = picture_marks(self, scene, camera, settings, names)
        whole = frame if count == 1 else None
        return Image(paint(pixels, marks), whole, settings, marks)

    def survey(self, scene: Scene, camera: Camera, settings: Settings) -> Survey:
        """What is where in a picture, coarsely, without its light."""
        own = copy.copy(self)  # what has been drawn with our own textures is still asked for
        own.targets = self._small
        width, height = eye_size(settings.stereo, settings.size)
        share = min(1.0, ACROSS / width)
        size = (max(1, round(share * width)), max(1, round(share * height)))
        small = settings.replace(
            size=size, antialias__method="none", stereo__mode="none", renderer="deferred"
        )
        frame = own._begun(scene, camera, small, Part((0, 0), size, (0, 0, *size)))
        with opaque_only(frame):
            draw_visibility(frame)
        frame.recorder.submit()
        ids, surface = (self.gpu.read_texture(frame.resources[n]) for n in ("ids", "surface"))
        own.targets.frame = None  # or the scene's tables would stay until the next survey
        return Survey(ids, surface[..., 3], camera)

    def fitted(self, scene: Scene, settings: Settings, **options: Any) -> Camera:
        """A camera that sees the whole scene; ``options`` are those of :meth:`Camera.fitted`."""
        width, height = eye_size(settings.stereo, settings.size)
        return Camera.fitted(scene.bounds(), aspect=width / height, **options)


def _covered(frame: Frame, scene: Scene) -> bool:
    """Whether anything is laid on what is shaded, before the depth cues."""
    films = any(body.material.opacity < 1 for body in frame.accelerator.bodies)
    chosen = bool(frame.settings.attention.subtree)
    return films or chosen or bool(scene.volumes) or bool(scene.reservoirs)


def _light(frame: Frame) -> None:
    """Occlusion, shadows and shading of what a G-buffer holds: ``color``."""
    draw_occlusion(frame)
    draw_shadows(frame)
    shade(frame)
