"""Scale bar and axis cross: how long things are, and which way they lie."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from scuro.scene.camera import Camera
from scuro.style.marks import CAPITALS, Color, Line, Mark, Text

if TYPE_CHECKING:
    from scuro.scene.scene import Scene

AXES: tuple[tuple[str, Color], ...] = (
    ("x", (222, 60, 60, 255)),
    ("y", (52, 160, 52, 255)),
    ("z", (64, 110, 226, 255)),
)
"""Names and colours."""
CROSS = 1.9
"""From the middle of the axis cross to its tips, in heights of letters."""
_BAR = 9.0
"""Longest scale bar, in heights of letters."""
_SMALL = 0.14
"""Thickness of the scale bar, in heights of letters."""
_LADDER = {"Å": 1e-10, "nm": 1e-9, "µm": 1e-6, "mm": 1e-3, "m": 1.0, "km": 1e3}
"""Metres."""
_SYMBOLS = {"angstrom": "Å", "um": "µm", "μm": "µm"}
_USUAL = {"Å": ("Å", "nm", "µm", "mm"), "m": ("mm", "m", "km")}
"""Units in which lengths are told where the world's unit is this; else all but ångström."""


def nice_length(most: float, unit: str) -> tuple[float, str]:
    """The longest round length up to ``most``, and its text: 1, 2 or 5 times a power of ten.

    Lengths are told in the unit that suits them: 5 Å, but 2 nm; 200 m, but 2 km. Feet and
    centimetres stay what they are.
    """
    unit = _SYMBOLS.get(unit, unit)
    power = 10.0 ** math.floor(math.log10(most))
    length = next(f * power for f in (5.0, 2.0, 1.0) if f * power <= most * (1 + 1e-9))
    if unit not in _LADDER:
        return length, f"{length:g} {unit}".strip()
    words = _USUAL.get(unit, tuple(_LADDER)[1:])
    shares = [(_LADDER[word] / _LADDER[unit], word) for word in words]
    share, word = next((s for s in reversed(shares) if length >= s[0] * (1 - 1e-9)), shares[0])
    return length, f"{length / share:g} {word}"


def scene_unit(scene: Scene) -> str:
    """Unit of length of the world: ångström of molecules and cell-scale models, else what the
    volume or the grid says."""
    if scene.molecules:
        return "Å"
    for item in scene.items:
        for kind in ("volume", "grid"):
            if hasattr(item, kind):
                return str(getattr(item, kind).unit)
    return "Å"


def scale_bar(
    camera: Camera, unit: str, size: tuple[int, int], text: float, ink: Color, halo: Color
) -> list[Mark]:
    """A bar in the lower right corner; its length is true at the camera's target.

    Args:
        camera: Of the picture.
        unit: Of the world.
        size: Of the picture.
        text: Height of letters.
        ink: Of bar and letters.
        halo: Around them.
    """
    seen = 2 * camera.half_height() * (1.0 if camera.orthographic else camera.distance)
    pixel = seen / size[1]
    length, words = nice_length(min(_BAR * text, 0.4 * size[0]) * pixel, unit)
    right, y = size[0] - 1.2 * text, size[1] - 1.2 * text
    left = right - length / pixel
    thick = max(2.0, _SMALL * text)
    rim = max(1.0, thick / 2)
    ends = ((left, y), (right, y))
    return [
        Line(((left - rim, y), (right + rim, y)), halo, thick + 2 * rim),
        Line(ends, ink, thick),
        Text(words, (left + right) / 2, y - 0.55 * text, text, ink, halo, "m"),
    ]


def axis_cross(camera: Camera, middle: tuple[float, float], text: float, halo: Color) -> list[Mark]:
    """The world's axes as they lie in the picture, the one that points away first.

    Args:
        camera: Of the picture.
        middle: Where they cross.
        text: Height of letters.
        halo: Around the lines.
    """
    rows = camera.view_from_world()[:3, :3]
    marks: list[Mark] = []
    thick = max(2.0, text / 6)
    for axis in np.argsort(rows[2]).tolist():
        name, color = AXES[axis]
        x, y = (float(rows[0, axis]), -float(rows[1, axis]))
        tip = (middle[0] + CROSS * text * x, middle[1] + CROSS * text * y)
        marks.append(Line((middle, tip), halo, thick + max(2.0, text / 8)))
        marks.append(Line((middle, tip), color, thick))
        length = math.hypot(x, y)
        if length > 0.2:  # an axis along the line of sight has no name
            away = (CROSS + 0.75 / max(length, 0.5)) * text
            place = (middle[0] + away * x, middle[1] + away * y + CAPITALS * text / 2.6)
            marks.append(Text(name, *place, text, color, halo, "m"))
    return marks


def inks(background: Sequence[float]) -> tuple[Color, Color]:
    """Colours of letters and of the rim around them that suit a background, linear RGBA."""
    r, g, b, a = (float(v) for v in background)
    light = a * (0.2126 * r + 0.7152 * g + 0.0722 * b) + (1 - a)
    dark_ink, light_ink = (24, 24, 28), (244, 245, 247)
    ink, halo = (dark_ink, (255, 255, 255)) if light > 0.18 else (light_ink, (16, 17, 20))
    return (*ink, 255), (*halo, 205)
