"""The frame, top to bottom."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from scuro.gpu import Gpu, Timings
from scuro.image import Image
from scuro.passes.compose.lighting import lighting_of, lights_uniform, with_implied
from scuro.passes.compose.shade import encode, shade
from scuro.passes.frame import Frame, TargetPool, view_uniform
from scuro.passes.geometry.visibility import draw_visibility
from scuro.passes.occlusion.occlusion import draw_occlusion
from scuro.passes.reservoir.frame import Reservoirs
from scuro.passes.semantic.pipeline import shade_semantic
from scuro.passes.shadow.shadow import draw_shadows
from scuro.passes.volume.frame import Volumes
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.lights import DIRECTIONAL
from scuro.scene.scene import Scene
from scuro.trace import Accelerator, build_accelerator


@dataclass
class _Built:
    """The acceleration structure and what it was built from; shared by sibling renderers."""

    bodies: tuple[Any, ...] = ()
    accelerator: Accelerator | None = None
    bounds: Any = None
    """(2, 3) world box of the scene it was built for."""


class Renderer:
    """Draws scenes on one GPU and keeps between frames what did not change.

    Args:
        device: Adapter number or part of its name; the best one by default.
        gpu: An open GPU to share instead.
    """

    def __init__(self, device: str | None = None, *, gpu: Gpu | None = None) -> None:
        self.gpu = gpu or Gpu(device)
        self.targets = TargetPool(self.gpu)
        self._built = _Built()
        self._volumes = Volumes()
        self._reservoirs = Reservoirs()

    def accelerator(self, scene: Scene) -> Accelerator:
        """The scene's acceleration structure, rebuilt only if a body was replaced."""
        bodies = tuple(scene.bodies())
        built = self._built
        bounds = scene.bounds()
        # without bodies the middle of the scene is still the origin of all that is drawn
        moved = not bodies and not np.array_equal(bounds, built.bounds)
        if built.accelerator is None or bodies != built.bodies or moved:
            built.accelerator = build_accelerator(
                self.gpu, bodies, bounds.mean(axis=0), bounds=bounds
            )
            built.bodies, built.bounds = bodies, bounds
        return built.accelerator

    def sibling(self) -> Renderer:
        """A renderer for another view of the same scene.

        It has textures of its own and shares what was built from the scene.
        """
        other = copy.copy(self)
        other.targets = TargetPool(self.gpu)
        return other

    def frame(self, scene: Scene, camera: Camera, settings: Settings) -> Frame:
        """Record one frame: geometry, occlusion, shadow, compose. Nothing is submitted yet."""
        settings = with_implied(settings)
        scene.show_reservoirs(settings.reservoir)
        accelerator = self.accelerator(scene)
        resources, constants = accelerator.clipped(scene.clip)
        frame = Frame(
            self.gpu,
            self.gpu.recorder(),
            self.targets,
            accelerator,
            camera,
            settings,
            settings.size,
            dict(resources),
            dict(constants),
        )
        lighting = lighting_of(settings.lighting, scene.lighting)
        frame.resources["view"] = view_uniform(
            camera, accelerator.center, settings.size, seed=settings.seed
        )
        frame.resources["lights"] = lights_uniform(
            lighting, camera, accelerator.center, shadows=settings.shadows.technique != "none"
        )
        frame.constants["LOCAL_LIGHTS"] = any(
            light.kind != DIRECTIONAL for light in lighting.lights
        )
        draw_visibility(frame)
        if settings.semantic.mode == "off":
            draw_occlusion(frame)
            draw_shadows(frame)
            shade(frame)
        else:
            shade_semantic(frame, scene.hierarchy())
        self._volumes.draw(frame, scene)
        self._reservoirs.draw(frame, scene)
        encode(frame)
        return frame

    def render(
        self, scene: Scene, camera: Camera | None = None, settings: Settings | None = None
    ) -> Image:
        """Draw a scene.

        Args:
            scene: What to draw.
            camera: From where; by default all of the scene is seen.
            settings: How; the defaults otherwise.
        """
        settings = settings or Settings()
        scene.show_reservoirs(settings.reservoir)
        camera = camera or self.fitted(scene, settings)
        frame = self.frame(scene, camera, settings)
        self.timings: Timings = frame.recorder.submit()
        return Image(self.gpu.read_texture(frame.resources["picture"]), frame)

    def fitted(self, scene: Scene, settings: Settings, **options: Any) -> Camera:
        """A camera that sees the whole scene; ``options`` are those of :meth:`Camera.fitted`."""
        width, height = settings.size
        return Camera.fitted(scene.bounds(), aspect=width / height, **options)


def render(
    scene: Scene,
    *,
    size: tuple[int, int] | None = None,
    camera: Camera | None = None,
    settings: Settings | None = None,
    device: str | None = None,
    **changes: Any,
) -> Image:
    """Draw a scene once.

    Args:
        scene: What to draw.
        size: Width and height in pixels.
        camera: From where; by default all of the scene is seen.
        settings: All settings; the defaults otherwise.
        device: Adapter number or part of its name.
        changes: Single settings, e.g. ``lighting__preset="full"``.
    """
    settings = settings or Settings()
    if size is not None:
        settings = settings.replace(size=size)
    if changes:
        settings = settings.replace(**changes)
    return _shared_renderer(device).render(scene, camera, settings)


_renderers: dict[str | None, Renderer] = {}


def _shared_renderer(device: str | None) -> Renderer:
    """One renderer a device and process: opening a GPU costs more than most pictures."""
    if device not in _renderers:
        _renderers[device] = Renderer(device)
    return _renderers[device]


__all__ = ["Renderer", "render"]
