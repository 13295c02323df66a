"""Transfer functions: piecewise linear colour and opacity over data values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError

LARGEST_OPACITY = 0.999
"""Opacities are held below one: an opacity of one is an infinite extinction coefficient."""


@dataclass(frozen=True)
class TransferFunction:
    """Colour and opacity for every data value.

    Opacity is that of one mean voxel edge of the medium: a sample of a ray that stands for a
    length of h voxels has 1 - (1 - opacity)^h.
    """

    colors: tuple[tuple[float, float, float, float], ...]
    """Points (value, red, green, blue), values ascending; sRGB, 0 to 1."""
    opacities: tuple[tuple[float, float], ...]
    """Points (value, opacity), values ascending; equal values make a step."""
    stepped: bool = False
    """Whether each point holds until halfway to the next (label maps), not interpolated."""
    name: str = ""

    def __post_init__(self) -> None:
        for points, what, width in ((self.colors, "color", 4), (self.opacities, "opacity", 2)):
            if not points:
                raise SettingsError(f"a transfer function needs at least one {what} point")
            table = np.array([p if len(p) == width else [np.nan] for p in points], object)
            if any(len(p) != width for p in points):
                raise SettingsError(f"every {what} point has {width} numbers")
            numbers = np.array(table.tolist(), float)
            if not np.isfinite(numbers).all():
                raise SettingsError(f"the {what} points have numbers that are not finite")
            if (np.diff(numbers[:, 0]) < 0).any():
                raise SettingsError(f"the values of the {what} points must ascend")
            if numbers[:, 1:].min() < 0 or numbers[:, 1:].max() > 1:
                raise SettingsError(f"{what} points lie between 0 and 1")

    def opacity(self, values: NDArray) -> NDArray[np.float64]:
        """Opacity per voxel, at most :data:`LARGEST_OPACITY`; of the values' shape."""
        x, a = np.array(self.opacities, float).T
        return np.minimum(self._sampled(values, x, a), LARGEST_OPACITY)

    def color(self, values: NDArray) -> NDArray[np.float64]:
        """sRGB colours, (…, 3)."""
        points = np.array(self.colors, float)
        return np.stack([self._sampled(values, points[:, 0], c) for c in points[:, 1:].T], -1)

    def _sampled(self, values: NDArray, x: NDArray, y: NDArray) -> NDArray[np.float64]:
        if self.stepped:
            return y[np.searchsorted((x[1:] + x[:-1]) / 2, values)]
        return np.interp(values, x, y)

    def table(self, low: float, high: float, count: int) -> NDArray[np.float32]:
        """(count, 4) *linear* red, green, blue and opacity at equal steps from low to high."""
        values = np.linspace(low, high, count)
        srgb = self.color(values)
        linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        return np.concatenate([linear, self.opacity(values)[:, None]], 1).astype(np.float32)

    def rescaled(
        self, source: tuple[float, float], target: tuple[float, float]
    ) -> TransferFunction:
        """The points moved so that the values of ``source`` come to lie at those of ``target``."""
        (a, b), (c, d) = source, target
        scale = (d - c) / (b - a) if b != a else 1.0
        return replace(
            self,
            colors=tuple((c + (x - a) * scale, *rgb) for x, *rgb in self.colors),  # type: ignore[misc]
            opacities=tuple((c + (x - a) * scale, o) for x, o in self.opacities),
        )

    def with_opacities(self, points: Sequence[tuple[float, float]]) -> TransferFunction:
        """The same colours with other opacity points."""
        return replace(self, opacities=tuple((float(x), float(a)) for x, a in points))


def from_colormap(
    name: str, value_range: tuple[float, float], opacities: Sequence[tuple[float, float]]
) -> TransferFunction:
    """A named colormap (matplotlib, cmocean, crameri, …) over a range, with opacity points.

    Raises:
        SettingsError: no such colormap.
    """
    import logging

    import cmap

    # short names that stand for one of several colormaps are what people know
    logging.getLogger("cmap").setLevel(logging.ERROR)
    try:
        colormap = cmap.Colormap(name)
    except (ValueError, TypeError, KeyError):
        raise SettingsError(
            f"there is no colormap '{name}': try viridis, magma, cividis, coolwarm, cmocean:thermal"
        ) from None
    low, high = value_range
    places = np.linspace(0, 1, 33)
    rgb = np.asarray(colormap(places))[:, :3]
    colors = tuple(
        (low + (high - low) * float(p), *map(float, c)) for p, c in zip(places, rgb, strict=True)
    )
    return TransferFunction(
        colors,  # type: ignore[arg-type]
        tuple((float(x), float(a)) for x, a in opacities),
        name=name,
    )


def from_window(window: float, level: float, colormap: str = "gray") -> TransferFunction:
    """Radiology's window and level: black and clear below, white and dense above."""
    if not window > 0:
        raise SettingsError(f"a window must be wider than zero, not {window:g}")
    low, high = level - window / 2, level + window / 2
    opacities = [(low, 0.0), (level, 0.05), (high, 0.5)]
    made = from_colormap(colormap, (low, high), opacities)
    return replace(made, name=f"window {window:g} level {level:g}")
