"""The start of a frame: its scene, view and lights, before anything is drawn."""

from __future__ import annotations

from scuro.gpu import Gpu
from scuro.passes.compose.lighting import lighting_of, lights_uniform
from scuro.passes.frame import Frame, view_uniform
from scuro.passes.part import Part
from scuro.passes.post.stereo import eye_camera, eye_size
from scuro.passes.targets import TargetPool
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.lights import DIRECTIONAL
from scuro.scene.scene import Scene
from scuro.trace import Accelerator


def begun(
    gpu: Gpu,
    targets: TargetPool,
    accelerator: Accelerator,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    part: Part,
) -> Frame:
    """A frame of one part of a picture.

    Args:
        gpu: Where it is drawn.
        targets: Its textures.
        accelerator: The scene's acceleration structure.
        scene: Whose clip and lights it has.
        camera: Of the whole picture, between both eyes.
        settings: How it is drawn.
        part: The pixels, and the eye that sees them.
    """
    resources, constants = accelerator.clipped(scene.clip.cutting)
    scale = settings.antialias.scale
    width, height = (scale * s for s in eye_size(settings.stereo, settings.size))
    jitter = (0.0, 0.0)
    if part.eye:
        separation = settings.stereo.separation * accelerator.extent
        camera, jitter = eye_camera(camera, part.eye, separation, height)
    lighting = lighting_of(settings.lighting, scene.lighting)
    casting = settings.renderer == "path" or settings.shadows.technique != "none"
    detail = accelerator.detail_for(camera, height, settings.detail)
    view = view_uniform(
        camera,
        accelerator.center,
        (width, height),
        tile=(scale * part.origin[0], scale * part.origin[1]),
        jitter=jitter,
        seed=settings.seed,
    )
    size = (scale * part.size[0], scale * part.size[1])
    targets.begin(size)
    return Frame(
        gpu,
        gpu.recorder(),
        targets,
        accelerator,
        camera,
        settings,
        size,
        {
            **resources,
            "scene": resources["scene"] | detail,
            "view": view,
            "lights": lights_uniform(lighting, camera, accelerator.center, shadows=casting),
        },
        {
            **constants,
            "LIGHT_COUNT": len(lighting.lights),
            "LOCAL_LIGHTS": any(light.kind != DIRECTIONAL for light in lighting.lights),
        },
        scale,
    )
