"""How calm a picture stays while its camera moves by less than a pixel, or comes closer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene


def shimmer(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings) -> float:
    """Deviation (root mean square, 1 is white) of what is shown over four shifts by 1/4 pixel.

    The camera moves sideways; nothing but the places of the samples changes.
    """
    right = camera.view_from_world()[0, :3]
    pixel = _pixel(camera, settings)
    shots = []
    for step in range(4):
        shift = right * pixel * step / 4
        moved = replace(
            camera,
            position=tuple((np.asarray(camera.position) + shift).tolist()),
            target=tuple((np.asarray(camera.target) + shift).tolist()),
        )
        shots.append(_shot(renderer, scene, moved, settings))
    return _deviation(shots)


def zoom_shimmer(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings) -> float:
    """As :func:`shimmer`, over four steps that bring the picture's edge a quarter pixel outward.

    The picture's middle, in which points move by less than an eighth of a pixel, is compared.
    """
    back = np.subtract(camera.position, camera.target)
    shots = []
    for step in range(4):
        closer = 1 - step * 0.5 / settings.size[0]
        moved = replace(camera, position=tuple((camera.target + closer * back).tolist()))
        if camera.height is not None:
            moved = replace(moved, height=camera.height * closer)
        shot = _shot(renderer, scene, moved, settings)
        h, w = shot.shape[1:]
        shots.append(shot[:, h // 4 : -h // 4, w // 4 : -w // 4])
    return _deviation(shots)


def _pixel(camera: Camera, settings: Settings) -> float:
    """World width of a pixel at the camera's target."""
    across = 1.0 if camera.orthographic else camera.distance
    return 2 * camera.half_height() * across / settings.size[1]


def _shot(
    renderer: Renderer, scene: Scene, camera: Camera, settings: Settings
) -> NDArray[np.float64]:
    """(2, h, w): luminance, and whether any sample of the pixel meets a surface."""
    picture = np.asarray(renderer.render(scene, camera, settings))[..., :3]
    frame = renderer.targets.frame
    if frame is None or frame.size != tuple(frame.scale * s for s in settings.size):
        raise SettingsError("calm is measured in pictures that are drawn at once: lower the size")
    met = renderer.gpu.read_texture(frame.resources["surface"])[..., 3] > 0
    h, w = picture.shape[:2]
    shown = met.reshape(h, frame.scale, w, frame.scale).any(axis=(1, 3))
    return np.stack([picture @ np.array([0.2126, 0.7152, 0.0722]) / 255, shown])


def _deviation(shots: list[NDArray[np.float64]]) -> float:
    """Root of the mean variance over pixels in which some of the shots meet a surface."""
    luminance, met = np.stack(shots, axis=1)
    shown = met.any(axis=0)
    return float(np.sqrt(luminance.var(axis=0)[shown].mean())) if shown.any() else 0.0
