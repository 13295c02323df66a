"""Clipping: the kept region is the intersection of half-spaces, hence convex."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.geometry import Body, Geometry, rotation_matrices
from scuro.settings import SettingsGroup, setting

MAX_PLANES = 32
_FARTHEST = 1e12
"""Å from the origin, beyond which a plane is refused: the GPU's numbers would overflow."""


def _unit(normal: tuple[float, float, float]) -> NDArray[np.float64]:
    """(3,) direction of a normal of any length."""
    n = np.asarray(normal, np.float64)
    largest = np.abs(n).max()
    if not largest > 0:
        raise SettingsError("a clipping plane needs a normal that is not zero")
    n = n / largest  # squares of very long and very short ones leave the range of numbers
    return np.asarray(n / np.linalg.norm(n))


@dataclass(frozen=True)
class Plane:
    """Keeps the side to which ``normal`` points: points x with normal · (x - point) >= 0."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (*self.point, *self.normal))):
            raise SettingsError("a clipping plane has numbers that are not finite")
        if max(map(abs, self.point)) > _FARTHEST:
            raise SettingsError(f"a clipping plane lies farther than {_FARTHEST:g} Å from all")
        _unit(self.normal)

    def equation(self) -> NDArray[np.float64]:
        """(4,) unit normal and offset: n · x + offset >= 0 is kept."""
        n = _unit(self.normal)
        return np.append(n, -n @ np.asarray(self.point, np.float64))


@dataclass(frozen=True)
class Clip:
    """A set of planes, in world units; what lies outside any of them is gone, for every ray."""

    planes: tuple[Plane, ...] = ()
    whole: bool = False
    """Keep or drop atoms as a whole, by their centres, instead of cutting them."""

    def __post_init__(self) -> None:
        if len(self.planes) > MAX_PLANES:
            raise SettingsError(f"at most {MAX_PLANES} clipping planes, not {len(self.planes)}")

    def equations(self) -> NDArray[np.float64]:
        """(k, 4) plane equations, see :meth:`Plane.equation`."""
        return np.array([p.equation() for p in self.planes], np.float64).reshape(-1, 4)

    @property
    def cutting(self) -> Clip:
        """What rays have to heed: nothing where whole atoms were dropped before."""
        return Clip() if self.whole else self

    def keeps(self, points: NDArray) -> NDArray[np.bool_]:
        """(…) whether world points (…, 3) lie on the kept side of every plane."""
        e = self.equations()
        return np.all(points @ e[:, :3].T + e[:, 3] >= 0, axis=-1)


class Cut(SettingsGroup):
    """One clipping plane as scene files and ``--clip`` give it."""

    normal: tuple[float, float, float] = setting(
        (0.0, 0.0, -1.0), "direction of the side that is kept"
    )
    offset: float = setting(0.0, "how far the plane is moved along its normal", unit="Å")
    point: tuple[float, float, float] | None = setting(
        None, "a point on the plane, before the offset (default: the scene's middle)"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        _unit(self.normal)

    def plane(self, middle: NDArray) -> Plane:
        """The plane in a scene with this middle."""
        base = np.asarray(middle if self.point is None else self.point, np.float64)
        point = base + self.offset * _unit(self.normal)
        return Plane(tuple(point.tolist()), self.normal)


class ClippingSettings(SettingsGroup):
    """How clipping cuts, and the navigation cube (Easdon 2013, 5.4)."""

    spare: str = setting("", "selection that is not cut, in PyMOL's words")
    whole_atoms: bool = setting(False, "drop atoms as a whole, by their centres, and cut none")
    cube: tuple[float, float, float] | None = setting(
        None, "show only what is inside a box of this width, height and depth", low=0.01, unit="Å",
        switch=True,
    )  # fmt: skip
    cube_center: tuple[float, float, float] | None = setting(
        None, "the box's middle in the file's coordinates (default: the scene's)", unit="Å"
    )
    cube_turn: tuple[float, float, float] = setting(
        (0.0, 0.0, 0.0), "turns of the box about x, then y, then z", unit="deg"
    )
    cube_rest: str = setting(
        "backbone",
        "how the polymers outside of the box show",
        choices=("backbone", "cartoon", "none"),
    )

    def box(self, middle: NDArray) -> tuple[Plane, ...]:
        """The six planes of the navigation cube; none without one."""
        if self.cube is None:
            return ()
        center = np.asarray(middle if self.cube_center is None else self.cube_center, np.float64)
        planes = []
        for axis, size in zip(_turned(self.cube_turn).T, self.cube, strict=True):
            for side in (1.0, -1.0):
                point = center - side * axis * size / 2
                planes.append(Plane(tuple(point.tolist()), tuple((side * axis).tolist())))
        return tuple(planes)


def _turned(degrees: tuple[float, float, float]) -> NDArray[np.float64]:
    """(3, 3) rotation about x, then y, then z; its columns are the box's axes."""
    matrix = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        c, s = math.cos(angle), math.sin(angle)
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        matrix = turn @ matrix
    return matrix


def drop_outside(body: Body, clip: Clip) -> Body:
    """A body without the atoms (or cells, or instances) whose centres a clip does not keep.

    A body that is placed once loses primitives; of one that is placed often, the instances as a
    whole stay or go, for they share one geometry.
    """
    if not body.clipped or not clip.planes or not len(body.geometry):
        return body
    if body.frames is not None:
        return body  # all frames show the same assembly, which planes cut only as they trace it
    matrices = rotation_matrices(body.rotations)
    if len(body.positions) != 1:
        middle = body.geometry.bounds.astype(np.float64).mean(axis=0)
        kept = clip.keeps(matrices @ middle + body.positions)
        return replace(body, rotations=body.rotations[kept], positions=body.positions[kept])
    g = body.geometry

    def inside(points: NDArray) -> NDArray[np.bool_]:
        return clip.keeps(points.astype(np.float64) @ matrices[0].T + body.positions[0])

    spheres = inside(g.spheres[:, :3])
    rods = inside(g.rods[..., :3]).all(axis=1)
    triangles = inside(g.triangles.mean(axis=1))
    return replace(
        body,
        geometry=Geometry(
            g.spheres[spheres],
            g.sphere_colors[spheres],
            g.sphere_ids[spheres],
            g.rods[rods],
            g.rod_colors[rods],
            g.rod_ids[rods],
            g.triangles[triangles],
            g.triangle_normals[triangles],
            g.triangle_colors[triangles],
            g.triangle_ids[triangles],
        ),
    )
