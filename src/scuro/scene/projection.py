"""From the world to a picture's pixels and back, for a whole camera.

Pixels are counted from the picture's upper left corner; ``size`` is its width and height.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.scene.camera import Camera

Size = tuple[float, float]


def project(camera: Camera, points: ArrayLike, size: Size) -> NDArray[np.float64]:
    """(n, 3): pixel x and y, and depth, of world points (n, 3); depth <= 0 is behind the eye."""
    matrix = camera.view_from_world()
    view = np.atleast_2d(np.asarray(points, np.float64)) @ matrix[:3, :3].T + matrix[:3, 3]
    depth = -view[:, 2]
    half = camera.half_height() * (
        np.ones_like(depth) if camera.orthographic else np.where(depth > 0, depth, np.nan)
    )
    x = (view[:, 0] / (half * size[0] / size[1]) + 1) / 2 * size[0]
    y = (1 - view[:, 1] / half) / 2 * size[1]
    return np.stack([x, y, depth], axis=1)


def unproject(camera: Camera, pixel: Size, size: Size, depth: float) -> NDArray[np.float64]:
    """(3,) world point seen at a pixel position, ``depth`` along the viewing direction."""
    return unproject_all(camera, np.array([pixel]), size, np.array([depth]))[0]


def unproject_all(
    camera: Camera, pixels: NDArray, size: Size, depths: NDArray
) -> NDArray[np.float64]:
    """(n, 3) world points seen at pixel positions (n, 2), ``depths`` (n,) along the direction."""
    half = camera.half_height()
    scale = np.ones_like(depths) if camera.orthographic else depths
    x = (2 * pixels[:, 0] / size[0] - 1) * half * size[0] / size[1] * scale
    y = (1 - 2 * pixels[:, 1] / size[1]) * half * scale
    matrix = camera.view_from_world()
    return (np.stack([x, y, -depths], axis=1) - matrix[:3, 3]) @ matrix[:3, :3]
