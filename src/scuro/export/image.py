"""Finished pictures and what is behind them, into files: whole ones or none."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.export.files import replacing
from scuro.export.formats import Header, check_format, format_of


@dataclass(frozen=True, eq=False)
class Picture:
    """A finished picture on its way into a file."""

    pixels: NDArray[np.uint8]
    """(h, w, 4) sRGB-encoded colour and straight alpha."""
    read: Callable[[str], NDArray]
    """Gives ``linear``, the picture as premultiplied linear light (h, w, 4), and the buffers."""
    buffers: tuple[str, ...] = ()
    """Names of the buffers that there are, which become layers of OpenEXR."""
    settings: Mapping[str, Any] | None = None
    """What the picture was made with; written into the file where it can hold it."""
    bits: int = 8
    """8 or 16 per channel (PNG and TIFF)."""
    dpi: float | None = None
    """Resolution stated in the file, pixels per inch."""


def save_picture(path: str | PathLike[str], picture: Picture) -> None:
    """Write a picture in the format that the file name's ending says.

    Args:
        path: ``.png``, ``.tif``/``.tiff``, ``.exr``, ``.jpg``/``.jpeg`` or ``.webp``.
        picture: What to write.

    Raises:
        SettingsError: No such format, or it cannot hold this picture.
        SaveError: The file cannot be written; nothing is left half-written.
    """
    height, width = picture.pixels.shape[:2]
    check_format(path, (width, height), picture.bits)
    opaque = bool((picture.pixels[..., 3] == 255).all())
    header = Header(
        (width, height), opaque, picture.bits, picture.dpi, picture.settings, picture.buffers
    )
    format = format_of(path)
    band = {
        name: picture.pixels if name == "pixels" else picture.read(name)
        for name in format.needs(header)
    }
    with replacing(path) as file:
        format.write(file, header, (band,))


def save_buffers(path: str | PathLike[str], buffers: Mapping[str, NDArray]) -> None:
    """Write buffers and camera matrices as a compressed ``.npz``.

    Raises:
        SettingsError: The name does not end in ``.npz``.
        SaveError: The file cannot be written.
    """
    if Path(path).suffix.lower() != ".npz":
        raise SettingsError(f"{path}: buffers are written as NumPy's .npz: give such a name")
    with replacing(path) as file:
        np.savez_compressed(file, allow_pickle=False, **buffers)
