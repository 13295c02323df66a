"""What is behind a picture, as arrays in the world's (the file's own) coordinates."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.export.inspect import intermediates, read_intermediate
from scuro.settings import unknown

if TYPE_CHECKING:
    from scuro.passes.frame import Frame


def available(frame: Frame) -> list[str]:
    """Names of the buffers that a frame can give: those of passes that ran."""
    optional = {
        "visibility": "visibility",
        "shadow": "shadow",
        "volume_opacity": "volume_color",
        "volume_depth": "volume_depth",
    }
    return [name for name in _READERS if optional.get(name, "surface") in frame.resources]


def read_buffer(frame: Frame, name: str) -> NDArray:
    """One buffer of a frame, (h, w) or (h, w, 3).

    ``position`` (world; NaN where empty), ``normal`` (world, unit; 0 where empty), ``color``
    (linear base colour), ``depth`` (along -z of the view; infinite where empty), ``atom``,
    ``instance``, ``object`` (int32, -1 where empty), ``visibility`` (1 is open), ``shadow`` (the
    lights' mean, 1 is lit), ``volume_opacity`` (a volume's, 0 to 1), ``volume_depth`` (where half
    of that is reached; infinite where there is none), ``linear`` (the picture as premultiplied
    linear light, h, w, 4).

    Any other texture of the frame's passes is given as it is by its name, or one channel of it as
    ``NAME.y``: see :mod:`scuro.export.inspect`.

    Raises:
        SettingsError: The frame has no such buffer.
    """
    if name in _READERS:
        if name not in available(frame):
            raise SettingsError(f"there is no '{name}' buffer: no pass of this picture makes it")
        return _READERS[name](frame)
    inner = intermediates(frame)
    if name.partition(".")[0] in inner:
        return read_intermediate(frame, name)
    raise SettingsError(unknown("buffer", name, list(dict.fromkeys([*available(frame), *inner]))))


def read_buffers(frame: Frame) -> dict[str, NDArray]:
    """All buffers but ``linear``, all textures of the passes that are none of them, the camera.

    Textures keep their own numbers and, of supersampled pictures, their own size. The camera is two
    4×4 matrices for column vectors:
    ``view_from_world`` and ``clip_from_view`` (reversed depth: 1 at the near plane, 0 far away).
    """
    found = {name: read_buffer(frame, name) for name in available(frame) if name != "linear"}
    depth = found["depth"][np.isfinite(found["depth"])]
    near, far = (depth.min() * 0.99, depth.max() * 1.01) if depth.size else (0.1, 1.0)
    height, width = found["depth"].shape[:2]
    found |= {n: read_intermediate(frame, n) for n in intermediates(frame) if n not in _READERS}
    camera = frame.camera
    if camera.orthographic and far - near < 1e-6:
        far = near + 1.0
    found["view_from_world"] = camera.view_from_world()
    found["clip_from_view"] = camera.clip_from_view(width / height, float(near), float(far))
    return found


def _texture(frame: Frame, name: str) -> NDArray:
    """A texture at the picture's size: of a supersampled one, one sample of each pixel."""
    array = frame.gpu.read_texture(frame.resources[name])
    return array[frame.scale // 2 :: frame.scale, frame.scale // 2 :: frame.scale]


def _depth(frame: Frame) -> NDArray[np.float32]:
    depth = _texture(frame, "surface")[..., 3]
    return np.where(depth > 0, depth, np.float32(np.inf))


def _normal(frame: Frame) -> NDArray[np.float32]:
    # scene space is the world moved: directions are the same
    return _texture(frame, "surface")[..., :3].copy()


def _color(frame: Frame) -> NDArray[np.float32]:
    return _texture(frame, "albedo")[..., :3].astype(np.float32)


def _id(channel: int) -> Callable[[Frame], NDArray]:
    return lambda frame: _texture(frame, "ids")[..., channel].astype(np.int64).astype(np.int32)


def _position(frame: Frame) -> NDArray[np.float32]:
    """From depth through the camera, in double precision: large coordinates lose nothing."""
    depth = _depth(frame).astype(np.float64)
    height, width = depth.shape
    half = frame.camera.half_height()
    # where in its pixel the sample lies
    at = (frame.scale // 2 + 0.5) / frame.scale
    x = ((np.arange(width) + at) / width * 2 - 1) * half * width / height
    y = (1 - (np.arange(height) + at) / height * 2) * half
    scale = np.ones_like(depth) if frame.camera.orthographic else depth
    empty = ~np.isfinite(depth)
    depth[empty] = scale[empty] = np.nan
    view = np.stack([x[None, :] * scale, y[:, None] * scale, -depth, np.ones_like(depth)], axis=-1)
    world = view @ np.linalg.inv(frame.camera.view_from_world()).T
    return world[..., :3].astype(np.float32)


def _volume_opacity(frame: Frame) -> NDArray[np.float32]:
    return _texture(frame, "volume_color")[..., 3].astype(np.float32)


def _volume_depth(frame: Frame) -> NDArray[np.float32]:
    depth = _texture(frame, "volume_depth")
    return np.where(depth > 0, depth, np.float32(np.inf))


def _scalar(name: str) -> Callable[[Frame], NDArray]:
    def read(frame: Frame) -> NDArray[np.float32]:
        values = _texture(frame, name).astype(np.float32)
        return values if values.ndim == 2 else values.mean(axis=0)  # over layers

    return read


def _linear(frame: Frame) -> NDArray[np.float32]:
    from scuro.passes.post.fxaa import smoothed_color
    from scuro.style.paint import premultiplied

    over = frame.gpu.read_texture(smoothed_color(frame)).astype(np.float32)
    under = np.array(premultiplied(frame.settings.background), np.float32)
    return over + under * (1 - over[..., 3:])


_READERS: dict[str, Callable[[Frame], NDArray]] = {
    "position": _position,
    "normal": _normal,
    "color": _color,
    "depth": _depth,
    "atom": _id(0),
    "instance": _id(1),
    "object": _id(2),
    "visibility": _scalar("visibility"),
    "shadow": _scalar("shadow"),
    "volume_opacity": _volume_opacity,
    "volume_depth": _volume_depth,
    "linear": _linear,
}
