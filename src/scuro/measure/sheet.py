"""A contact sheet: several pictures side by side under their names."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.errors import SettingsError

if TYPE_CHECKING:
    from PIL.Image import Image

_GAP = 12
_INK, _GREY, _PAPER = (25, 25, 25), (110, 110, 110), (255, 255, 255)


def contact_sheet(
    pictures: Mapping[str, ArrayLike],
    notes: Mapping[str, str] | None = None,
    *,
    columns: int | None = None,
    width: int = 480,
) -> Image:
    """Lay pictures of one shape out in a grid, each over its name and a line of notes.

    Args:
        pictures: By name: (h, w), (h, w, 3) or (h, w, 4) arrays, floats from 0 to 1 or uint8.
        notes: A second, smaller line for some of the names.
        columns: Pictures in a row; by default as square as their number allows.
        width: Width of one picture on the sheet, pixels; larger ones are scaled down to it.
    """
    from PIL import Image, ImageDraw, ImageFont

    if not pictures:
        raise SettingsError("a contact sheet needs at least one picture")
    thumbs = {name: _thumb(picture, width) for name, picture in pictures.items()}
    columns = columns or math.ceil(math.sqrt(len(thumbs)))
    rows = math.ceil(len(thumbs) / columns)
    cell_w = max(t.width for t in thumbs.values())
    cell_h = max(t.height for t in thumbs.values())
    size = max(12, cell_w // 24)
    title, small = ImageFont.load_default(size), ImageFont.load_default(max(10, size * 3 // 4))
    foot = round(size * 1.4) + (round(size * 1.2) if notes else 0)
    sheet = Image.new(
        "RGB",
        (columns * (cell_w + _GAP) + _GAP, rows * (cell_h + foot + _GAP) + _GAP),
        _PAPER,
    )
    draw = ImageDraw.Draw(sheet)
    for i, (name, thumb) in enumerate(thumbs.items()):
        x = _GAP + i % columns * (cell_w + _GAP)
        y = _GAP + i // columns * (cell_h + foot + _GAP)
        sheet.paste(thumb, (x, y), thumb if thumb.mode == "RGBA" else None)
        draw.text((x, y + cell_h + 2), name, _INK, title)
        if notes and name in notes:
            draw.text((x, y + cell_h + 2 + round(size * 1.3)), notes[name], _GREY, small)
    return sheet


def difference_picture(difference: NDArray, most: float) -> NDArray[np.uint8]:
    """A map of differences, black for none to pale yellow for ``most`` and more: (h, w, 3)."""
    import cmap

    colors = np.asarray(cmap.Colormap("matplotlib:inferno")(np.linspace(0, 1, 256)))[:, :3]
    index = np.clip(np.asarray(difference) / most * 255, 0, 255).astype(int)
    return (colors * 255 + 0.5).astype(np.uint8)[index]


def _thumb(picture: ArrayLike, width: int) -> Image:
    from PIL import Image

    array = np.asarray(picture)
    if array.dtype != np.uint8:
        array = (np.clip(np.nan_to_num(array), 0, 1) * 255 + 0.5).astype(np.uint8)
    image = Image.fromarray(array)
    if image.mode == "L":
        image = image.convert("RGB")
    if image.width > width:
        height = max(1, round(image.height * width / image.width))
        image = image.resize((width, height), Image.Resampling.LANCZOS)
    return image
