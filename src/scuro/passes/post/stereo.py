"""Stereo: two eyes side by side, or one picture for red–cyan glasses."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from scuro.errors import SettingsError
from scuro.passes.frame import Frame
from scuro.scene.camera import Camera
from scuro.settings import SettingsGroup, setting
from scuro.style.paint import premultiplied


class StereoSettings(SettingsGroup):
    """Pictures for two eyes."""

    mode: str = setting(
        "none",
        "two eyes side by side (parallel view), or red-cyan for coloured glasses",
        choices=("none", "side-by-side", "red-cyan"),
        main=True,
    )
    separation: float = setting(
        0.13, "distance of the eyes, in radii of the scene", low=0.001, high=1
    )


def eye_size(settings: StereoSettings, size: tuple[int, int]) -> tuple[int, int]:
    """Width and height of one eye's picture: half as wide side by side.

    Raises:
        SettingsError: The width cannot be halved.
    """
    width, height = size
    if settings.mode != "side-by-side":
        return size
    if width % 2:
        raise SettingsError(f"two pictures side by side need an even width, not {width}")
    return width // 2, height


def eye_camera(
    camera: Camera, eye: int, separation: float, height: float
) -> tuple[Camera, tuple[float, float]]:
    """An eye's camera, and the shift of its picture in pixels.

    The eyes look in parallel and their pictures are shifted so that the target has no parallax
    (off-axis projection): turning the eyes inward instead would shift heights between them. A
    parallel projection has no parallax to begin with; there the eyes go around the target.

    Args:
        camera: Between the eyes.
        eye: -1 left, 1 right.
        separation: Of the eyes, world units.
        height: Of the picture, pixels.
    """
    half = eye * separation / 2
    if camera.orthographic:
        return camera.orbited(math.degrees(math.atan(half / camera.distance)), 0), (0.0, 0.0)
    right = camera.view_from_world()[0, :3]
    moved = replace(
        camera,
        position=tuple((np.asarray(camera.position) + half * right).tolist()),
        target=tuple((np.asarray(camera.target) + half * right).tolist()),
    )
    pixel = 2 * camera.half_height() * camera.distance / height
    return moved, (-half / pixel, 0.0)


def keep_left_eye(frame: Frame) -> None:
    """Set ``color`` and ``ids`` aside for :func:`join_eyes` of the right eye's frame."""
    color = frame.resources["color"]
    left = frame.target("left_eye", "rgba16float", size=color.size[:2])
    frame.recorder.copy_texture(color, left)
    ids = frame.resources["ids"]
    frame.recorder.copy_texture(ids, frame.target("left_ids", "rgba32uint", size=ids.size[:2]))


def join_eyes(frame: Frame) -> None:
    """Make the red–cyan picture of the left eye's ``color`` and this frame's."""
    right = frame.resources["color"]
    left = frame.targets.get("left_eye", right.size[:2], "rgba16float")
    ids = frame.resources["ids"]
    frame.resources["left_ids"] = frame.targets.get("left_ids", ids.size[:2], "rgba32uint")
    background = premultiplied(frame.settings.background)
    frame.replace_color(
        "passes/post/anaglyph.wgsl", {"left": left, "anaglyph": {"background": background}}
    )
