"""Pictures larger than a GPU can draw at once: drawn in parts, written row by row."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.export.buffers import available, read_buffer
from scuro.export.files import replacing
from scuro.export.formats import Band, Header, check_format, format_of
from scuro.passes.frame import Frame
from scuro.render import Renderer
from scuro.render_marks import picture_marks
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene
from scuro.style.marks import Mark, paint, paint_linear
from scuro.style.paint import linear_rgba

_BAND_BYTES = 192 << 20
"""Most memory for the rows that wait to be written."""


def save_in_parts(
    path: str | PathLike[str],
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    *,
    bits: int = 8,
    note: Mapping[str, Any] | None = None,
    on_part: Callable[[Frame], None] = lambda frame: None,
) -> None:
    """Draw a picture straight into a file; PNG, TIFF and OpenEXR hold no more than a row of parts.

    Args:
        path: Where to.
        renderer: Draws.
        scene: What.
        camera: From where.
        settings: How.
        bits: 8 or 16 per channel.
        note: What to store in the file as the picture's settings.
        on_part: Called after each part with its frame.

    Raises:
        SettingsError: The format cannot hold this picture.
        SaveError: The file cannot be written; nothing is left half-written.
    """
    check_format(path, settings.size, bits)
    format = format_of(path)
    opaque = linear_rgba(settings.background)[3] == 1
    marks = picture_marks(renderer, scene, camera, settings)
    with replacing(path) as file:
        most = max(_BAND_BYTES // (format.pixel_bytes * settings.size[0]), 1)
        frames = renderer.frames(scene, camera, settings, rows=most)
        first = next(frames)
        header = Header(settings.size, opaque, bits, settings.dpi, note, tuple(available(first[1])))
        needs = format.needs(header)

        def rows() -> Iterator[Band]:
            row: dict[str, NDArray] = {}
            top, ends = 0, -1
            for part, frame in _chained(first, frames):
                if part.rows.stop != ends:
                    if row:
                        yield _marked(row, marks, top)
                    row, top, ends = {}, part.rows.start, part.rows.stop
                for name in needs:
                    drawn = _read(frame, name)[part.inside]
                    if name not in row:
                        shape = (len(drawn), settings.size[0], *drawn.shape[2:])
                        row[name] = np.empty(shape, drawn.dtype)
                    row[name][:, part.columns] = drawn
                on_part(frame)
            yield _marked(row, marks, top)

        format.write(file, header, rows())


def _chained(first: Any, rest: Iterator[Any]) -> Iterator[Any]:
    yield first
    yield from rest


def _marked(row: dict[str, NDArray], marks: Sequence[Mark], top: int) -> Band:
    """Rows with what is written over the picture."""
    for name, draw in (("pixels", paint), ("linear", paint_linear)):
        if name in row:
            row[name] = draw(row[name], marks, top)
    return row


def _read(frame: Frame, name: str) -> NDArray:
    if name == "pixels":
        return frame.gpu.read_texture(frame.resources["picture"])
    return read_buffer(frame, name)
