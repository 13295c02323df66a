"""Of many spheres, those that can be the outermost in some direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_FEW = 20_000
"""So many are kept as they are."""
_MOST_RADII = 16
"""Of more different radii all spheres are kept: atoms have one an element."""


def outermost(spheres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of (n, 4) centres and radii that some plane may touch first, coming from outside.

    Cameras, boxes and depths of all the spheres are theirs: of equal spheres, the hull's corners.
    """
    if len(spheres) <= _FEW:
        return spheres
    radii, classes = np.unique(spheres[:, 3], return_inverse=True)
    if len(radii) > _MOST_RADII:
        return spheres
    return np.concatenate([_corners(spheres[classes == k]) for k in range(len(radii))])


def _corners(spheres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of (n, 4) equal spheres whose hull holds the others."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return spheres[ConvexHull(spheres[:, :3]).vertices]
    except (QhullError, ValueError):  # too few, or flat
        return spheres
