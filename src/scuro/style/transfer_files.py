"""Transfer functions from files: TOML, ``.tf1d``, ParaView's JSON, 3D Slicer's presets.xml."""

from __future__ import annotations

import colorsys
import itertools
import json
import math
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from scuro.errors import LoadError, SettingsError
from scuro.scene.volume import Volume
from scuro.style.transfer import LARGEST_OPACITY, TransferFunction

SUFFIXES = (".toml", ".tf1d", ".json", ".xml")


def read_transfer(path: str | Path, volume: Volume, preset: str | None = None) -> TransferFunction:
    """Read a transfer function and fit its values to a volume where its format is relative.

    Args:
        path: The file; its suffix tells the format.
        volume: What it is for: gives the value range.
        preset: Which one, in files that hold several (ParaView, Slicer).

    Raises:
        LoadError: missing, damaged, or the preset is not there.
    """
    path = Path(path)
    readers = {".toml": _toml, ".tf1d": _tf1d, ".json": _paraview, ".xml": _slicer}
    if path.suffix.lower() not in readers:
        raise LoadError(path, f"is no transfer function; known formats: {', '.join(SUFFIXES)}")
    try:
        text = path.read_text(encoding="utf-8")
        return readers[path.suffix.lower()](path, text, volume, preset)
    except OSError as error:
        raise LoadError(path, error.strerror or "cannot be read") from None
    except (ValueError, KeyError, TypeError, IndexError, ElementTree.ParseError) as error:
        raise LoadError(path, f"is not a readable transfer function: {error}") from None
    except SettingsError as error:
        raise LoadError(path, str(error)) from None


def _toml(path: Path, text: str, volume: Volume, _preset: str | None) -> TransferFunction:
    """``colors = [[value, "#rrggbb"], …]``, ``opacity = [[value, opacity], …]``.

    With ``relative = true`` values run from 0 to 1 over the volume's range.
    """
    data = tomllib.loads(text)
    colors = tuple((float(x), *_rgb(path, c)) for x, c in data["colors"])
    opacities = tuple((float(x), float(a)) for x, a in data["opacity"])
    made = TransferFunction(
        colors, opacities, bool(data.get("stepped")), data.get("name", path.stem)
    )
    return made.rescaled((0, 1), volume.value_range) if data.get("relative") else made


def _rgb(path: Path, color: Any) -> tuple[float, float, float]:
    if isinstance(color, str):
        import cmap

        try:
            r, g, b, _ = cmap.Color(color).rgba
        except ValueError:
            raise LoadError(path, f"unknown color '{color}'") from None
        return float(r), float(g), float(b)
    r, g, b = map(float, color)
    return r, g, b


def _tf1d(path: Path, text: str, volume: Volume, _preset: str | None) -> TransferFunction:
    """The published cone-tracing implementation's files; values on a scale of 0 to 255.

    After ``linear`` comes the count of extra numbers; files with the extra numbers ``255 1`` give
    extinction coefficients, which may exceed 1, in place of opacities.
    """
    words = text.split()
    if words[0] != "linear":
        raise LoadError(path, f"starts with '{words[0]}' instead of 'linear'", 1)
    numbers = [float(w) for w in words[1:]]
    extras = int(numbers[0])
    rest = numbers[1 + extras :]
    count = int(rest[0])
    colors = np.array(rest[1 : 1 + 4 * count]).reshape(count, 4)
    rest = rest[1 + 4 * count :]
    points = np.array(rest[1 : 1 + 2 * int(rest[0])]).reshape(int(rest[0]), 2)
    opacity = points[:, 0]
    if extras:
        opacity = 1 - np.exp(-opacity)
    made = TransferFunction(
        tuple((x, r, g, b) for r, g, b, x in colors.tolist()),
        tuple(zip(points[:, 1].tolist(), opacity.clip(0, 1).tolist(), strict=True)),
        name=path.stem,
    )
    if volume.values.dtype == np.uint8:
        return made
    return made.rescaled((0, 255), volume.value_range)


def _paraview(path: Path, text: str, volume: Volume, preset: str | None) -> TransferFunction:
    """ParaView's exported colour maps, stretched over the volume's range as ParaView does."""
    data = json.loads(text)
    maps = data if isinstance(data, list) else [data]
    names = [str(m.get("Name", i)) for i, m in enumerate(maps)]
    chosen = maps[_index(path, names, preset)]
    points = np.array(chosen["RGBPoints"], float).reshape(-1, 4)
    space = str(chosen.get("ColorSpace", "RGB")).lower()
    colors = _in_color_space(points.tolist(), space)
    low, high = points[0, 0], points[-1, 0]
    # Points: value, opacity, midpoint, sharpness; without them, opacity rises with the value
    opacities = [
        (x, min(a, LARGEST_OPACITY)) for x, a, *_ in np.reshape(chosen["Points"], (-1, 4)).tolist()
    ] if "Points" in chosen else [(low, 0.0), (high, 0.5)]  # fmt: skip
    made = TransferFunction(
        tuple(colors), tuple(opacities), space == "step", str(chosen.get("Name", path.stem))
    )
    return made.rescaled((low, high), volume.value_range)


def _slicer(path: Path, text: str, _volume: Volume, preset: str | None) -> TransferFunction:
    """3D Slicer's volume rendering presets: counted flat lists, in data values (HU for CT)."""
    nodes = [n for n in ElementTree.fromstring(text).iter() if "colorTransfer" in n.attrib]
    if not nodes:
        raise LoadError(path, "holds no VolumeProperty with a colorTransfer")
    names = [n.get("name", str(i)) for i, n in enumerate(nodes)]
    node = nodes[_index(path, names, preset)]

    def rows(key: str, width: int) -> list[list[float]]:
        numbers = [float(w) for w in node.attrib[key].split()]
        return np.array(numbers[1 : 1 + int(numbers[0])]).reshape(-1, width).tolist()

    return TransferFunction(
        tuple((x, r, g, b) for x, r, g, b in rows("colorTransfer", 4)),
        tuple((x, min(a, LARGEST_OPACITY)) for x, a in rows("scalarOpacity", 2)),
        name=node.get("name", path.stem),
    )


def _index(path: Path, names: list[str], preset: str | None) -> int:
    if preset is None:
        return 0
    if preset not in names:
        raise LoadError(path, f"has no preset '{preset}'; it has: {', '.join(names)}")
    return names.index(preset)


def _in_color_space(
    points: Sequence[Sequence[float]], space: str, between: int = 8
) -> list[tuple[float, float, float, float]]:
    """Points densified so that linear interpolation in sRGB follows another colour space."""
    if space in ("rgb", "step") or len(points) < 2:
        return [(x, r, g, b) for x, r, g, b in points]
    to, back = {"hsv": (colorsys.rgb_to_hsv, colorsys.hsv_to_rgb)}.get(
        space, (_lab_from_srgb, _srgb_from_lab)
    )
    made = []
    for (x0, *c0), (x1, *c1) in itertools.pairwise(points):
        a, b = np.array(to(*c0)), np.array(to(*c1))
        if space == "hsv" and abs(b[0] - a[0]) > 0.5:  # the short way round the hue circle
            a[0], b[0] = (a[0] + 1, b[0]) if a[0] < b[0] else (a[0], b[0] + 1)
        for k in range(between):
            t = k / between
            rgb = np.clip(back(*(a + (b - a) * t)), 0, 1)
            made.append((x0 + (x1 - x0) * t, *map(float, rgb)))
    return [*made, tuple(points[-1])]  # type: ignore[list-item]


_XYZ_FROM_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175],
     [0.0193339, 0.119192, 0.9503041]]
)  # fmt: skip
_WHITE = _XYZ_FROM_RGB.sum(axis=1)


def _lab_from_srgb(r: float, g: float, b: float) -> list[float]:
    """CIELAB (D65) of one sRGB colour."""
    srgb = np.array([r, g, b])
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    x, y, z = (
        math.cbrt(t) if t > 216 / 24389 else (24389 / 27 * t + 16) / 116
        for t in (_XYZ_FROM_RGB @ linear / _WHITE).tolist()
    )
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def _srgb_from_lab(lightness: float, a: float, b: float) -> list[float]:
    y = (lightness + 16) / 116
    f = np.array([y + a / 500, y, y - b / 200])
    xyz = np.where(f > 6 / 29, f**3, (116 * f - 16) * 27 / 24389) * _WHITE
    linear = np.clip(np.linalg.solve(_XYZ_FROM_RGB, xyz), 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return [float(c) for c in srgb]
