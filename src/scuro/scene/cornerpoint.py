"""A reservoir model: cells between pillars, their properties, time steps and wells.

A corner-point grid has straight coordinate lines (*pillars*) and, for each cell, eight depths at
which its corners sit on its four pillars. Neighbours need not share corners: a fault splits them.
Data are kept as the file has them (depth down, local axes); :meth:`CornerPointGrid.to_world` turns
them into world space: x east, y north, z *up*.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import date
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.settings import unknown

LENGTH_UNITS = {"METRES": "m", "FEET": "ft", "CM": "cm"}

_UNITS = {
    "METRIC": {"PRESSURE": "barsa", "RS": "sm³/sm³", "RV": "sm³/sm³", "PORV": "rm³"},
    "FIELD": {"PRESSURE": "psia", "RS": "Mscf/stb", "RV": "stb/Mscf", "PORV": "rb"},
    "LAB": {"PRESSURE": "atma", "RS": "scc/scc", "RV": "scc/scc", "PORV": "rcc"},
}
_LENGTHS = ("DEPTH", "DX", "DY", "DZ", "TOPS")
_PERMEABILITIES = ("PERMX", "PERMY", "PERMZ", "PERMXY", "PERMYZ", "PERMZX")


@dataclass(frozen=True, eq=False)
class TimeStep:
    """One restart step; its arrays are read when asked for."""

    report: int
    date: date | None
    names: tuple[str, ...]
    read: Callable[[str], NDArray[np.float32]]
    """From a name of ``names`` to its values at the active cells."""

    def __str__(self) -> str:
        return self.date.isoformat() if self.date else f"step {self.report}"


@dataclass(frozen=True, eq=False)
class Well:
    """A well and the cells that it is open to."""

    name: str
    cells: NDArray[np.int32]
    """(n, 3) zero-based i, j, k of its connections, heel to toe."""
    kind: str = ""
    """``producer``, ``oil injector``, ``water injector``, ``gas injector``; empty if unknown."""


@dataclass(frozen=True, eq=False)
class CornerPointGrid:
    """A corner-point grid and what is known in its cells (compared and cached by identity)."""

    coord: NDArray[np.float64]
    """(nj + 1, ni + 1, 2, 3): a point near the top and one near the bottom of each pillar, x, y and
    depth (positive down) in :attr:`unit`, in the grid's own axes."""
    zcorn: NDArray[np.float32]
    """(nk, 2, nj, 2, ni, 2): depth of every cell's corners; the 2s choose the top or bottom, the
    lower or higher j, the lower or higher i."""
    active: NDArray[np.bool_]
    """(nk, nj, ni): ACTNUM."""
    name: str = ""
    unit: str = "m"
    """Of lengths: ``m``, ``ft``, ``cm``."""
    unit_system: str = "METRIC"
    """``METRIC``, ``FIELD`` or ``LAB``."""
    map_axes: NDArray[np.float64] | None = None
    """MAPAXES in :attr:`unit`: x, y of a point on the grid's y axis, of its origin, of a point on
    its x axis; ``None`` where the coordinates already are the map's."""
    statics: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    """Values of properties that do not change, (n_active,) in natural order (i fastest)."""
    steps: tuple[TimeStep, ...] = ()
    wells: tuple[Well, ...] = ()
    connections: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """(n, 2) non-neighbour connections between cells, zero-based natural order."""
    source: str = ""
    notes: tuple[str, ...] = ()
    """What is missing or was mended, one sentence each."""

    @property
    def dimensions(self) -> tuple[int, int, int]:
        """Cells along i, j, k."""
        nk, nj, ni = self.active.shape
        return ni, nj, nk

    @cached_property
    def active_count(self) -> int:
        return int(np.count_nonzero(self.active))

    @cached_property
    def active_index(self) -> NDArray[np.int32]:
        """(nk, nj, ni): place of each active cell in the arrays of properties, -1 elsewhere."""
        index = np.cumsum(self.active.ravel(), dtype=np.int32) - 1
        return np.where(self.active, index.reshape(self.active.shape), np.int32(-1))

    @property
    def properties(self) -> tuple[str, ...]:
        """All names that :meth:`values` knows, those that change with time first."""
        changing: dict[str, None] = {}
        for step in self.steps:
            changing |= dict.fromkeys(step.names)
            if "SWAT" in step.names and "SOIL" not in step.names:
                changing["SOIL"] = None
        return tuple(changing | dict.fromkeys(self.statics))

    def step_index(self, step: int) -> int:
        """A step counted from the start, or from the end if negative.

        Raises:
            SettingsError: There is no such step.
        """
        count = len(self.steps)
        if not -count <= step < count:
            if count == 0:
                raise SettingsError(f"{self.name} has no time steps: there is no restart file")
            raise SettingsError(f"{self.name} has no time step {step}: it has {count}, from 0")
        return step % count

    def values(self, name: str, step: int = -1) -> NDArray[np.float32]:
        """(n_active,) values of a property; SOIL = 1 − SWAT − SGAS where the file has it not.

        Args:
            name: As in the files, e.g. ``"SWAT"``.
            step: Which time step, for properties that change; negative counts from the end.

        Raises:
            SettingsError: No such property or step.
        """
        name = name.upper()
        if name == "DEPTH" and name not in self.properties:
            return self.cell_depth
        if name in self.statics and not any(name in s.names for s in self.steps):
            return self.statics[name]
        if name not in self.properties:
            raise SettingsError(unknown("property", name, {*self.properties, "DEPTH"}))
        chosen = self.steps[self.step_index(step)]
        if name in chosen.names:
            return chosen.read(name)
        if name == "SOIL" and "SWAT" in chosen.names:
            water = chosen.read("SWAT")
            gas = chosen.read("SGAS") if "SGAS" in chosen.names else np.float32(0)
            return np.clip(1 - water - gas, 0, 1).astype(np.float32)
        raise SettingsError(
            f"{self.name} has no {name} at {chosen}; it has {', '.join(chosen.names) or 'none'}"
        )

    @cached_property
    def cell_depth(self) -> NDArray[np.float32]:
        """(n_active,) mean depth of each cell's corners, positive down."""
        return self.zcorn.mean(axis=(1, 3, 5), dtype=np.float32)[self.active]

    def changes(self, name: str) -> bool:
        """Whether a property has a value at each time step."""
        return any(name.upper() in s.names for s in self.steps) or name.upper() == "SOIL"

    def value_range(self, name: str) -> tuple[float, float]:
        """Smallest and largest finite value of a property over all its time steps."""
        count = len(self.steps) if self.changes(name) else 1
        low, high = np.inf, -np.inf
        for step in range(count):
            try:
                values = self.values(name, step)
            except SettingsError:
                continue  # this step does not hold it
            finite = values[np.isfinite(values)]
            if len(finite):
                low, high = min(low, float(finite.min())), max(high, float(finite.max()))
        return (low, high) if low <= high else (0.0, 1.0)

    def property_unit(self, name: str) -> str:
        """Unit of a property, empty for fractions and numbers."""
        name = name.upper()
        if name in _LENGTHS:
            return self.unit
        if name in _PERMEABILITIES:
            return "mD"
        return _UNITS[self.unit_system].get(name, "")

    @cached_property
    def axes(self) -> NDArray[np.float64]:
        """(2, 2) columns: map directions of the grid's x and y axes."""
        if self.map_axes is None:
            return np.eye(2)
        on_y, origin, on_x = self.map_axes.reshape(3, 2)
        x, y = on_x - origin, on_y - origin
        return np.stack([x / np.linalg.norm(x), y / np.linalg.norm(y)], axis=1)

    def to_world(self, points: NDArray, exaggeration: float = 1.0) -> NDArray[np.float64]:
        """World positions (…, 3) of points x, y, depth in the grid's axes.

        Args:
            points: (…, 3).
            exaggeration: Factor on heights.
        """
        world = np.array(points, np.float64)
        if self.map_axes is not None:
            world[..., :2] = world[..., :2] @ self.axes.T + self.map_axes[2:4]
        world[..., 2] *= -exaggeration
        return world

    def pillar_lines(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """x, y at depth 0 and their slopes over depth, each (nj + 1, ni + 1, 2)."""
        top, bottom = self.coord[..., 0, :], self.coord[..., 1, :]
        height = bottom[..., 2:] - top[..., 2:]
        flat = np.abs(height) < 1e-9
        slope = np.where(flat, 0.0, (bottom - top)[..., :2] / np.where(flat, 1.0, height))
        return top[..., :2] - slope * top[..., 2:], slope

    def corners(self, cells: NDArray | None = None) -> NDArray[np.float64]:
        """(n, 2, 2, 2, 3) corners x, y, depth of cells in the grid's axes, indexed by k, j, i side.

        Args:
            cells: Flat indices in natural order; the active cells by default.
        """
        nk, nj, ni = self.active.shape
        if cells is None:
            cells = np.flatnonzero(self.active)
        k, j, i = np.unravel_index(cells, (nk, nj, ni))
        at, slope = self.pillar_lines()
        out = np.empty((len(cells), 2, 2, 2, 3))
        for dk, dj, di in np.ndindex(2, 2, 2):
            depth = self.zcorn[k, dk, j, dj, i, di].astype(np.float64)
            pillar = (j + dj, i + di)
            out[:, dk, dj, di, :2] = at[pillar] + slope[pillar] * depth[:, None]
            out[:, dk, dj, di, 2] = depth
        return out

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) world box around the active cells, without exaggeration."""
        at, slope = self.pillar_lines()
        used = self.active.any(axis=0)
        j, i = np.nonzero(used)
        points = []
        # corners lie on straight pillars: the ends of each column bound what is between them
        for ends in self.column_range:
            for dj, di in np.ndindex(2, 2):
                depth = ends[j, dj, i, di].astype(np.float64)[:, None]
                place = at[j + dj, i + di] + slope[j + dj, i + di] * depth
                points.append(self.to_world(np.concatenate([place, depth], axis=1)))
        every = np.concatenate(points)
        return np.stack([every.min(axis=0), every.max(axis=0)])

    @cached_property
    def column_range(self) -> NDArray[np.float32]:
        """(2, nj, 2, ni, 2) least and greatest depth of each column's active cells, at its corners.

        Columns without active cells have infinity and minus infinity.
        """
        ni, nj, nk = self.dimensions
        low = np.full((nj, 2, ni, 2), np.inf, np.float32)
        high = np.full((nj, 2, ni, 2), -np.inf, np.float32)
        # layer by layer: what is worked on stays in the processor's caches
        for k in range(nk):
            active = self.active[k].repeat(2, axis=0).repeat(2, axis=1).reshape(low.shape)
            top, bottom = self.zcorn[k]
            np.minimum(low, np.where(active, np.minimum(top, bottom), np.inf), out=low)
            np.maximum(high, np.where(active, np.maximum(top, bottom), -np.inf), out=high)
        return np.stack([low, high])

    @cached_property
    def right_handed(self) -> bool:
        """Whether i, j and k (downward) make a right-handed system in world space.

        That is so where j turns clockwise from i seen from above.
        """
        corners = self.coord[..., 0, :2] @ self.axes.T
        across = corners[0, -1] - corners[0, 0]
        along = corners[-1, 0] - corners[0, 0]
        return bool(across[0] * along[1] - across[1] * along[0] < 0)

    def summary(self) -> dict[str, object]:
        """What ``scuro info`` prints."""
        from scuro.scene.cornerpoint_topology import count_cells

        ni, nj, nk = self.dimensions
        counts = count_cells(self)
        return {
            "dimensions": [ni, nj, nk],
            "cells": ni * nj * nk,
            "active cells": self.active_count,
            "faults (faces split from their neighbours)": counts.split,
            "collapsed active cells": counts.collapsed,
            "inverted active cells": counts.inverted,
            "non-neighbour connections": len(self.connections),
            "handedness": "right" if self.right_handed else "left",
            "units": f"{self.unit_system} (lengths in {self.unit})",
            "map axes": self.map_axes is not None,
            "bounds": np.round(self.bounds, 2).tolist(),
            "properties": [self._property_line(name) for name in self.properties],
            "dates": [str(step) for step in self.steps],
            "wells": [well.name for well in self.wells],
            "notes": list(self.notes),
        }

    def _property_line(self, name: str) -> str:
        unit = self.property_unit(name)
        return f"{name} ({unit})" if unit else name
