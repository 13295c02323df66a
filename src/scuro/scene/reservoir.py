"""A reservoir in a scene: the model, and what of it is shown."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.kept import kept_with
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.geometry import Body
from scuro.style.reservoir_options import ReservoirSettings

_PREFERRED = ("SOIL", "SWAT", "SGAS", "PRESSURE", "PORO", "PERMX")
FLATTEST = 0.12
"""Without a given exaggeration, heights are stretched to this share of the model's length."""


@dataclass(eq=False)
class ReservoirItem:
    """A corner-point grid and how it is shown."""

    grid: CornerPointGrid
    settings: ReservoirSettings = field(default_factory=ReservoirSettings)
    _bodies: dict[Any, list[Body]] = field(default_factory=dict, repr=False)
    _outline: tuple[Any, NDArray[np.float64]] | None = field(default=None, repr=False)

    @property
    def exaggeration(self) -> float:
        """Factor on heights: the settings', or one that makes flat models readable."""
        if self.settings.exaggeration is not None:
            return self.settings.exaggeration
        return _fitting_exaggeration(self.grid)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) world box."""
        low, high = self.grid.bounds
        e = self.exaggeration
        return np.array([[*low[:2], low[2] * e], [*high[:2], high[2] * e]])

    @property
    def outline(self) -> NDArray[np.float64]:
        """(n, 3) world points that bound the cells that are seen: the ends of each column's.

        All active cells where none is seen; no points where surfaces alone are.
        """
        from scuro.style.reservoir_extent import seen_cells

        key = (self.settings, self.show)
        if self._outline is None or self._outline[0] != key:
            seen = seen_cells(self)
            points = _ends(self.grid, seen, self.exaggeration) if seen is not None else _NOWHERE
            self._outline = (key, points)
        return self._outline[1]

    @property
    def shown_property(self) -> str:
        """Name of the property shown; ``DEPTH`` where the files have none."""
        name = self.settings.property.upper()
        if name != "AUTO":
            return name
        known = self.grid.properties
        return next((n for n in (*_PREFERRED, *known) if n in known), "DEPTH")

    @property
    def show(self) -> str:
        """``volume``, ``cells``, ``slices`` or ``iso``."""
        return "cells" if self.settings.show == "auto" else self.settings.show

    def values(self) -> NDArray[np.float32]:
        """(n_active,) values of the property at the time step."""
        return self.grid.values(self.shown_property, self.settings.time)

    def chosen(self) -> NDArray[np.bool_]:
        """(n_active,) which cells pass the filters of value and place."""
        from scuro.style.reservoir_options import parse_box

        settings = self.settings
        values = self.values()
        with np.errstate(invalid="ignore"):
            keep = np.ones(len(values), bool)
            if settings.low is not None:
                keep &= values >= settings.low
            if settings.high is not None:
                keep &= values <= settings.high
        place = np.nonzero(self.grid.active)[::-1]
        for axis, first, last in parse_box(settings.box):
            keep &= (place[axis] + 1 >= first) & (place[axis] + 1 <= last)
        return keep

    def bodies(self) -> list[Body]:
        """Opaque parts: cells, slices, faults, edges and wells, as the settings ask for."""
        from scuro.style.reservoir_bodies import reservoir_bodies

        key = (self.settings, self.show)
        if key not in self._bodies:
            self._bodies.clear()
            self._bodies[key] = reservoir_bodies(self)
        return self._bodies[key]


@kept_with
def _fitting_exaggeration(grid: CornerPointGrid) -> float:
    size = grid.bounds[1] - grid.bounds[0]
    wanted = FLATTEST * float(np.hypot(*size[:2])) / max(float(size[2]), 1e-6)
    return float(max(1, round(wanted)))


_NOWHERE = np.zeros((0, 3))
_MOST_COLUMNS = 20_000


def _ends(grid: CornerPointGrid, seen: NDArray, exaggeration: float) -> NDArray[np.float64]:
    """World corners (n, 3) of the first and last cell of each column among those of a mask."""
    used = seen.any(axis=0)
    nk = seen.shape[0]
    first, last = seen.argmax(axis=0), nk - 1 - seen[::-1].argmax(axis=0)
    columns = np.flatnonzero(used)
    columns = columns[:: max(1, len(columns) // _MOST_COLUMNS)]
    ends = [layer.ravel()[columns] * used.size + columns for layer in (first, last)]
    return grid.to_world(grid.corners(np.concatenate(ends)), exaggeration).reshape(-1, 3)
