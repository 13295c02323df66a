"""Pictures as files: PNG and TIFF for eyes, OpenEXR for compositing, npz for programs.

A picture is held as *premultiplied linear light* (h, w, 4) when it is composed; PNG and TIFF carry
sRGB-encoded colour with straight alpha, OpenEXR the premultiplied linear values as they are.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from scuro.errors import MissingExtraError, SettingsError
from scuro.export.files import replacing
from scuro.export.png import PngWriter, quantised

_EXR_LAYERS = {
    "depth": ("depth.Z",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "atom": ("ids.atom",),
    "instance": ("ids.instance",),
    "object": ("ids.object",),
    "visibility": ("occlusion.visibility",),
    "shadow": ("shadow.lit",),
}
"""Channel names of a buffer: ``layer.channel``, as compositors list them."""


def encoded_srgb(linear: NDArray) -> NDArray[np.float32]:
    """sRGB transfer function (IEC 61966-2-1) of linear light."""
    linear = np.clip(linear, 0, None).astype(np.float32, copy=False)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def straight(premultiplied: NDArray) -> NDArray[np.float32]:
    """Linear RGB divided by alpha (h, w, 4); colour is 0 where nothing covers the pixel."""
    alpha = premultiplied[..., 3:]
    rgb = np.divide(
        premultiplied[..., :3], alpha, out=np.zeros_like(premultiplied[..., :3]), where=alpha > 0
    )
    return np.concatenate([rgb, alpha], axis=-1)


def display(premultiplied: NDArray) -> NDArray[np.float32]:
    """What a PNG holds: sRGB-encoded colour and straight alpha, (h, w, 4), from linear light.

    Dividing by alpha comes before the transfer function: the other way round darkens edges.
    """
    rgba = straight(premultiplied)
    return np.concatenate([encoded_srgb(rgba[..., :3]), rgba[..., 3:]], axis=-1)


@dataclass(frozen=True, eq=False)
class Picture:
    """A finished picture on its way into a file."""

    pixels: NDArray[np.uint8]
    """(h, w, 4) sRGB-encoded colour and straight alpha."""
    linear: Callable[[], NDArray]
    """Gives the picture as premultiplied linear light (h, w, 4), for more than 8 bits."""
    buffers: Callable[[], Mapping[str, NDArray]] = dict
    """Gives what becomes layers of OpenEXR; see :data:`_EXR_LAYERS` for the names."""
    settings: Mapping[str, Any] | None = None
    """What the picture was made with; written into the file where it can hold it."""
    bits: int = 8
    """8 or 16 per channel (PNG and TIFF)."""
    dpi: float | None = None
    """Resolution stated in the file, pixels per inch."""

    def encoded(self) -> NDArray:
        """sRGB-encoded values as unsigned integers of ``bits``; RGB if opaque, else RGBA."""
        values = self.pixels if self.bits == 8 else quantised(display(self.linear()), self.bits)
        opaque = bool((values[..., 3] == np.iinfo(values.dtype).max).all())
        return np.ascontiguousarray(values[..., :3]) if opaque else values


def save_picture(path: str | PathLike[str], picture: Picture) -> None:
    """Write a picture in the format that the file name's ending says.

    Args:
        path: ``.png``, ``.tif``/``.tiff``, ``.exr``, ``.jpg``/``.jpeg`` or ``.webp``.
        picture: What to write.

    Raises:
        SettingsError: No such format.
        SaveError: The file cannot be written; nothing is left half-written.
    """
    writer = format_writer(path)
    if picture.bits not in (8, 16):
        raise SettingsError(f"a picture has 8 or 16 bits a channel, not {picture.bits}")
    with replacing(path) as file:
        writer(file, picture)


def format_writer(path: str | PathLike[str]) -> Callable[[BinaryIO, Picture], None]:
    """The writer for a file name's ending; :class:`SettingsError` if there is none."""
    suffix = Path(path).suffix.lower()
    if suffix not in _WRITERS:
        raise SettingsError(
            f"{path}: no picture format '{suffix or 'without ending'}': "
            f"known: {', '.join(sorted(_WRITERS))}"
        )
    return _WRITERS[suffix]


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


def _png(file: BinaryIO, picture: Picture) -> None:
    pixels = picture.encoded()
    size = (pixels.shape[1], pixels.shape[0])
    writer = PngWriter(
        file,
        size,
        pixels.shape[2],
        bits=picture.bits,
        dpi=picture.dpi,
        settings=picture.settings,
    )
    writer.write_rows(pixels)
    writer.finish()


def _tiff(file: BinaryIO, picture: Picture) -> None:
    try:
        import tifffile
    except ImportError:
        raise MissingExtraError("TIFF pictures", "export") from None
    pixels = picture.encoded()
    dpi = picture.dpi
    tifffile.imwrite(
        file,
        pixels,
        photometric="rgb",
        compression="zlib",
        extrasamples=["unassalpha"] if pixels.shape[2] == 4 else None,
        resolution=(dpi, dpi) if dpi else None,
        resolutionunit="inch" if dpi else None,
        software="scuro",
        description=None if picture.settings is None else json.dumps(picture.settings),
        metadata=None,
    )


def _exr(file: BinaryIO, picture: Picture) -> None:
    try:
        import OpenEXR
    except ImportError:
        raise MissingExtraError("OpenEXR pictures", "export") from None
    planes = np.moveaxis(picture.linear().astype(np.float16), -1, 0)
    channels = dict(zip("RGBA", planes, strict=True))
    for name, buffer in picture.buffers().items():
        planes = buffer[None] if buffer.ndim == 2 else np.moveaxis(buffer, -1, 0)
        channels.update(zip(_EXR_LAYERS.get(name, ()), map(_exr_plane, planes), strict=False))
    header: dict[str, Any] = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "scuro_ids": "number + 1; 0 where nothing is",
    }
    if picture.settings is not None:
        header["scuro"] = json.dumps(picture.settings)
    if picture.dpi is not None:
        header["xDensity"] = float(picture.dpi)
    channels = {name: np.ascontiguousarray(plane) for name, plane in channels.items()}
    try:
        # the library writes to a path only: the file beside is complete when it returns
        with OpenEXR.File(header, channels) as written:
            written.write(str(file.name))
    except RuntimeError as error:
        raise OSError(f"OpenEXR says {error}") from None


def _exr_plane(plane: NDArray) -> NDArray:
    """Ids as unsigned integers counted from 1 (0 is the background); the rest as floats."""
    if plane.dtype.kind in "iu":
        return (plane.astype(np.int64) + 1).astype(np.uint32)
    return plane.astype(np.float32)


def _jpeg(file: BinaryIO, picture: Picture) -> None:
    from PIL import Image

    pixels = picture.pixels
    if pixels[..., 3].min() < 255:  # no alpha in JPEG: lay the picture over white paper
        linear = picture.linear()
        pixels = quantised(encoded_srgb(linear[..., :3] + (1 - linear[..., 3:])), 8)
    extra = {"dpi": (picture.dpi, picture.dpi)} if picture.dpi else {}
    Image.fromarray(np.ascontiguousarray(pixels[..., :3])).save(
        file, "JPEG", quality=95, subsampling=0, **extra
    )


def _webp(file: BinaryIO, picture: Picture) -> None:
    from PIL import Image

    Image.fromarray(picture.encoded()).save(file, "WEBP", lossless=True)


_WRITERS: dict[str, Callable[[BinaryIO, Picture], None]] = {
    ".png": _png,
    ".tif": _tiff,
    ".tiff": _tiff,
    ".exr": _exr,
    ".jpg": _jpeg,
    ".jpeg": _jpeg,
    ".webp": _webp,
}
