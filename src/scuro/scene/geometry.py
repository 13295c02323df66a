"""Geometry and bodies: what the tracer and the rasteriser see, whatever the data was.

Every kind of data that has surfaces (molecules, cell-scale models, fault faces, wells) is turned
into a list of :class:`Body`: one :class:`Geometry` in a local frame, placed by rigid transforms.
Copies are always instances; a virus capsid is one geometry and its matrices.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.outermost import outermost


def _empty(*shape: int, dtype: type = np.float32) -> NDArray:
    return np.zeros(shape, dtype)


_SLICE = 1 << 18
"""So many instances at a time where each takes a matrix."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """Ray-traceable primitives in one local frame (compared and cached by identity).

    Colours are sRGB, 8 bits a channel; the fourth channel is unused. ``*_ids`` are the numbers of
    the elements (atoms, cells, …) that the G-buffer reports, -1 for none.
    """

    spheres: NDArray[np.float32] = field(default_factory=lambda: _empty(0, 4))
    """(n, 4): centre x, y, z and radius."""
    sphere_colors: NDArray[np.uint8] = field(default_factory=lambda: _empty(0, 4, dtype=np.uint8))
    sphere_ids: NDArray[np.int32] = field(default_factory=lambda: _empty(0, dtype=np.int32))

    rods: NDArray[np.float32] = field(default_factory=lambda: _empty(0, 2, 4))
    """(n, 2, 4): two ends, each x, y, z and radius. Equal radii make a capless cylinder, unequal
    ones a rounded cone. The half near an end has that end's colour and id."""
    rod_colors: NDArray[np.uint8] = field(default_factory=lambda: _empty(0, 2, 4, dtype=np.uint8))
    rod_ids: NDArray[np.int32] = field(default_factory=lambda: _empty(0, 2, dtype=np.int32))

    triangles: NDArray[np.float32] = field(default_factory=lambda: _empty(0, 3, 3))
    """(n, 3, 3): vertices, counter-clockwise seen from outside."""
    triangle_normals: NDArray[np.float32] = field(default_factory=lambda: _empty(0, 3, 3))
    """(n, 3, 3): unit shading normals at the vertices."""
    triangle_colors: NDArray[np.uint8] = field(
        default_factory=lambda: _empty(0, 3, 4, dtype=np.uint8)
    )
    """(n, 3, 4): at the vertices, interpolated."""
    triangle_ids: NDArray[np.int32] = field(default_factory=lambda: _empty(0, 3, dtype=np.int32))
    """(n, 3): the nearest vertex's id is reported."""

    levels: tuple[Geometry, ...] = ()
    """Coarser forms of the whole, finest first: the tracer takes one where its spheres are smaller
    than the detail asked for (scene/lod.py)."""

    def __len__(self) -> int:
        """Number of primitives."""
        return len(self.spheres) + len(self.rods) + len(self.triangles)

    @cached_property
    def bounds(self) -> NDArray[np.float32]:
        """(2, 3) lowest and highest corner of the axis-aligned box around all primitives."""
        if len(self) == 0:
            return np.zeros((2, 3), np.float32)
        # column by column: numpy reduces (n, 3) along its long axis several times slower
        box = np.empty((2, 3), np.float32)
        balls = [self.spheres, *self.rods.transpose(1, 0, 2)]
        for axis in range(3):
            lows = [b[:, axis] - b[:, 3] for b in balls] + [self.triangles[..., axis].ravel()]
            highs = [b[:, axis] + b[:, 3] for b in balls] + [self.triangles[..., axis].ravel()]
            box[0, axis] = min(low.min() for low in lows if len(low))
            box[1, axis] = max(high.max() for high in highs if len(high))
        return box

    @property
    def points(self) -> NDArray[np.float64]:
        """(n, 4) centres and radii that bound all primitives."""
        corners = self.triangles.reshape(-1, 3)
        bare = np.concatenate([corners, np.zeros((len(corners), 1), np.float32)], axis=1)
        found = np.concatenate([self.spheres, self.rods.reshape(-1, 4), bare])
        return found.astype(np.float64)

    @cached_property
    def outermost(self) -> NDArray[np.float64]:
        """(n, 4) those of :meth:`points` that can be met first from some side."""
        return outermost(self.points)


@dataclass(frozen=True)
class Material:
    """How a surface answers light.

    ``diffuse``, ``specular`` and ``shininess`` are the Lambert and Blinn-Phong terms of the
    deferred shading; the path tracer uses ``kind``, ``roughness`` and ``ior`` besides.
    """

    diffuse: float = 1.0
    specular: float = 0.25
    shininess: float = 40.0
    opacity: float = 1.0
    kind: str = "diffuse"
    """``diffuse``, ``glossy``, ``metal``, ``mirror`` or ``glass`` (path tracer)."""
    roughness: float = 0.3
    """GGX roughness of ``glossy`` and ``metal``, 0 to 1."""
    ior: float = 1.5
    """Index of refraction of ``glass`` and ``glossy``."""


@dataclass(frozen=True, eq=False)
class Frames:
    """Rigid transforms by which whole assemblies of bodies are placed in the world.

    Bodies with the same ``Frames`` are one assembly: a virus of many ingredients, placed often in a
    cell. Its memory is that of one virus and 32 bytes a frame.
    """

    rotations: NDArray[np.float32]
    """(m, 4) unit quaternions x, y, z, w."""
    positions: NDArray[np.float64]
    """(m, 3) world positions of the assembly's origin."""

    def __post_init__(self) -> None:
        if len(self.rotations) != len(self.positions):
            raise SettingsError(
                f"an assembly has {len(self.rotations)} rotations "
                f"but {len(self.positions)} positions"
            )

    def __len__(self) -> int:
        """Number of places."""
        return len(self.positions)

    def placing(self, inner: Frames) -> Frames:
        """Every place of ``inner`` within every one of these, as (outer · inner) places."""
        outer = rotation_matrices(self.rotations)
        turns = outer[:, None] @ rotation_matrices(inner.rotations)[None]
        moved = (outer @ inner.positions.T).transpose(0, 2, 1) + self.positions[:, None]
        return Frames(quaternions(turns.reshape(-1, 3, 3)), moved.reshape(-1, 3))


@dataclass(frozen=True, eq=False)
class Body:
    """One geometry placed in the world by rigid transforms: an *object* of the G-buffer.

    Bodies may share a ``Geometry``; it is then kept and uploaded once.
    """

    geometry: Geometry
    rotations: NDArray[np.float32] = field(
        default_factory=lambda: np.array([[0, 0, 0, 1]], np.float32)
    )
    """(k, 4) unit quaternions x, y, z, w."""
    positions: NDArray[np.float64] = field(default_factory=lambda: np.zeros((1, 3)))
    """(k, 3) positions of the local origin: in the world, or in the assembly's own space."""
    name: str = ""
    path: tuple[str, ...] = ()
    """Place in the scene's tree, root first, e.g. ``("HIV", "plasma", "albumin")``."""
    material: Material = Material()
    clipped: bool = True
    """Whether clipping planes cut it (a clip can spare a selection)."""
    closed: bool = True
    """Whether its triangles enclose solids, which show caps where planes cut them."""
    frames: Frames | None = None
    """Where the assembly that it belongs to stands; ``None`` for a body that stands by itself."""
    context: bool = False
    """Whether it is but the surroundings of what matters: drawn in simple light, neither darkened
    by anything nor occluding or shadowing anything."""

    def __post_init__(self) -> None:
        if len(self.rotations) != len(self.positions):
            raise SettingsError(
                f"body '{self.name}' has {len(self.rotations)} rotations "
                f"but {len(self.positions)} positions"
            )

    @cached_property
    def radius(self) -> float:
        """Radius of a sphere around the middle of the geometry's box that holds all of it."""
        low, high = self.geometry.bounds.astype(np.float64)
        return float(np.linalg.norm(high - low) / 2)

    @property
    def instances(self) -> int:
        """How often its geometry stands in the world."""
        return len(self.positions) * (1 if self.frames is None else len(self.frames.positions))

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) world box around all instances (through their bounding boxes' corners)."""
        if self.frames is None:
            return self.own_bounds
        return placed_box(self.own_bounds, self.frames.rotations, self.frames.positions)

    @cached_property
    def own_bounds(self) -> NDArray[np.float64]:
        """The same in the space of its positions: the assembly's, if it belongs to one."""
        return placed_box(self.geometry.bounds, self.rotations, self.positions)


def placed_box(box: NDArray, rotations: NDArray, positions: NDArray) -> NDArray[np.float64]:
    """(2, 3) box around rigidly placed copies of a box (2, 3), through its corners."""
    low, high = np.asarray(box, np.float64)
    if len(positions) == 0:
        return np.zeros((2, 3))
    middle, half = (low + high) / 2, (high - low) / 2
    boxes = []
    for start in range(0, len(positions), _SLICE):
        matrices = rotation_matrices(rotations[start : start + _SLICE])
        centers = matrices @ middle + positions[start : start + _SLICE]
        reach = np.abs(matrices) @ half
        boxes.append([(centers - reach).min(axis=0), (centers + reach).max(axis=0)])
    return np.stack([np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)])


def rotation_matrices(quaternions: NDArray) -> NDArray[np.float64]:
    """Rotation matrices (k, 3, 3), for column vectors, of unit quaternions (k, 4) x, y, z, w."""
    x, y, z, w = np.asarray(quaternions, np.float64).T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1),
            np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1),
            np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1),
        ],
        axis=-2,
    )


def turned(rotations: NDArray, point: NDArray) -> NDArray[np.float64]:
    """One point (3,) turned by each of the unit quaternions (k, 4) x, y, z, w: (k, 3).

    Without a matrix for each, and slice by slice: millions of instances need no more memory than
    the answer.
    """
    point = np.asarray(point, np.float64)
    found = np.empty((len(rotations), 3))
    for start in range(0, len(rotations), _SLICE):
        q = np.asarray(rotations[start : start + _SLICE], np.float64)
        twice = 2 * np.cross(q[:, :3], point)
        found[start : start + _SLICE] = point + q[:, 3:] * twice + np.cross(q[:, :3], twice)
    return found


def quaternions(matrices: NDArray) -> NDArray[np.float32]:
    """Unit quaternions (k, 4) x, y, z, w of (nearly) orthonormal matrices (k, 3, 3).

    The matrix's own small errors (file rounding) are removed by the normalisation. Takes, for each
    matrix, the numerically largest of the four equivalent forms.
    """
    m = np.asarray(matrices, np.float64)
    xx, yy, zz = m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz], -1)
    largest = squares.argmax(axis=-1)
    xy, xz, yz = m[:, 0, 1] + m[:, 1, 0], m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1]
    wx, wy, wz = m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]
    forms = np.stack(
        [
            np.stack([squares[:, 0], xy, xz, wx], -1),
            np.stack([xy, squares[:, 1], yz, wy], -1),
            np.stack([xz, yz, squares[:, 2], wz], -1),
            np.stack([wx, wy, wz, squares[:, 3]], -1),
        ],
        axis=1,
    )
    q = forms[np.arange(len(m)), largest]
    return (q / np.linalg.norm(q, axis=-1, keepdims=True)).astype(np.float32)
