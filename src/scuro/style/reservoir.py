"""Colour and opacity of reservoir properties."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from scuro.kept import kept_with
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.reservoir import ReservoirItem
from scuro.style.transfer import TransferFunction, from_colormap

COLORMAP = "turbo"
"""The rainbow that engineers expect, but with even lightness."""
ENDS = 0.07
"""Share of the rainbow that is left out at either end: there it is nearly black, and a body is dark
where it is in shade."""

_WATER = ("SWAT",)


@kept_with
def property_range(grid: CornerPointGrid, name: str) -> tuple[float, float]:
    """Range of a property over all time steps; fractions that reach near 0 and 1 take all of it."""
    low, high = grid.value_range(name)
    if name.startswith("S") and low >= 0 and high <= 1.001:
        return 0.0, 1.0
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def item_transfer(item: ReservoirItem) -> TransferFunction:
    """The transfer function that an item's settings ask for.

    Raises:
        SettingsError: No such colormap, or opacity points that are not numbers.
        LoadError: The file cannot be read.
    """
    settings = item.settings
    low, high = property_range(item.grid, item.shown_property)
    return _transfer(item.shown_property, low, high, settings.transfer, settings.opacity)


@lru_cache(maxsize=16)
def _transfer(name: str, low: float, high: float, transfer: str, opacity: str) -> TransferFunction:
    from scuro.scene.volume import Volume
    from scuro.style.transfer_choose import choose_transfer, opacity_points

    if transfer in ("", "auto"):
        margin = ENDS / (1 - 2 * ENDS) * (high - low)
        opacities = _opacities(name, low, high)
        whole = from_colormap(COLORMAP, (low - margin, high + margin), opacities)
        places = np.linspace(low, high, 33)
        colors = np.column_stack([places, whole.color(places)]).tolist()
        made = replace(whole, colors=tuple(map(tuple, colors)))
    else:
        stand_in = Volume(np.linspace(low, high, 8, dtype=np.float32).reshape(2, 2, 2))
        made = choose_transfer(stand_in, transfer)
        if not transfer.lower().endswith((".toml", ".tf1d", ".json", ".xml")):
            made = made.with_opacities(_opacities(name, low, high))
    return made.with_opacities(opacity_points(opacity)) if opacity else made


def _opacities(name: str, low: float, high: float) -> list[tuple[float, float]]:
    """Nearly clear where there is little of it, dense where there is much; reversed for water."""
    shares = [(0.0, 0.0), (0.2, 0.004), (0.45, 0.03), (0.7, 0.12), (1.0, 0.35)]
    if name in _WATER:
        shares = [(1 - x, a) for x, a in reversed(shares)]
    return [(low + x * (high - low), a) for x, a in shares]
