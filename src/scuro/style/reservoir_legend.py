"""A reservoir's legend: colours and opacity over the histogram, units, date and exaggeration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.reservoir import ReservoirItem
from scuro.style.reservoir import item_transfer, property_range

if TYPE_CHECKING:
    from PIL import ImageDraw

BINS = 48
_INK, _BAR, _PANEL, _CURVE = (30, 30, 34), (196, 198, 204), (255, 255, 255, 225), (60, 60, 66)
_SMALLEST = 9
"""Text is no smaller than so many pixels."""


def with_legend(pixels: NDArray[np.uint8], item: ReservoirItem) -> NDArray[np.uint8]:
    """The picture with the item's legend in its lower left corner.

    Args:
        pixels: (height, width, 4).
        item: What the picture shows.
    """
    from PIL import Image, ImageDraw, ImageFont

    picture = Image.fromarray(pixels, "RGBA")
    height, width = pixels.shape[:2]
    size = max(_SMALLEST, height // 45)
    font = ImageFont.load_default(size)
    margin = size
    box_width = min(max(18 * size, width // 4), width - 2 * margin)
    plot, bar = 4 * size, size
    lines = legend_lines(item)
    box_height = plot + bar + int(1.35 * size * (len(lines) + 1)) + 3 * margin
    left, top = margin, height - margin - box_height
    overlay = Image.new("RGBA", picture.size, (0, 0, 0, 0))
    draw = ImageDraw.Draw(overlay)
    draw.rectangle((left, top, left + box_width, top + box_height), fill=_PANEL)
    x0, x1 = left + margin, left + box_width - margin
    y = top + margin
    for line in lines:
        draw.text((x0, y), line, fill=_INK, font=font)
        y += int(1.35 * size)
    low, high = property_range(item.grid, item.shown_property)
    _plot(draw, item, (x0, y, x1, y + plot), low, high)
    y += plot
    colors = np.rint(item_transfer(item).color(np.linspace(low, high, x1 - x0)) * 255).astype(int)
    for n, color in enumerate(colors):
        draw.line((x0 + n, y, x0 + n, y + bar), fill=tuple(color.tolist()))
    y += bar + size // 3
    draw.text((x0, y), f"{low:.4g}", fill=_INK, font=font)
    draw.text((x1, y), f"{high:.4g}", fill=_INK, font=font, anchor="ra")
    return np.asarray(Image.alpha_composite(picture, overlay))


def legend_lines(item: ReservoirItem) -> list[str]:
    """What the legend says: property and unit, model and date, exaggeration."""
    grid, name = item.grid, item.shown_property
    unit = grid.property_unit(name)
    first = f"{name} ({unit})" if unit else name
    second = grid.name
    if grid.changes(name) and grid.steps:
        second = f"{second}, {grid.steps[grid.step_index(item.settings.time)]}"
    lines = [first, second]
    if item.exaggeration != 1:
        lines.append(f"heights x {item.exaggeration:g}")
    # the font has no superscripts
    return [line.replace("³", "3") for line in lines]


def _plot(
    draw: ImageDraw.ImageDraw, item: ReservoirItem, box: tuple[int, int, int, int], low: float,
    high: float,
) -> None:  # fmt: skip
    """The histogram as bars, the opacity as a curve; both to the box's full height."""
    x0, y0, x1, y1 = box
    values: Any = item.values()
    counts = np.histogram(values[np.isfinite(values)], bins=BINS, range=(low, high))[0]
    # square roots, so that one tall bin does not flatten all others
    tall = np.sqrt(counts / max(int(counts.max(initial=1)), 1))
    edges = np.linspace(x0, x1, BINS + 1)
    for n, share in enumerate(tall):
        if share > 0:
            draw.rectangle((edges[n], y1 - share * (y1 - y0), edges[n + 1], y1), fill=_BAR)
    if item.show == "volume":
        opacity = item_transfer(item).opacity(np.linspace(low, high, x1 - x0))
        top = max(float(opacity.max()), 1e-6)
        curve = [(x0 + n, y1 - a / top * (y1 - y0)) for n, a in enumerate(opacity)]
        draw.line(curve, fill=_CURVE, width=max(1, (y1 - y0) // 40))
