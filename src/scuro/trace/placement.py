"""Where everything stands: the rows of the instance table, and which grid lists them.

Instances of bodies come first, body by body; then the frames of assemblies, each of which is an
instance whose object is the assembly. Instances within an assembly are in its own space, about the
middle of its box, and are listed by the assembly's grid; all others by the grid over the scene.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError
from scuro.scene.geometry import Body, Frames, turned
from scuro.trace.pack import PackedGeometry

INSTANCE = np.dtype([("rotation", np.float32, 4), ("center", np.float32, 3), ("object", np.uint32)])
"""``Instance`` of wgsl/scene.wgsl: 32 bytes."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """Bodies that are placed together."""

    frames: Frames
    bodies: tuple[int, ...]
    middle: NDArray[np.float64]
    """(3,) of the box around all of it, in its own space."""
    row: int
    """Of its first frame."""
    radius: float
    """Of a sphere around the middle that holds all of it."""


@dataclass(frozen=True, eq=False)
class Placement:
    """The instance table of a scene."""

    instances: NDArray
    """INSTANCE records."""
    spheres: NDArray[np.float32]
    """(n, 4) bounding sphere of each row, in the space of its position."""
    rows: tuple[int, ...]
    """First row of each body's instances."""
    numbers: tuple[int, ...]
    """Number of each body's first instance in the G-buffer: instances within frames count."""
    listed: tuple[NDArray[np.int64], ...]
    """Rows that each grid over instances lists: that over the scene, then one an assembly."""
    assemblies: tuple[Assembly, ...]
    of_body: tuple[int | None, ...]
    """For each body its assembly."""
    opaque: bool
    """Whether all bodies are."""

    @property
    def frames(self) -> int:
        """Rows at the end that are frames of assemblies."""
        return sum(len(a.frames.positions) for a in self.assemblies)

    @property
    def single(self) -> bool:
        """Whether all is one opaque instance of one body."""
        return len(self.instances) == 1 and self.opaque


def place(bodies: Sequence[Body], center: NDArray, packed: dict[int, PackedGeometry]) -> Placement:
    """Lay out the instances of bodies around a scene's ``center``.

    Raises:
        GpuError: There are more instances than can be numbered.
    """
    groups: dict[int, list[int]] = {}
    for index, body in enumerate(bodies):
        if body.frames is not None and len(body.positions) and len(body.frames.positions):
            groups.setdefault(id(body.frames), []).append(index)
    rows = np.cumsum([0, *(len(body.positions) for body in bodies)])
    numbers = np.cumsum([0, *(body.instances for body in bodies)], dtype=np.int64)
    if numbers[-1] >= 0xFFFFFFFF:
        raise GpuError(
            f"{numbers[-1]:,} instances are more than can be numbered (4,294,967,294): "
            "place fewer assemblies, or show less of each"
        )
    shared = [bodies[group[0]].frames for group in groups.values()]
    frames = sum(len(f.positions) for f in shared if f is not None)
    table = np.zeros(rows[-1] + frames, INSTANCE)
    spheres = np.zeros((len(table), 4), np.float32)
    assemblies: list[Assembly] = []
    of_body: list[int | None] = [None] * len(bodies)
    next_row = int(rows[-1])
    middles = [np.asarray(center, np.float64)] * len(bodies)
    for number, group in enumerate(groups.values()):
        boxes = [bodies[i].own_bounds for i in group if len(bodies[i].geometry)]
        low = np.min([b[0] for b in boxes], 0) if boxes else np.zeros(3)
        high = np.max([b[1] for b in boxes], 0) if boxes else np.zeros(3)
        for i in group:
            of_body[i], middles[i] = number, (low + high) / 2
        found = bodies[group[0]].frames
        assert found is not None
        assemblies.append(Assembly(found, tuple(group), (low + high) / 2, next_row, 0.0))
        next_row += len(found.positions)
    for index, body in enumerate(bodies):
        p = packed[id(body.geometry)]
        run = slice(rows[index], rows[index + 1])
        table[run]["rotation"] = body.rotations
        table[run]["center"] = body.positions + turned(body.rotations, p.middle) - middles[index]
        table[run]["object"] = index
        spheres[run, :3] = table[run]["center"]
        spheres[run, 3] = p.radius if len(p.primitives) else 0
    # an assembly that is placed nowhere is listed nowhere
    alone = [i for i, body in enumerate(bodies) if body.frames is None]
    listed = [[np.arange(rows[i], rows[i + 1]) for i in alone]]
    for number, assembly in enumerate(assemblies):
        inside = [np.arange(rows[i], rows[i + 1]) for i in assembly.bodies]
        own = spheres[np.concatenate(inside)].astype(np.float64)
        radius = float((np.linalg.norm(own[:, :3], axis=1) + own[:, 3]).max()) * 1.00001
        assemblies[number] = Assembly(
            assembly.frames, assembly.bodies, assembly.middle, assembly.row, radius
        )
        run = slice(assembly.row, assembly.row + len(assembly.frames.positions))
        table[run]["rotation"] = assembly.frames.rotations
        table[run]["center"] = (
            assembly.frames.positions + turned(assembly.frames.rotations, assembly.middle) - center
        )
        table[run]["object"] = len(bodies) + number
        spheres[run, :3] = table[run]["center"]
        spheres[run, 3] = radius
        listed[0].append(np.arange(run.start, run.stop))
        listed.append(inside)
    none = np.zeros(0, np.int64)
    return Placement(
        table,
        spheres,
        tuple(int(r) for r in rows[:-1]),
        tuple(int(n) for n in numbers[:-1]),
        tuple(np.concatenate([none, *parts]) for parts in listed),
        tuple(assemblies),
        tuple(of_body),
        all(body.material.opacity == 1 for body in bodies),
    )
