"""From any reader's arrays to a :class:`CornerPointGrid`: sizes, units and numbers checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.options import LoadOptions
from scuro.load.source import Source
from scuro.scene.cornerpoint import LENGTH_UNITS, CornerPointGrid

_METRES = {"METRES": 1.0, "FEET": 0.3048, "CM": 0.01}
_SYSTEMS = {"METRES": "METRIC", "FEET": "FIELD", "CM": "LAB"}


def build_grid(
    source: Source,
    dimensions: Sequence[int],
    coord: NDArray,
    zcorn: NDArray,
    *,
    active: NDArray | None,
    unit: str | None,
    unit_system: str,
    options: LoadOptions,
    map_axes: NDArray | None,
    map_unit: str = "",
    depth_down: bool = True,
    statics: Mapping[str, NDArray[np.float32]],
    notes: Sequence[str],
    **rest: Any,
) -> CornerPointGrid:
    """Check sizes and numbers and make the grid.

    Args:
        source: The grid file.
        dimensions: Cells along i, j, k.
        coord: Six numbers a pillar.
        zcorn: Eight depths a cell.
        active: One number a cell; all cells where ``None``.
        unit: ``METRES``, ``FEET`` or ``CM``; ``None`` where the file does not say.
        unit_system: ``METRIC``, ``FIELD`` or ``LAB``; empty where the file does not say.
        options: A unit that the user gives counts instead of the file's.
        map_axes: MAPAXES, six numbers.
        map_unit: Unit of MAPAXES, where it differs from the grid's.
        depth_down: Whether ``zcorn`` grows downward.
        statics: Values of the active cells by name.
        notes: What the reader has to tell.
        rest: Further fields of :class:`CornerPointGrid`.

    Raises:
        LoadError: An array has the wrong length, or the geometry has numbers that are not finite.
    """
    path = source.name
    ni, nj, nk = (int(n) for n in dimensions)
    if min(ni, nj, nk) < 1:
        raise LoadError(path, f"a grid of {ni} x {nj} x {nk} cells has no cells")
    count = ni * nj * nk
    for what, array, size in (
        ("COORD", coord, 6 * (ni + 1) * (nj + 1)),
        ("ZCORN", zcorn, 8 * count),
        ("ACTNUM", active, count),
    ):
        if array is not None and array.size != size:
            raise LoadError(
                path,
                f"{what} has {array.size:,} values, but {ni} x {nj} x {nk} cells need {size:,}",
            )
    for what, array in (("COORD", coord), ("ZCORN", zcorn)):
        bad = array.size - int(np.count_nonzero(np.isfinite(array)))
        if bad:
            raise LoadError(path, f"{what} has {bad:,} values that are not finite numbers")
    sign = 1.0 if depth_down else -1.0
    pillars = np.asarray(coord, np.float64).reshape(nj + 1, ni + 1, 2, 3)
    depths = np.ascontiguousarray(zcorn, np.float32).reshape(nk, 2, nj, 2, ni, 2)
    if sign < 0:
        pillars = pillars * (1, 1, -1)
        depths = -depths
    told = list(notes)
    if options.grid_unit is not None:
        unit, unit_system = options.grid_unit, ""
    if unit is None:
        unit = next((u for u, system in _SYSTEMS.items() if system == unit_system), None)
    word = (unit or "METRES").upper()
    if word not in _METRES:
        told.append(
            f"the unit of length '{unit}' is unknown: taken as metres; --grid-unit says otherwise"
        )
        word = "METRES"
    elif unit is None:
        told.append(
            "names no unit of length: taken as metres, and its properties as METRIC; --grid-unit "
            "feet says otherwise"
        )
    mask = np.ones((nk, nj, ni), bool) if active is None else active.reshape(nk, nj, ni) > 0
    if not mask.any():
        raise LoadError(path, "no cell of the grid is active")
    for name, values in statics.items():
        bad = len(values) - int(np.count_nonzero(np.isfinite(values)))
        if bad:
            told.append(f"{name} has no finite value in {bad:,} cells: they are left out")
    if not unit_system or (unit_system == "METRIC" and word == "FEET"):
        unit_system = _SYSTEMS[word]
    return CornerPointGrid(
        pillars,
        depths,
        mask,
        name=source.stem,
        unit=LENGTH_UNITS[word],
        unit_system=unit_system,
        map_axes=_map_axes(path, map_axes, map_unit, word),
        statics=dict(statics),
        source=str(path),
        notes=tuple(told),
        **rest,
    )


def _map_axes(path: str, axes: NDArray | None, map_unit: str, unit: str) -> NDArray | None:
    if axes is None:
        return None
    axes = np.asarray(axes, np.float64).ravel()
    if axes.size != 6 or not np.isfinite(axes).all():
        raise LoadError(path, "MAPAXES needs six finite numbers")
    points: NDArray[np.float64] = axes.reshape(3, 2)
    x, y = points[2] - points[1], points[0] - points[1]
    lengths = float(np.linalg.norm(x) * np.linalg.norm(y))
    if abs(x[0] * y[1] - x[1] * y[0]) < 1e-9 * max(1e-30, lengths):
        return None  # all zero in files that have no map
    scale: float = _METRES.get(map_unit.upper(), _METRES[unit]) / _METRES[unit]
    return np.asarray(axes * scale)
