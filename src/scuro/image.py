"""A finished picture: a numpy array, a PIL image, and the buffers behind it."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import PIL.Image

    from scuro.passes.frame import Frame


class Image:
    """RGBA pixels, 8 bits, straight alpha; shows itself in a notebook.

    Args:
        pixels: (height, width, 4) uint8.
        frame: The frame it came from, for its buffers.
    """

    def __init__(self, pixels: NDArray[np.uint8], frame: Frame | None = None) -> None:
        self.pixels = pixels
        self._frame = frame

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray:
        return np.array(self.pixels, dtype=dtype, copy=copy)

    @property
    def pil(self) -> PIL.Image.Image:
        """As a Pillow image: RGB if it is opaque everywhere, else RGBA."""
        from PIL import Image as pillow

        if (self.pixels[..., 3] == 255).all():
            return pillow.fromarray(np.ascontiguousarray(self.pixels[..., :3]))
        return pillow.fromarray(self.pixels)

    def _repr_png_(self) -> bytes:
        out = io.BytesIO()
        self.pil.save(out, "PNG")
        return out.getvalue()
