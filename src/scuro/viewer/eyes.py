"""Where world points lie in the pictures of the eyes that look at them: one, or two in stereo.

Places are pixels of the whole picture, which shows both eyes side by side, or on each other for
red-cyan glasses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.passes.post.stereo import StereoSettings, eye_camera
from scuro.scene.camera import Camera
from scuro.scene.projection import Size, project, unproject


@dataclass(frozen=True)
class Eye:
    """One eye's look at the scene."""

    number: int
    """-1 left, 1 right, 0 where there is one for all."""
    camera: Camera
    """Its own."""
    size: Size
    """Width and height of its picture."""
    start: float = 0.0
    """Where its picture begins in the whole."""
    shift: float = 0.0
    """Of the picture in pixels, which is off its camera's axis."""

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3): pixel x and y, and depth, of world points (n, 3); depth <= 0 is behind it."""
        places = project(self.camera, points, self.size)
        places[:, 0] += self.start - self.shift
        return places

    def unproject(self, place: Size, depth: float) -> NDArray[np.float64]:
        """(3,) world point seen at a place, ``depth`` along the viewing direction."""
        return unproject(self.camera, self.on_axis(place), self.size, depth)

    def on_axis(self, place: Size) -> Size:
        """The pixel of its camera's own picture that shows what is seen at a place."""
        return place[0] - self.start + self.shift, place[1]

    def local(self, place: Size) -> Size:
        """A place in the eye's picture, from that one's corner."""
        return place[0] - self.start, place[1]


def eyes_of(camera: Camera, settings: StereoSettings, extent: float, size: Size) -> tuple[Eye, ...]:
    """The eyes that a picture is for: one, or the left and the right one.

    Args:
        camera: Between them.
        settings: Of stereo.
        extent: Of the scene, which the distance of the eyes is a share of.
        size: Of the whole picture, in any pixels.
    """
    if settings.mode == "none":
        return (Eye(0, camera, size),)
    beside = settings.mode == "side-by-side"
    own = (size[0] / 2, size[1]) if beside else size
    eyes = []
    for number in (-1, 1):
        moved, shift = eye_camera(camera, number, settings.separation * extent, own[1])
        start = own[0] if beside and number > 0 else 0.0
        eyes.append(Eye(number, moved, own, start, shift[0]))
    return tuple(eyes)


def eye_at(eyes: Sequence[Eye], x: float) -> Eye:
    """The eye whose picture is at a column; the right one where they lie on each other."""
    return eyes[-1] if x >= eyes[-1].start else eyes[0]


def pictures(eyes: Sequence[Eye]) -> tuple[Eye, ...]:
    """An eye for each picture that lies apart from the others."""
    return tuple({eye.start: eye for eye in eyes}.values())
