"""Pictures as files: PNG and TIFF for eyes, OpenEXR for compositing, npz for programs.

A picture is held as *premultiplied linear light* (h, w, 4) when it is composed; PNG and TIFF carry
sRGB-encoded colour with straight alpha, OpenEXR the premultiplied linear values as they are.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
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


def save_picture(
    path: str | PathLike[str],
    linear: NDArray,
    *,
    buffers: Mapping[str, NDArray] | None = None,
    settings: Mapping[str, Any] | None = None,
    bits: int = 8,
    dpi: float | None = None,
) -> None:
    """Write a picture in the format that the file name's ending says.

    Args:
        path: ``.png``, ``.tif``/``.tiff``, ``.exr``, ``.jpg``/``.jpeg`` or ``.webp``.
        linear: (h, w, 4) premultiplied linear light.
        buffers: For OpenEXR, what becomes layers: see :data:`_EXR_LAYERS` for the names.
        settings: What the picture was made with; written into the file where it can hold it.
        bits: 8 or 16 per channel (PNG and TIFF).
        dpi: Resolution stated in the file, pixels per inch.

    Raises:
        SettingsError: No such format.
        SaveError: The file cannot be written; nothing is left half-written.
    """
    writer = format_writer(path)
    if bits not in (8, 16):
        raise SettingsError(f"a picture has 8 or 16 bits a channel, not {bits}")
    with replacing(path) as file:
        writer(file, linear, buffers or {}, settings, bits, dpi)


def format_writer(path: str | PathLike[str]) -> Callable[..., None]:
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


def _opaque(rgba: NDArray) -> NDArray:
    """Without the alpha channel where it says nothing."""
    return rgba[..., :3] if np.all(rgba[..., 3] >= 1 - 1e-3) else rgba


def _png(
    file: BinaryIO,
    linear: NDArray,
    buffers: Mapping[str, NDArray],
    settings: Mapping[str, Any] | None,
    bits: int,
    dpi: float | None,
) -> None:
    pixels = _opaque(display(linear))
    size = (pixels.shape[1], pixels.shape[0])
    writer = PngWriter(file, size, pixels.shape[2], bits=bits, dpi=dpi, settings=settings)
    writer.write_rows(pixels)
    writer.finish()


def _tiff(
    file: BinaryIO,
    linear: NDArray,
    buffers: Mapping[str, NDArray],
    settings: Mapping[str, Any] | None,
    bits: int,
    dpi: float | None,
) -> None:
    try:
        import tifffile
    except ImportError:
        raise MissingExtraError("TIFF pictures", "export") from None
    pixels = quantised(_opaque(display(linear)), bits)
    tifffile.imwrite(
        file,
        np.ascontiguousarray(pixels),
        photometric="rgb",
        compression="zlib",
        extrasamples=["unassalpha"] if pixels.shape[2] == 4 else None,
        resolution=(dpi, dpi) if dpi else None,
        resolutionunit="inch" if dpi else None,
        software="scuro",
        description=json.dumps(settings) if settings is not None else None,
        metadata=None,
    )


def _exr(
    file: BinaryIO,
    linear: NDArray,
    buffers: Mapping[str, NDArray],
    settings: Mapping[str, Any] | None,
    bits: int,
    dpi: float | None,
) -> None:
    try:
        import OpenEXR
    except ImportError:
        raise MissingExtraError("OpenEXR pictures", "export") from None
    channels = dict(zip("RGBA", np.moveaxis(linear.astype(np.float16), -1, 0), strict=True))
    for name, buffer in buffers.items():
        names = _EXR_LAYERS.get(name, ())
        planes = buffer[None] if buffer.ndim == 2 else np.moveaxis(buffer, -1, 0)
        channels.update(zip(names, map(_exr_plane, planes), strict=False))
    header: dict[str, Any] = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "scuro_ids": "number + 1; 0 where nothing is",
    }
    if settings is not None:
        header["scuro"] = json.dumps(settings)
    if dpi is not None:
        header["xDensity"] = float(dpi)
    channels = {name: np.ascontiguousarray(plane) for name, plane in channels.items()}
    try:
        # the library writes to a path only: the file beside is complete when it returns
        with OpenEXR.File(header, channels) as picture:
            picture.write(str(file.name))
    except RuntimeError as error:
        raise OSError(f"OpenEXR says {error}") from None


def _exr_plane(plane: NDArray) -> NDArray:
    """Ids as unsigned integers counted from 1 (0 is the background); the rest as floats."""
    if plane.dtype.kind in "iu":
        return (plane.astype(np.int64) + 1).astype(np.uint32)
    return plane.astype(np.float32)


def _with_pillow(format: str, **options: Any) -> Callable[..., None]:
    """A writer of 8-bit pictures without room for settings."""

    def write(
        file: BinaryIO,
        linear: NDArray,
        buffers: Mapping[str, NDArray],
        settings: Mapping[str, Any] | None,
        bits: int,
        dpi: float | None,
    ) -> None:
        from PIL import Image

        if format == "JPEG":  # no alpha: lay the picture over white paper
            linear = linear + (1 - linear[..., 3:])
        pixels = _opaque(display(linear))
        extra = {"dpi": (dpi, dpi)} if dpi and format == "JPEG" else {}
        picture = Image.fromarray(quantised(np.ascontiguousarray(pixels), 8))
        picture.save(file, format, **options, **extra)

    return write


_WRITERS: dict[str, Callable[..., None]] = {
    ".png": _png,
    ".tif": _tiff,
    ".tiff": _tiff,
    ".exr": _exr,
    ".jpg": _with_pillow("JPEG", quality=95, subsampling=0),
    ".jpeg": _with_pillow("JPEG", quality=95, subsampling=0),
    ".webp": _with_pillow("WEBP", lossless=True),
}
