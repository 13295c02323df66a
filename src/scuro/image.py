"""A finished picture: a numpy array, a PIL image, and the buffers behind it."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError

if TYPE_CHECKING:
    import PIL.Image

    from scuro.passes.frame import Frame
    from scuro.settings import SettingsGroup
    from scuro.style.marks import Mark


class Image:
    """RGBA pixels, 8 bits, straight alpha; shows itself in a notebook.

    Args:
        pixels: (height, width, 4) uint8.
        frame: The frame it came from, for its buffers; none if it was drawn in parts.
        settings: What it was made with.
        marks: What was written over it, for formats of more than 8 bits.
    """

    def __init__(
        self,
        pixels: NDArray[np.uint8],
        frame: Frame | None = None,
        settings: SettingsGroup | None = None,
        marks: Sequence[Mark] = (),
    ) -> None:
        self.pixels = pixels
        self._marks = marks
        self._frame = frame
        self._settings = settings

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray:
        return np.array(self.pixels, dtype=dtype, copy=copy)

    @property
    def pil(self) -> PIL.Image.Image:
        """As a Pillow image: RGB if it is opaque everywhere, else RGBA."""
        from PIL import Image as pillow

        if (self.pixels[..., 3] == 255).all():
            return pillow.fromarray(np.ascontiguousarray(self.pixels[..., :3]))
        return pillow.fromarray(self.pixels)

    def buffer(self, name: str) -> NDArray:
        """What is behind the picture: ``depth``, ``normal``, ``atom``, … as an array.

        See :func:`scuro.export.buffers.read_buffer` for names, shapes and units.

        Raises:
            SettingsError: There is no such buffer, or the renderer has since drawn another frame.
        """
        from scuro.export.buffers import read_buffer

        return read_buffer(self._current_frame(), name)

    def buffers(self) -> dict[str, NDArray]:
        """All buffers by name, with the camera's matrices."""
        from scuro.export.buffers import read_buffers

        return read_buffers(self._current_frame())

    def _buffers(self) -> tuple[str, ...]:
        from scuro.export.buffers import available

        return () if self._frame is None else tuple(available(self._frame))

    def _current_frame(self) -> Frame:
        frame = self._frame
        if frame is None:
            raise SettingsError(
                "a picture drawn in parts keeps neither buffers nor more than 8 bits: lower its "
                "size or --antialias, or let 'scuro render' write it"
            )
        if frame.targets.frame is not frame:
            raise SettingsError(
                "the renderer has drawn another frame since: ask for a picture's buffers before"
            )
        return frame

    def save(
        self,
        path: str | PathLike[str],
        *,
        bits: int = 8,
        dpi: float | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        """Write the picture as PNG, TIFF, OpenEXR, JPEG or WebP, by the name's ending.

        Args:
            path: Where to; what was there is replaced only when all is written.
            bits: 8 or 16 per channel (PNG, TIFF).
            dpi: Resolution to state in the file; by default the one in the settings.
            settings: What to note in the file; by default the picture's settings.

        Raises:
            SettingsError: An unknown format.
            SaveError: The file cannot be written.
        """
        from scuro.export.image import Picture, save_picture
        from scuro.render_settings import Settings

        if dpi is None and isinstance(self._settings, Settings):
            dpi = self._settings.dpi
        if settings is None and self._frame is not None:
            from scuro.export.scene_file import SceneFile

            settings = SceneFile(settings=self._frame.settings).as_dict()
        save_picture(
            path,
            Picture(self.pixels, self._marked, self._buffers(), settings, bits, dpi),
        )

    def _marked(self, name: str) -> NDArray:
        """A buffer, or linear light with what is written over it."""
        found = self.buffer(name)
        if name != "linear" or not self._marks:
            return found
        from scuro.style.marks import paint_linear

        return paint_linear(found, self._marks)

    def _repr_png_(self) -> bytes:
        out = io.BytesIO()
        self.pil.save(out, "PNG")
        return out.getvalue()
