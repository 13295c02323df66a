"""The track of a probe: the channel or pocket that it went through, drawn as a tube."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, Geometry

_THICK = 0.3
"""Å: the tube's radius, thinner than any probe that leaves a track worth showing."""
_START, _END = (94, 52, 160), (250, 200, 70)
"""sRGB of where it begins and ends: which way the probe went; no chain is coloured so."""


@dataclass(frozen=True, eq=False)
class Track:
    """Places that a probe went through, one after the other."""

    name: str
    points: NDArray[np.float64]
    """(n, 3) Å, in the coordinates of the atoms about it."""
    radius: float
    """Å, of the probe."""

    def summary(self) -> dict[str, Any]:
        """For ``scuro info``."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return {
            "name": self.name,
            "places": len(self.points),
            "length": round(float(steps.sum()), 2),
            "radius": self.radius,
            "unit": "Å",
        }


@dataclass(eq=False)
class TrackItem:
    """A track in a scene."""

    track: Track
    _body: Body | None = field(default=None, repr=False)

    def bodies(self) -> list[Body]:
        """Its tube; the same object every time."""
        if self._body is None:
            name = self.track.name
            self._body = Body(_tube(self.track.points), name=name, path=(name,))
        return [self._body]


def _tube(points: NDArray[np.float64]) -> Geometry:
    """Balls at the places and rods between them."""
    count = len(points)
    balls = np.concatenate([points, np.full((count, 1), _THICK)], axis=1).astype(np.float32)
    share = np.linspace(0, 1, count)[:, None]
    rgb = np.rint((1 - share) * _START + share * np.array(_END))
    colors = np.concatenate([rgb, np.full((count, 1), 255)], axis=1).astype(np.uint8)
    rods = max(count - 1, 0)
    return Geometry(
        spheres=balls,
        sphere_colors=colors,
        sphere_ids=np.full(count, -1, np.int32),
        rods=np.stack([balls[:-1], balls[1:]], axis=1),
        rod_colors=np.stack([colors[:-1], colors[1:]], axis=1),
        rod_ids=np.full((rods, 2), -1, np.int32),
    )
