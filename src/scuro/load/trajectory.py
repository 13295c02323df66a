"""Trajectories of molecular dynamics, and ensembles: one molecule, many sets of positions.

Frames are read when asked for, by biotraj (its import takes a fifth of MDAnalysis's).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.build import build, chosen_rows
from scuro.load.options import LoadOptions
from scuro.load.source import Source, open_source
from scuro.load.structure_table import read_table
from scuro.load.table import AtomTable
from scuro.scene.molecule import Molecule

_READERS = {
    ".xtc": ("XTCTrajectoryFile", 10.0),
    ".trr": ("TRRTrajectoryFile", 10.0),
    ".dcd": ("DCDTrajectoryFile", 1.0),
}
"""Suffix to biotraj's reader and Å per unit of length."""
LEAP = 15.0
"""Å; no atom moves so far from one frame to the next but across the walls of a periodic box."""


class Frames(Protocol):
    """Sets of positions of all atoms of a file."""

    def __len__(self) -> int: ...
    def positions(self, frame: int) -> NDArray[np.float32]:
        """(n, 3), Å."""
        ...


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A molecule in motion; topology, bonds and secondary structure are those of ``molecule``."""

    molecule: Molecule
    """At the first frame."""
    frames: Frames
    rows: NDArray[np.intp]
    """Which of the file's atoms the molecule has."""

    @classmethod
    def open(cls, format: str, source: Source, options: LoadOptions) -> Trajectory:
        """A topology of any structure format, and the trajectory that the options name.

        Without a trajectory, the models of the file are the frames.

        Raises:
            LoadError: Either file is damaged, or they differ in their numbers of atoms.
        """
        table = read_table(format, source)
        if table.model is not None:
            first = table.model == table.model[0]
            models, table = _Models(source, table), _first_model(table, first)
        else:
            models = _Models(source, table)
        frames: Frames = models
        if options.trajectory is not None:
            frames = _File(open_source(options.trajectory), len(table))
        table.positions = frames.positions(0)
        options = options.replace(model="first")
        return cls(build(source, table, options), frames, chosen_rows(source, table, options))

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.frames)

    def positions(self, frame: int) -> NDArray[np.float32]:
        """(n, 3) positions of the molecule's atoms, Å; negative frames count from the end.

        Raises:
            LoadError: No such frame, or it cannot be read.
        """
        count = len(self.frames)
        if not -count <= frame < count:
            raise LoadError(
                self.molecule.source, f"there is no frame {frame}; it has 0 to {count - 1}"
            )
        return np.ascontiguousarray(self.frames.positions(frame % count)[self.rows])

    def between(self, place: float) -> NDArray[np.float32]:
        """(n, 3) positions at a fractional frame, Å: on straight ways from one to the next.

        An atom that leaps farther than :data:`LEAP` was put back into its periodic box: it jumps
        half-way instead of flying across.

        Raises:
            LoadError: No such frame, or it cannot be read.
        """
        low = int(place)
        share = np.float32(place - low)
        if place < 0:
            raise LoadError(self.molecule.source, f"frame {place:g} is before the first")
        if share == 0:
            return self.positions(low)
        a, b = self.positions(low), self.positions(low + 1)
        way = b - a
        made: NDArray[np.float32] = a + way * share
        leap = np.abs(way).max(axis=1) > LEAP
        made[leap] = (b if share >= 0.5 else a)[leap]
        return made

    def at(self, frame: float) -> Molecule:
        """The molecule at a frame; shares all but the positions with :attr:`molecule`.

        Between two frames it is where :meth:`between` says.
        """
        return dataclasses.replace(
            self.molecule,
            positions=self.positions(int(frame)) if frame == int(frame) else self.between(frame),
            models=len(self),
            # functions, so that nothing is worked out before it is needed
            bonds=lambda _: self.molecule.bonds,
            bond_order=lambda _: self.molecule.bond_order,
            secondary=lambda _: self.molecule.secondary,
        )


def open_trajectory(
    name: str | Path,
    trajectory: str | Path | None = None,
    *,
    format: str | None = None,
    **changes: Any,
) -> Trajectory:
    """A structure in motion.

    Args:
        name: The topology: any structure file (or PDB ID) that :func:`scuro.load.load` reads.
        trajectory: XTC, TRR or DCD file; without it the models of ``name`` are the frames.
        format: The topology's format, where its name does not say.
        changes: Single options by name, e.g. ``waters=False``.

    Raises:
        LoadError: A file is missing or damaged, or the two do not fit together.
    """
    from scuro.load import find_reader

    source = open_source(name)
    _, reader = find_reader(source, format)
    options = LoadOptions(trajectory=None if trajectory is None else str(trajectory), **changes)
    return Trajectory.open(reader.removeprefix("read_"), source, options)


class _Models:
    """The models of one file as frames."""

    def __init__(self, source: Source, table: AtomTable) -> None:
        numbers = np.ones(len(table), np.int32) if table.model is None else table.model
        sizes = np.diff(np.r_[0, np.flatnonzero(np.diff(numbers)) + 1, len(table)])
        if (sizes != sizes[0]).any():
            raise LoadError(source.name, "its models differ in their atoms: it is no trajectory")
        self.all = table.positions.reshape(len(sizes), int(sizes[0]), 3)

    def __len__(self) -> int:
        return len(self.all)

    def positions(self, frame: int) -> NDArray[np.float32]:
        return self.all[frame]


class _File:
    """A trajectory file, opened once; frames are sought."""

    def __init__(self, source: Source, atoms: int) -> None:
        self.source = source
        if source.path is None or source.suffix not in _READERS:
            known = ", ".join(_READERS)
            raise LoadError(source.name, f"is not a trajectory file ({known})")
        reader, self.scale = _READERS[source.suffix]
        self.file = self._guarded(lambda: _open(reader, source.path))
        self.count = self._guarded(lambda: len(self.file))
        if self.count == 0:
            raise LoadError(source.name, "has no frames")
        found = len(self.positions(0))
        if found != atoms:
            raise LoadError(source.name, f"has {found} atoms, its structure has {atoms}")

    def __len__(self) -> int:
        return self.count

    def positions(self, frame: int) -> NDArray[np.float32]:
        def read() -> NDArray[np.float32]:
            self.file.seek(frame)
            return self.file.read(n_frames=1)[0][0]

        found = self._guarded(read) * np.float32(self.scale)
        if not np.isfinite(found).all():
            raise LoadError(self.source.name, f"frame {frame} has coordinates that are not numbers")
        return found.astype(np.float32, copy=False)

    def _guarded(self, action: Any) -> Any:
        try:
            return action()
        except Exception as error:
            said = " ".join(str(error).split())[:120] or type(error).__name__
            raise LoadError(self.source.name, f"is damaged or cut off ({said})") from error


def _open(reader: str, path: Path | None) -> Any:
    import biotraj

    return getattr(biotraj, reader)(str(path))


def _first_model(table: AtomTable, first: NDArray[np.bool_]) -> AtomTable:
    """The rows of the first model."""
    columns: dict[str, Any] = {
        f.name: value[first]
        for f in dataclasses.fields(table)
        if isinstance(value := getattr(table, f.name), np.ndarray) and len(value) == len(table)
        if f.name != "chain_entity"
    }
    return dataclasses.replace(table, **columns)
