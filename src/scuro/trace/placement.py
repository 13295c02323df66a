"""Where everything stands: the rows of the instance table, and which grid lists them.

Instances of bodies come first, body by body; then the frames of assemblies, each of which is an
instance whose object is the assembly. Instances within an assembly are in its own space, about the
middle of its box, and are listed by the assembly's grid; all others by the grid over the scene.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import GpuError
from scuro.gpu import Gpu
from scuro.scene.geometry import Body, Frames, turned
from scuro.trace.instances import Encoding, encoding_for
from scuro.trace.pack import PackedGeometry
from scuro.trace.table import empty_table, fill_table

SLICE = 1 << 17
"""So many instances are put into the table in one step."""


@dataclass(frozen=True, eq=False)
class Run:
    """Rows of the instance table that belong to one object."""

    first: int
    """Its first row."""
    rotations: NDArray[np.float32]
    """(k, 4) unit quaternions."""
    positions: NDArray[np.float64]
    """(k, 3)"""
    middle: NDArray
    """(3,) of the object's box, in its own space: there lies the bounding sphere's centre."""
    origin: NDArray[np.float64]
    """(3,) what is taken off the positions."""
    number: int
    """Of the object."""
    radius: float
    """Of the bounding sphere; 0 if there is nothing in it."""
    inner: bool
    """Whether it lies in an assembly."""

    def __len__(self) -> int:
        return len(self.positions)

    def centers(self, start: int, stop: int) -> NDArray[np.float64]:
        """Of the bounding spheres of some of its rows."""
        turn = turned(self.rotations[start:stop], self.middle)
        return self.positions[start:stop] + turn - self.origin

    def slices(self) -> Iterable[tuple[int, int]]:
        """Starts and ends that divide it into steps of work."""
        return ((s, min(s + SLICE, len(self))) for s in range(0, len(self), SLICE))


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
    """What the instance table of a scene holds."""

    runs: tuple[Run, ...]
    """Of bodies, then of assemblies' frames."""
    numbers: tuple[int, ...]
    """Number of each body's first instance in the G-buffer: instances within frames count."""
    listed: tuple[tuple[tuple[int, int], ...], ...]
    """For each grid over instances (that over the scene, then one an assembly) the runs of rows
    that it lists: first and number."""
    assemblies: tuple[Assembly, ...]
    of_body: tuple[int | None, ...]
    """For each body its assembly."""
    opaque: bool
    """Whether all bodies are."""
    encoding: Encoding
    """How the rows are written."""

    def __len__(self) -> int:
        """Rows of the table."""
        return sum(len(run) for run in self.runs)

    @property
    def frames(self) -> int:
        """Rows at the end that are frames of assemblies."""
        return sum(len(a.frames.positions) for a in self.assemblies)

    @property
    def single(self) -> Run | None:
        """The only run, if all is one opaque instance of one body."""
        if len(self) != 1 or not self.opaque:
            return None
        return next(run for run in self.runs if len(run))

    def upload(self, gpu: Gpu) -> Generator[float, None, Any]:
        """Put the instance table of wgsl/scene.wgsl on the GPU, slice by slice."""
        code = self.encoding
        table = empty_table(gpu, code.texels * len(self), "rgba32uint", "instances")
        for run in self.runs:
            for start, stop in run.slices():
                centers, rotations = run.centers(start, stop), run.rotations[start:stop]
                rows = code.rows(centers, rotations, run.number, run.radius, run.inner)
                fill_table(gpu, table, code.texels * (run.first + start), rows)
                yield (run.first + stop) / len(self)
        return table


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
    origin = np.asarray(center, np.float64)
    origins = [origin] * len(bodies)
    of_body: list[int | None] = [None] * len(bodies)
    for number, group in enumerate(groups.values()):
        boxes = [bodies[i].own_bounds for i in group if len(bodies[i].geometry)]
        low = np.min([b[0] for b in boxes], 0) if boxes else np.zeros(3)
        high = np.max([b[1] for b in boxes], 0) if boxes else np.zeros(3)
        for i in group:
            of_body[i], origins[i] = number, (low + high) / 2
    runs = []
    for index, body in enumerate(bodies):
        p = packed[id(body.geometry)]
        radius = p.radius if len(p.primitives) else 0.0
        runs.append(
            Run(int(rows[index]), body.rotations, body.positions, p.middle, origins[index],
                index, radius, body.frames is not None)
        )  # fmt: skip
    # an assembly that is placed nowhere is listed nowhere
    listed = [[runs[i] for i, body in enumerate(bodies) if body.frames is None]]
    assemblies: list[Assembly] = []
    next_row = int(rows[-1])
    for number, group in enumerate(groups.values()):
        frames, middle = bodies[group[0]].frames, origins[group[0]]
        assert frames is not None
        inside = [runs[i] for i in group]
        radius = max((_reach(run) for run in inside), default=0.0) * 1.00001
        assemblies.append(Assembly(frames, tuple(group), middle, next_row, radius))
        run = Run(next_row, frames.rotations, frames.positions, middle, origin,
                  len(bodies) + number, radius, False)  # fmt: skip
        runs.append(run)
        listed[0].append(run)
        listed.append(inside)
        next_row += len(run)
    halves = tuple(
        max((_half(r) for r in runs if r.inner == i), default=0.0) for i in (False, True)
    )
    code = encoding_for(len(runs), next_row, [run.radius for run in runs], (halves[0], halves[1]))
    return Placement(
        tuple(runs),
        tuple(int(n) for n in numbers[:-1]),
        tuple(_rows(found) for found in listed),
        tuple(assemblies),
        tuple(of_body),
        all(body.material.opacity == 1 for body in bodies),
        code,
    )


def _reach(run: Run) -> float:
    """How far from its origin the bounding spheres of a run reach."""
    far = (np.linalg.norm(run.centers(*s), axis=1).max() for s in run.slices())
    return float(max(far, default=0.0)) + run.radius


def _half(run: Run) -> float:
    """Half the edge of a cube about its origin in which the centres of a run lie."""
    if not len(run):
        return 0.0
    low, high = run.positions.min(0) - run.origin, run.positions.max(0) - run.origin
    return float(np.maximum(-low, high).max() + np.linalg.norm(run.middle))


def _rows(runs: Iterable[Run]) -> tuple[tuple[int, int], ...]:
    """Runs of rows (first, number) that are not empty, those that adjoin joined."""
    found: list[tuple[int, int]] = []
    for run in runs:
        if len(run) and found and sum(found[-1]) == run.first:
            found[-1] = (found[-1][0], found[-1][1] + len(run))
        elif len(run):
            found.append((run.first, len(run)))
    return tuple(found)
