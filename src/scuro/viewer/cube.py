"""The navigation cube under hands: its faces pushed, its middle moved, the whole turned."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scuro.scene.clip import ClippingSettings

EDGES = tuple((a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit)
"""Pairs of :func:`corners` that an edge joins."""
_THINNEST = 1e-3


def made(bounds: NDArray, rest: str) -> ClippingSettings:
    """A cube around the middle two thirds of a box (2, 3).

    Args:
        bounds: Of the scene.
        rest: How the polymers outside of it show.
    """
    low, high = np.asarray(bounds, np.float64)
    return ClippingSettings(
        cube=_tuple((high - low) * 2 / 3), cube_center=_tuple((low + high) / 2), cube_rest=rest
    )


def axes(cube: ClippingSettings) -> NDArray[np.float64]:
    """(3, 3) the cube's unit axes, one a row."""
    from scipy.spatial.transform import Rotation

    turned: NDArray[np.float64] = Rotation.from_euler(
        "xyz", cube.cube_turn, degrees=True
    ).as_matrix()
    return turned.T


def center(cube: ClippingSettings, middle: ArrayLike) -> NDArray[np.float64]:
    """(3,) world position of its middle, in a scene with this middle."""
    return np.asarray(middle if cube.cube_center is None else cube.cube_center, np.float64)


def corners(cube: ClippingSettings, middle: ArrayLike) -> NDArray[np.float64]:
    """(8, 3) world positions; bit a of the number says which end of axis a."""
    assert cube.cube is not None
    ends = np.array([[(n >> a & 1) - 0.5 for a in range(3)] for n in range(8)])
    return center(cube, middle) + ends * np.asarray(cube.cube) @ axes(cube)


def face(cube: ClippingSettings, middle: ArrayLike, number: int) -> tuple[NDArray, NDArray]:
    """(3,) middle and (3,) outward normal of a face, 0 to 5: -x, +x, -y, +y, -z, +z."""
    assert cube.cube is not None
    axis, sign = number // 2, 1.0 if number % 2 else -1.0
    outward = sign * axes(cube)[axis]
    return center(cube, middle) + outward * cube.cube[axis] / 2, outward


def pushed(
    cube: ClippingSettings, middle: ArrayLike, number: int, distance: float
) -> ClippingSettings:
    """The cube with a face moved outward; the opposite one stays."""
    assert cube.cube is not None
    axis = number // 2
    size = list(cube.cube)
    distance = max(distance, _THINNEST - size[axis])
    size[axis] += distance
    _, outward = face(cube, middle, number)
    moved = center(cube, middle) + outward * distance / 2
    return cube.replace(cube=tuple(size), cube_center=_tuple(moved))


def moved(cube: ClippingSettings, middle: ArrayLike, by: ArrayLike) -> ClippingSettings:
    """The cube elsewhere."""
    return cube.replace(cube_center=_tuple(center(cube, middle) + np.asarray(by)))


def turned(cube: ClippingSettings, axis: ArrayLike, angle: float) -> ClippingSettings:
    """The cube turned about a world axis (3,) through its middle by an angle in radians."""
    from scipy.spatial.transform import Rotation

    direction = np.asarray(axis, np.float64) / np.linalg.norm(axis)
    after = Rotation.from_rotvec(direction * angle) * Rotation.from_matrix(axes(cube).T)
    return cube.replace(cube_turn=_tuple(after.as_euler("xyz", degrees=True)))


def _tuple(v: ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(v, np.float64).tolist()
    return x, y, z
