"""PNG, written row by row: 8 or 16 bits, sRGB, resolution and settings in their chunks.

Pillow writes no 16-bit colour and wants the whole picture at once; a print of 16,384² pixels comes
in tiles and must not be held in memory. The format is small (W3C PNG specification, third edition)
and zlib does the work.
"""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, SettingsError

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOR_TYPE = {1: 0, 3: 2, 4: 6}
_UP = 2
"""Filter: each byte less the one above it. One filter for all rows keeps the encoder vectorised."""
_SETTINGS_KEY = "scuro"
_INCH = 0.0254
_MAX_SETTINGS = 16 << 20
"""Bytes of settings accepted on reading, against a file made to fill the memory."""


class PngWriter:
    """Writes one picture into an open binary file, some rows at a time.

    Args:
        file: Where the bytes go; not closed.
        size: Width and height, pixels.
        channels: 1 (grey), 3 (RGB) or 4 (RGB and straight alpha).
        bits: 8 or 16 per channel.
        dpi: Resolution to state, pixels per inch.
        settings: What the picture was made with; stored as JSON in a text chunk named ``scuro``.
    """

    def __init__(
        self,
        file: BinaryIO,
        size: tuple[int, int],
        channels: int,
        *,
        bits: int = 8,
        dpi: float | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        if bits not in (8, 16):
            raise SettingsError(f"a PNG has 8 or 16 bits a channel, not {bits}")
        self._file = file
        self._width, self._height = size
        self._channels = channels
        self._type = np.dtype(">u2" if bits == 16 else "u1")
        self._above = np.zeros(self._width * channels * self._type.itemsize, np.uint8)
        self._written = 0
        self._zlib = zlib.compressobj(level=4, strategy=zlib.Z_FILTERED)
        file.write(_SIGNATURE)
        header = (*size, bits, _COLOR_TYPE[channels], 0, 0, 0)
        self._chunk(b"IHDR", struct.pack(">IIBBBBB", *header))
        self._chunk(b"sRGB", b"\0")
        if dpi is not None:
            per_metre = round(dpi / _INCH)
            self._chunk(b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1))
        if settings is not None:
            text = zlib.compress(json.dumps(settings, ensure_ascii=False).encode())
            self._chunk(b"iTXt", _SETTINGS_KEY.encode() + b"\0\1\0\0\0" + text)

    def write_rows(self, rows: NDArray) -> None:
        """Append rows (k, width[, channels]) of uint8, uint16, or sRGB-encoded floats 0 to 1."""
        values = quantised(rows, 8 * self._type.itemsize).astype(self._type)
        raw = values.reshape(len(rows), -1).view(np.uint8)
        if raw.shape[1] != len(self._above):
            raise ValueError(f"rows of shape {rows.shape} do not fit this picture")
        filtered = np.empty((len(raw), raw.shape[1] + 1), np.uint8)
        filtered[:, 0] = _UP
        filtered[0, 1:] = raw[0] - self._above
        np.subtract(raw[1:], raw[:-1], out=filtered[1:, 1:])
        self._above = raw[-1].copy()
        self._written += len(raw)
        self._data(self._zlib.compress(filtered.tobytes()))

    def finish(self) -> None:
        """Write what is left; all rows must have been given."""
        if self._written != self._height:
            raise ValueError(f"{self._written} of {self._height} rows were written")
        self._data(self._zlib.flush())
        self._chunk(b"IEND", b"")

    def _data(self, content: bytes) -> None:
        if content:
            self._chunk(b"IDAT", content)

    def _chunk(self, kind: bytes, content: bytes) -> None:
        self._file.write(struct.pack(">I", len(content)) + kind + content)
        self._file.write(struct.pack(">I", zlib.crc32(content, zlib.crc32(kind))))


def quantised(values: NDArray, bits: int) -> NDArray:
    """Values as unsigned integers of 8 or 16 bits, from floats 0 to 1 or from either width."""
    top = (1 << bits) - 1
    wanted = np.uint16 if bits == 16 else np.uint8
    if values.dtype == wanted:
        return values
    if values.dtype == np.uint8:
        return values.astype(np.uint16) * 257
    if values.dtype == np.uint16:
        return ((values.astype(np.uint32) + 128) // 257).astype(np.uint8)
    return (np.clip(np.nan_to_num(values), 0, 1) * top + 0.5).astype(wanted)


def is_png(path: str | PathLike[str]) -> bool:
    """Whether the file begins as a PNG does."""
    try:
        with open(path, "rb") as file:
            return file.read(len(_SIGNATURE)) == _SIGNATURE
    except OSError:
        return False


def read_settings(path: str | PathLike[str]) -> dict[str, Any]:
    """The settings that a picture of ours carries.

    Raises:
        LoadError: The file cannot be read, is no PNG, is damaged, or carries no settings.
    """
    try:
        with Path(path).open("rb") as file:
            text = _settings_text(file, path)
    except OSError as error:
        raise LoadError(path, f"cannot be read: {error.strerror or error}") from None
    if text is None:
        raise LoadError(path, "carries no scuro settings: it was made or re-saved elsewhere")
    try:
        found = json.loads(text)
    except ValueError:
        found = None
    if not isinstance(found, dict):
        raise LoadError(path, "its scuro settings are damaged")
    return found


def _settings_text(file: BinaryIO, path: str | PathLike[str]) -> str | None:
    if file.read(len(_SIGNATURE)) != _SIGNATURE:
        raise LoadError(path, "is not a PNG picture")
    while True:
        head = file.read(8)
        if len(head) < 8:
            return None
        length, kind = struct.unpack(">I4s", head)
        if kind in (b"IEND", b"IDAT"):
            return None
        content = file.read(length)
        checksum = file.read(4)
        if len(content) < length or checksum != struct.pack(">I", zlib.crc32(kind + content)):
            raise LoadError(path, "is damaged: a PNG chunk is cut short or changed")
        key, _, rest = content.partition(b"\0")
        if kind == b"iTXt" and key == _SETTINGS_KEY.encode():
            compressed, text = rest[:1] == b"\1", rest[2:].split(b"\0", 2)[-1]
            try:
                if compressed:
                    text = zlib.decompressobj().decompress(text, _MAX_SETTINGS)
                return text.decode()
            except (zlib.error, UnicodeDecodeError):
                raise LoadError(path, "its scuro settings are damaged") from None
