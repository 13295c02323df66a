"""Pictures larger than a GPU can draw at once: drawn in parts, written row by row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import groupby
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from scuro.errors import SettingsError
from scuro.export.buffers import read_buffer
from scuro.export.files import replacing
from scuro.export.image import display
from scuro.export.png import PngWriter, quantised
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene
from scuro.style.paint import linear_rgba


def save_in_parts(
    path: str | PathLike[str],
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    *,
    bits: int = 8,
    dpi: float | None = None,
    note: Mapping[str, Any] | None = None,
    on_part: Callable[[], None] = lambda: None,
) -> None:
    """Draw a picture straight into a PNG; never more than a row of parts is held in memory.

    Args:
        path: Where to.
        renderer: Draws.
        scene: What.
        camera: From where.
        settings: How.
        bits: 8 or 16 per channel.
        dpi: Resolution to state in the file.
        note: What to store in the file as the picture's settings.
        on_part: Called after each part.

    Raises:
        SettingsError: The name is not a PNG's.
        SaveError: The file cannot be written; nothing is left half-written.
    """
    if Path(path).suffix.lower() != ".png":
        raise SettingsError(
            f"{path}: a picture of {settings.size[0]} x {settings.size[1]} pixels with "
            f"--antialias {settings.antialias.method} is drawn in parts, which only PNG can take"
        )
    width = settings.size[0]
    channels = 3 if linear_rgba(settings.background)[3] == 1 else 4
    kind = np.uint8 if bits == 8 else np.uint16
    with replacing(path) as file:
        writer = PngWriter(file, settings.size, channels, bits=bits, dpi=dpi, settings=note)
        frames = renderer.frames(scene, camera, settings)
        for (top, bottom), row in groupby(frames, lambda f: (f[0].rows.start, f[0].rows.stop)):
            band = np.empty((bottom - top, width, channels), kind)
            for part, frame in row:
                if bits == 8:
                    pixels = renderer.gpu.read_texture(frame.resources["picture"])
                else:
                    pixels = quantised(display(read_buffer(frame, "linear")), bits)
                band[:, part.columns] = pixels[part.inside][..., :channels]
                on_part()
            writer.write_rows(band)
        writer.finish()
