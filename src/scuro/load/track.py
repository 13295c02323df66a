"""The track of a probe, as the viewer saves it: JSON with ``points`` (Å) and ``radius``."""

from __future__ import annotations

from typing import Any

import numpy as np

from scuro.errors import LoadError
from scuro.load.source import Source
from scuro.scene.track import Track

_MOST = 1_000_000


def track_of(source: Source, content: dict[str, Any]) -> Track:
    """Read a track.

    Raises:
        LoadError: Its places are none.
    """
    try:
        points = np.array(content["points"], np.float64)
        radius = float(content.get("radius", 0.0))
    except (ValueError, TypeError):
        raise LoadError(source.name, "is no path of a probe: its points are no numbers") from None
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise LoadError(source.name, "is no path of a probe: its points are not (x, y, z)")
    if not 0 < len(points) <= _MOST:
        raise LoadError(source.name, f"is a path of {len(points):,} places: 1 to {_MOST:,} can be")
    return Track("path of a probe", points, radius if np.isfinite(radius) else 0.0)
