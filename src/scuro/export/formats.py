"""Picture formats: each writes a picture from top to bottom, some rows at a time.

A format says which arrays it needs; whoever has the picture gives them in bands of full width, so
that a print drawn in parts is never in memory as a whole.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scuro.errors import MissingExtraError, SettingsError
from scuro.export.png import PngWriter, quantised

Band = Mapping[str, NDArray]
"""Some rows of a picture: arrays (rows, width[, channels]) by name.

``pixels`` are 8-bit sRGB-encoded colour and straight alpha, ``linear`` is premultiplied linear
light; the others are named as in :func:`scuro.export.buffers.read_buffer`.
"""

_LAYERS = {
    "depth": ("depth.Z",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "atom": ("ids.atom",),
    "instance": ("ids.instance",),
    "object": ("ids.object",),
    "visibility": ("occlusion.visibility",),
    "shadow": ("shadow.lit",),
}
"""OpenEXR's channel names of a buffer: ``layer.channel``, as compositors list them."""
_STRIP_ROWS = 64
"""Rows of a TIFF that are compressed together."""


@dataclass(frozen=True)
class Header:
    """What a file says about its picture before the first row."""

    size: tuple[int, int]
    """Width and height, pixels."""
    opaque: bool
    """No alpha is written."""
    bits: int = 8
    """8 or 16 per channel (PNG and TIFF)."""
    dpi: float | None = None
    """Resolution, pixels per inch."""
    settings: Mapping[str, Any] | None = None
    """What the picture was made with; written where the format can hold it."""
    buffers: tuple[str, ...] = ()
    """Names of the buffers that there are."""

    @property
    def channels(self) -> int:
        """Of a picture for eyes."""
        return 3 if self.opaque else 4

    def encoded(self, band: Band) -> NDArray:
        """sRGB-encoded values as unsigned integers of ``bits``, RGB if opaque, else RGBA."""
        if self.bits == 8:
            return np.ascontiguousarray(band["pixels"][..., : self.channels])
        linear = band["linear"]
        values = np.empty((*linear.shape[:2], self.channels), np.uint16)
        for top in range(0, len(linear), _STRIP_ROWS):  # not many floats at a time
            rows = slice(top, top + _STRIP_ROWS)
            values[rows] = quantised(display(linear[rows]), 16)[..., : self.channels]
        return values


class Format(NamedTuple):
    """How pictures are written in one format."""

    write: Callable[[BinaryIO, Header, Iterable[Band]], None]
    """Given an open file, what the file says, and bands from top to bottom."""
    needs: Callable[[Header], tuple[str, ...]]
    """Names of the arrays that each band must hold."""
    pixel_bytes: int
    """Largest size of what a band holds of a pixel."""


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


def format_of(path: str | PathLike[str]) -> Format:
    """The format that a file name's ending says; :class:`SettingsError` if there is none."""
    suffix = Path(path).suffix.lower()
    if suffix not in _FORMATS:
        raise SettingsError(
            f"{path}: no picture format '{suffix or 'without ending'}': "
            f"known: {', '.join(sorted(_FORMATS))}"
        )
    return _FORMATS[suffix]


def _for_eyes(header: Header) -> tuple[str, ...]:
    return ("pixels",) if header.bits == 8 else ("linear",)


def _png(file: BinaryIO, header: Header, bands: Iterable[Band]) -> None:
    writer = PngWriter(
        file,
        header.size,
        header.channels,
        bits=header.bits,
        dpi=header.dpi,
        settings=header.settings,
    )
    for band in bands:
        writer.write_rows(header.encoded(band))
    writer.finish()


def _tiff(file: BinaryIO, header: Header, bands: Iterable[Band]) -> None:
    try:
        import tifffile
    except ImportError:
        raise MissingExtraError("TIFF pictures", "export") from None
    width, height = header.size
    tifffile.imwrite(
        file,
        _strips(header.encoded(band) for band in bands),
        shape=(height, width, header.channels),
        dtype=np.uint8 if header.bits == 8 else np.uint16,
        rowsperstrip=_STRIP_ROWS,
        byteorder="<",
        photometric="rgb",
        compression="zlib",
        predictor=True,
        extrasamples=None if header.opaque else ["unassalpha"],
        resolution=(header.dpi, header.dpi) if header.dpi else None,
        resolutionunit="inch" if header.dpi else None,
        software="scuro",
        description=None if header.settings is None else json.dumps(header.settings),
        metadata=None,
    )


def _strips(bands: Iterable[NDArray]) -> Iterator[bytes]:
    """The same rows, :data:`_STRIP_ROWS` at a time, each less its left neighbour, compressed."""
    waiting: list[NDArray] = []

    def packed(rows: NDArray) -> bytes:
        rows = rows.astype(rows.dtype.newbyteorder("<"))
        rows[:, 1:] -= rows[:, :-1].copy()
        return zlib.compress(rows.tobytes(), 6)

    for band in bands:
        rows = np.concatenate([*waiting, band]) if waiting else band
        whole = len(rows) // _STRIP_ROWS * _STRIP_ROWS
        for top in range(0, whole, _STRIP_ROWS):
            yield packed(rows[top : top + _STRIP_ROWS])
        waiting = [rows[whole:].copy()] if whole < len(rows) else []
    yield from map(packed, waiting)


def _exr(file: BinaryIO, header: Header, bands: Iterable[Band]) -> None:
    try:
        import Imath
        import OpenEXR
    except ImportError:
        raise MissingExtraError("OpenEXR pictures", "export") from None
    about = OpenEXR.Header(*header.size)
    kinds = {"e": OpenEXR.HALF, "f": OpenEXR.FLOAT, "I": OpenEXR.UINT}
    about["compression"] = Imath.Compression(Imath.Compression.ZIP_COMPRESSION)
    about["scuro_ids"] = b"number + 1; 0 where nothing is"
    if header.settings is not None:
        about["scuro"] = json.dumps(header.settings).encode()
    if header.dpi is not None:
        about["xDensity"] = float(header.dpi)
    written = None
    try:
        for band in bands:
            planes = dict(_exr_planes(band))
            if written is None:
                about["channels"] = {
                    name: Imath.Channel(Imath.PixelType(kinds[plane.dtype.char]))
                    for name, plane in planes.items()
                }
                # the newer interface takes whole pictures only; this one writes to a path, and the
                # file beside is complete when it is closed
                written = OpenEXR.OutputFile(str(file.name), about)
            rows = len(band["linear"])
            written.writePixels({name: plane.tobytes() for name, plane in planes.items()}, rows)
    except (RuntimeError, TypeError) as error:
        raise OSError(f"OpenEXR says {error}") from None
    finally:
        if written is not None:
            written.close()


def _exr_needs(header: Header) -> tuple[str, ...]:
    return ("linear", *(name for name in header.buffers if name in _LAYERS))


def _exr_planes(band: Band) -> Iterator[tuple[str, NDArray]]:
    """Channels by name: light as halves, ids counted from 1 (0 is the background), other floats."""
    for name, plane in zip("RGBA", np.moveaxis(band["linear"], -1, 0), strict=True):
        yield name, plane.astype(np.float16)
    for buffer, names in _LAYERS.items():
        if buffer not in band:
            continue
        array = band[buffer]
        planes = array[None] if array.ndim == 2 else np.moveaxis(array, -1, 0)
        for name, plane in zip(names, planes, strict=True):
            if plane.dtype.kind in "iu":
                yield name, (plane.astype(np.int64) + 1).astype(np.uint32)
            else:
                yield name, plane.astype(np.float32)


def _jpeg(file: BinaryIO, header: Header, bands: Iterable[Band]) -> None:
    from PIL import Image

    def on_paper(band: Band) -> NDArray[np.uint8]:
        if header.opaque:
            return band["pixels"][..., :3]
        linear = band["linear"]  # no alpha in JPEG: lay the picture over white paper
        return quantised(encoded_srgb(linear[..., :3] + (1 - linear[..., 3:])), 8)

    extra = {"dpi": (header.dpi, header.dpi)} if header.dpi else {}
    pixels = np.concatenate([on_paper(band) for band in bands])
    Image.fromarray(pixels).save(file, "JPEG", quality=95, subsampling=0, **extra)


def _webp(file: BinaryIO, header: Header, bands: Iterable[Band]) -> None:
    from PIL import Image

    pixels = np.concatenate([band["pixels"][..., : header.channels] for band in bands])
    Image.fromarray(pixels).save(file, "WEBP", lossless=True)


_MOST_PIXELS = {".jpg": 65_535, ".jpeg": 65_535, ".webp": 16_383}
"""Longest edge that a format can hold."""
_FORMATS = {
    ".png": Format(_png, _for_eyes, 16),
    ".tif": Format(_tiff, _for_eyes, 16),
    ".tiff": Format(_tiff, _for_eyes, 16),
    ".exr": Format(_exr, _exr_needs, 52),
    ".jpg": Format(_jpeg, lambda header: ("pixels",) if header.opaque else ("linear",), 16),
    ".jpeg": Format(_jpeg, lambda header: ("pixels",) if header.opaque else ("linear",), 16),
    ".webp": Format(_webp, lambda header: ("pixels",), 4),
}


def check_format(path: str | PathLike[str], size: tuple[int, int], bits: int = 8) -> None:
    """Raise :class:`SettingsError` where a file could not hold such a picture."""
    format_of(path)
    if bits not in (8, 16):
        raise SettingsError(f"a picture has 8 or 16 bits a channel, not {bits}")
    suffix = Path(path).suffix.lower()
    if bits == 16 and suffix in _MOST_PIXELS:
        raise SettingsError(f"{path}: {suffix[1:]} holds 8 bits a channel: use .png, .tif or .exr")
    most = _MOST_PIXELS.get(suffix, 1 << 30)
    if max(size) > most:
        raise SettingsError(
            f"{path}: {suffix[1:]} holds at most {most} pixels a side: use .png, .tif or .exr"
        )
