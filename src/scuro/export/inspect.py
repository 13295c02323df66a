"""Every texture that the passes of a frame left behind, raw and as a picture to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.export.formats import encoded_srgb
from scuro.gpu.texel import TEXEL
from scuro.settings import unknown

if TYPE_CHECKING:
    from scuro.passes.frame import Frame

_CHANNELS = "xyzw"
_INNER = frozenset({"picture"})
"""What is no intermediate."""


def intermediates(frame: Frame) -> list[str]:
    """Names of the textures that cover the frame's pixels: what its passes wrote, by their names.

    They are those of the shaders' declarations (``regions``, ``gathered``, ``albedo`` …); pages of
    the scene's tables are left out.
    """
    width, height = frame.size
    found = []
    for name, resource in frame.resources.items():
        size = getattr(resource, "size", 0)
        fits = isinstance(size, tuple) and size[0] * height == size[1] * width and size[2] == 1
        if fits and getattr(resource, "format", "") in TEXEL and name not in _INNER:
            found.append(name)
    return sorted(found)


def read_intermediate(frame: Frame, name: str) -> NDArray[Any]:
    """The texture of that name as it is: (h, w) or (h, w, channels), in the frame's own samples.

    ``NAME.y`` is one channel of it: x, y, z or w.

    Raises:
        SettingsError: There is no such texture or channel.
    """
    base, _, channel = name.partition(".")
    known = intermediates(frame)
    if base not in known:
        raise SettingsError(unknown("buffer", base, known))
    array = frame.gpu.read_texture(frame.resources[base])
    if not channel:
        return array
    count = 1 if array.ndim == 2 else array.shape[2]
    if channel not in tuple(_CHANNELS[:count]):
        raise SettingsError(
            f"buffer '{base}' has the channels {', '.join(_CHANNELS[:count])}, not '{channel}'"
        )
    return array if array.ndim == 2 else array[..., _CHANNELS.index(channel)]


def buffer_picture(name: str, array: NDArray[Any]) -> NDArray[np.uint8]:
    """(h, w, 4) opaque sRGB that shows a buffer.

    Whole numbers are names: each has a colour of its own, that of nothing is black. Directions
    (``normal``, ``surface`` and what is made of it) are 0.5 + 0.5 n, black where nothing is. Other
    triples are taken as linear light. Single channels are shown from their least (black) to their
    greatest value, or from 0 to 1 where all lie in between.
    """
    if array.dtype.kind in "ui":
        return _opaque(_named(array if array.ndim == 2 else array[..., 0]))
    finite = array[np.isfinite(array)]
    far = float(finite.max()) if finite.size else 0.0
    values = np.nan_to_num(array.astype(np.float32), posinf=far, neginf=0.0)
    if values.ndim == 3 and values.shape[2] >= 3:
        rgb = values[..., :3]
        if "surface" in name or name == "normal":
            there = (rgb**2).sum(axis=-1, keepdims=True) > 0
            return _opaque(np.rint(255 * np.where(there, 0.5 + 0.5 * rgb, 0).clip(0, 1)))
        return _opaque(np.rint(255 * encoded_srgb(rgb.clip(0, 1))))
    single = values if values.ndim == 2 else values[..., 0]
    low, high = float(single.min()), float(single.max())
    if low >= 0 and high <= 1:
        low, high = 0.0, 1.0
    shade = np.rint(255 * (single - low) / max(high - low, 1e-12))
    return _opaque(np.repeat(shade[..., None], 3, axis=2))


def _opaque(rgb: NDArray[Any]) -> NDArray[np.uint8]:
    alpha = np.full((*rgb.shape[:2], 1), 255, np.uint8)
    return np.concatenate([rgb.astype(np.uint8), alpha], axis=2)


def _named(numbers: NDArray[Any]) -> NDArray[np.uint8]:
    """A colour for each number, of bytes mixed by a multiplicative hash."""
    nothing = numbers == (np.iinfo(numbers.dtype).max if numbers.dtype.kind == "u" else -1)
    mixed = numbers.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    rgb = np.stack([mixed >> np.uint64(shift) & np.uint64(0xBF) for shift in (56, 45, 33)], axis=-1)
    return np.where(nothing[..., None], 0, rgb + np.uint64(64)).astype(np.uint8)
