"""ROFF (Roxar Open File Format) grids, through roffio."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, MissingExtraError
from scuro.load.options import LoadOptions
from scuro.load.reservoir_build import build_grid
from scuro.load.source import Source
from scuro.scene.cornerpoint import CornerPointGrid


def read_roff(source: Source, options: LoadOptions) -> CornerPointGrid:
    """Read a ROFF grid, binary or ASCII, and the parameters that the same file holds."""
    try:
        import roffio
    except ImportError:
        raise MissingExtraError("reservoir models", "reservoir") from None
    data = source.data
    try:
        stream: Any = BytesIO(data)
        if data[:10].startswith(b"roff-asc"):
            import io

            stream = io.TextIOWrapper(stream, encoding="latin-1")
        tags = roffio.read(stream)
        size = _one(tags["dimensions"])
        ni, nj, nk = (int(size[n]) for n in ("nX", "nY", "nZ"))
        move = _one(tags.get("translate", {}))
        offset = np.array([float(move.get(f"{a}offset", 0.0)) for a in "xyz"])
        scale = _one(tags.get("scale", {}))
        factor = np.array([float(scale.get(f"{a}scale", 1.0)) for a in "xyz"])
        lines = np.asarray(_one(tags["cornerLines"])["data"], np.float64)
        splits = np.frombuffer(bytes(_one(tags["zvalues"])["splitEnz"]), np.uint8)
        depths = np.asarray(_one(tags["zvalues"])["data"], np.float32)
        pillars = lines.reshape(ni + 1, nj + 1, 2, 3)[:, :, ::-1].transpose(1, 0, 2, 3)
        zcorn = _zcorn(splits, depths, (ni, nj, nk))
        zcorn = (zcorn + np.float32(offset[2])) * np.float32(factor[2])
        active = None
        if "active" in tags:
            flags = np.asarray(_one(tags["active"])["data"]).astype(bool)
            active = _natural(flags, (ni, nj, nk))
        statics = {}
        for parameter in _many(tags.get("parameter", [])):
            values = np.asarray(parameter["data"], np.float32)
            if values.size == ni * nj * nk:
                whole = _natural(values, (ni, nj, nk))
                whole = np.where(whole <= -998.9, np.nan, whole)
                statics[str(parameter["name"]).upper()] = (
                    whole[active] if active is not None else whole.ravel()
                )
    except LoadError:
        raise
    except Exception as error:  # roffio and damaged tables raise many kinds
        text = str(error).split("\n")[0][:120]
        raise LoadError(
            source.name, f"cannot be read as a ROFF grid ({type(error).__name__}: {text})"
        ) from None
    return build_grid(
        source,
        (ni, nj, nk),
        (pillars + offset) * factor,
        zcorn,
        active=active,
        unit=None,
        unit_system="",
        options=options,
        map_axes=None,
        # elevations are negative underground, unless a scale of -1 turned them into depths
        depth_down=bool(np.median(zcorn) > 0),
        statics=statics,
        notes=["a ROFF grid has no time steps: no pressures or saturations"],
    )


def _many(tag: Any) -> list[dict]:
    return tag if isinstance(tag, list) else [tag] if tag else []


def _one(tag: Any) -> dict:
    return tag[0] if isinstance(tag, list) else tag


def _natural(values: NDArray, dimensions: tuple[int, int, int]) -> NDArray:
    """(nk, nj, ni) from ROFF's order: k fastest, from the bottom layer up; i slowest."""
    ni, nj, nk = dimensions
    return np.ascontiguousarray(values.reshape(ni, nj, nk)[:, :, ::-1].transpose(2, 1, 0))


def _zcorn(splits: NDArray, depths: NDArray, dimensions: tuple[int, int, int]) -> NDArray:
    """(nk, 2, nj, 2, ni, 2) from depths at nodes, each with 1, 2, 4 or 8 values.

    Nodes are ordered like cells. Eight values are those of the cells around: below south-west,
    south-east, north-west, north-east, then the four above; four are the same without regard to
    below and above; two are below and above.
    """
    ni, nj, nk = dimensions
    counts = splits.astype(np.int64)
    if counts.size != (ni + 1) * (nj + 1) * (nk + 1) or counts.sum() != depths.size:
        raise ValueError("zvalues and splitEnz do not fit the dimensions")
    if not np.isin(counts, (1, 2, 4, 8)).all():
        raise ValueError("splitEnz has a value that is not 1, 2, 4 or 8")
    starts = np.cumsum(counts) - counts
    slot = np.arange(8)
    place = np.select(
        [(counts == n)[:, None] for n in (1, 2, 4)],
        [np.zeros(8, np.int64), slot // 4, slot % 4],
        slot,
    )
    nodes = depths[starts[:, None] + place].reshape(ni + 1, nj + 1, nk + 1, 2, 2, 2)
    # (i, j, k from the bottom, above, north, east); a cell's corner sees the node from its side
    zcorn = np.empty((nk, 2, nj, 2, ni, 2), np.float32)
    for dk, dj, di in np.ndindex(2, 2, 2):
        # the cell's top corners (dk = 0) are at the node above it, seen from below
        upper = 1 - dk
        part = nodes[di : ni + di, dj : nj + dj, upper : nk + upper, 1 - upper, 1 - dj, 1 - di]
        zcorn[:, dk, :, dj, :, di] = part[:, :, ::-1].transpose(2, 1, 0)
    return zcorn
