"""The instance table: where each rigid placement of a geometry or an assembly stands.

Scenes of few instances keep single precision, in two texels each: the scene position of the
bounding sphere's centre with a tag, and the rotation as a unit quaternion. Large scenes keep 16
bytes, one texel:

- the position, 20 bits an axis: an error of at most 2⁻²¹ of the edge of a cube around the scene's
  centre, or an assembly's, that holds all its instances. This is 0.001 Å in a virus of 2,000 Å,
  0.01 Å in a cell-scale scene of 2 µm, and a 1,600th of a pixel where 1,280 pixels show it whole;
- the rotation, as the three smallest components of its unit quaternion, 17 bits each, and which one
  is left out ("smallest three": the largest follows from the unit length): an error of at most
  38 µrad, 0.023 Å at the surface of a virus of 600 Å (half as much is usual), 0.002 Å at that of
  a protein of 50 Å; none at all stays exact;
- a tag of 15 bits.

A tag is the object and, in the bits above it, the radius of the bounding sphere rounded up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError

OBJECT_BITS = 20
MOST_OBJECTS = 1 << OBJECT_BITS
PACKED_FROM = 1 << 16
"""Scenes of so many instances are packed."""

_TAG_BITS = 15
_RADIUS_BITS = 4
"""The fewest that packing leaves for radii: scenes of more than 2,048 objects are not packed."""
_PLACE = (1 << 19) - 1
_TURN = (1 << 16) - 1
"""Largest codes of a coordinate and of a quaternion's component, which is at most √½."""


@dataclass(frozen=True)
class Encoding:
    """How the rows of a scene's table are written: ``place_of`` of wgsl/scene_types.wgsl."""

    packed: bool
    object_bits: int
    """Lowest bits of a tag, which are the object."""
    radius_base: int
    """Bits of the smallest radius as a single: that of code 1."""
    radius_shift: int
    """A code counts so many of these bits up; code 0 is for what is listed nowhere."""
    steps: tuple[float, float]
    """Of packed coordinates: in the scene, in assemblies."""

    @property
    def constants(self) -> dict[str, float]:
        return {"PACKED": self.packed}

    @property
    def texels(self) -> int:
        """Of a row."""
        return 1 if self.packed else 2

    def uniform(self, inner: bool = False) -> dict[str, Any]:
        """Fields of a uniform that tell how to read what lies in the scene, or in assemblies."""
        return {
            "place_step": self.steps[int(inner)],
            "object_bits": self.object_bits,
            "radius_base": self.radius_base,
            "radius_shift": self.radius_shift,
        }

    def radius_code(self, radius: float) -> int:
        """A radius' code, never for less than it."""
        if radius <= 0:
            return 0
        above = int(np.float32(radius).view(np.uint32)) - self.radius_base
        return 1 + -(-above // (1 << self.radius_shift))

    def rows(
        self, centers: NDArray, rotations: NDArray, number: int, radius: float, inner: bool
    ) -> NDArray[np.uint32]:
        """The texels (k · texels, 4) of instances of one object.

        Args:
            centers: (k, 3) of their bounding spheres.
            rotations: (k, 4) unit quaternions x, y, z, w.
            number: Of the object.
            radius: Of the spheres; 0 for what is to be listed nowhere.
            inner: Whether they lie in an assembly.
        """
        tag = number | (self.radius_code(radius) << self.object_bits)
        if not self.packed:
            words = np.empty((len(centers), 2, 4), np.uint32)
            words[:, 0, :3] = np.ascontiguousarray(centers, np.float32).view(np.uint32)
            words[:, 0, 3] = tag
            words[:, 1] = np.ascontiguousarray(rotations, np.float32).view(np.uint32)
            return words.reshape(-1, 4)
        x, y, z = np.rint(centers / self.steps[int(inner)]).astype(np.int64).T & 0xFFFFF
        a, b, c, which = _smallest_three(rotations)
        whole = np.empty((len(centers), 2), np.uint64)
        whole[:, 0] = x | (y << 20) | (z << 40) | (which << 60) | (c >> 15 << 62)
        whole[:, 1] = tag | (a << 15) | (b << 32) | ((c & 0x7FFF) << 49)
        return whole.view(np.uint32).reshape(-1, 4)


def encoding_for(
    objects: int, rows: int, radii: Sequence[float], halves: tuple[float, float]
) -> Encoding:
    """How to keep a table.

    Args:
        objects: That it names.
        rows: Instances in it.
        radii: Of the objects' bounding spheres.
        halves: Largest coordinate of any instance: in the scene, in assemblies.

    Raises:
        GpuError: There are too many objects.
    """
    if objects > MOST_OBJECTS:
        raise GpuError(
            f"the scene has more than {MOST_OBJECTS:,} bodies: place copies of one structure as "
            "instances, or show less"
        )
    needed = max(1, (objects - 1).bit_length())
    packed = rows >= PACKED_FROM and needed <= _TAG_BITS - _RADIUS_BITS
    object_bits = needed if packed else OBJECT_BITS
    codes = (1 << ((_TAG_BITS if packed else 32) - object_bits)) - 2
    bits = np.array([r for r in radii if r > 0] or [1.0], np.float32).view(np.uint32)
    low, high = int(bits.min()), int(bits.max())
    shift = 0
    while -(-(high - low) >> shift) > codes:
        shift += 1
    steps = tuple(max(half, 1e-30) / _PLACE for half in halves)
    return Encoding(packed, object_bits, low, shift, (steps[0], steps[1]))


def _smallest_three(rotations: NDArray) -> tuple[NDArray[np.int64], ...]:
    """Codes of three components of unit quaternions (k, 4), and the number of the fourth."""
    q = np.asarray(rotations, np.float64)
    largest = np.abs(q).argmax(axis=1)
    q = q * np.where(q[np.arange(len(q)), largest] < 0, -1.0, 1.0)[:, None]
    others = q[np.arange(4) != largest[:, None]].reshape(-1, 3)
    codes = np.rint(others * (np.sqrt(2) * _TURN)).astype(np.int64) & 0x1FFFF
    return (*codes.T, largest)
