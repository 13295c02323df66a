"""Trajectories of molecular dynamics, and ensembles: one molecule, many sets of positions."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.build import build, chosen_rows
from scuro.load.options import LoadOptions
from scuro.load.periodic import Holder, shortest_height
from scuro.load.source import Source, open_source
from scuro.load.structure_table import read_table
from scuro.load.table import AtomTable
from scuro.load.trajectory_frames import Frames, ModelFrames, TrajectoryFile
from scuro.scene.molecule import Molecule


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A molecule in motion; topology, bonds and secondary structure are those of ``molecule``."""

    molecule: Molecule
    """At the first frame."""
    frames: Frames
    rows: NDArray[np.intp]
    """Which of the file's atoms the molecule has."""
    holder: Holder
    """Puts each frame together and holds it in place."""

    @classmethod
    def open(cls, format: str, source: Source, options: LoadOptions) -> Trajectory:
        """A topology of any structure format, and the trajectory that the options name.

        Without a trajectory, the models of the file are the frames.

        Raises:
            LoadError: Either file is damaged, or they differ in their numbers of atoms.
        """
        return cls.of(source, read_table(format, source), options)

    @classmethod
    def of(cls, source: Source, table: AtomTable, options: LoadOptions) -> Trajectory:
        """The same of a structure that was read."""
        models = ModelFrames(source, table)
        if table.model is not None:
            table = _first_model(table, table.model == table.model[0])
        frames: Frames = models
        if options.trajectory is not None:
            frames = TrajectoryFile(open_source(options.trajectory), len(table))
        positions, box = frames.read(0)
        table.positions = positions.copy()
        table.notes += frames.notes
        options = options.replace(model="first")
        rows = chosen_rows(source, table, options)
        molecule = build(source, table, options)
        holder = Holder(molecule, positions[rows], box, options.whole, options.hold)
        # before bonds and secondary structure are worked out, which then see whole molecules
        molecule.positions[:] = holder(positions[rows], box)
        return cls(molecule, frames, rows, holder)

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.frames)

    @property
    def timed(self) -> bool:
        """Whether frames follow each other in time, rather than being models side by side."""
        return not isinstance(self.frames, ModelFrames)

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
        positions, box = self.frames.read(frame % count)
        return np.ascontiguousarray(self.holder(positions[self.rows], box))

    def between(self, place: float) -> NDArray[np.float32]:
        """(n, 3) positions at a fractional frame, Å: on straight ways from one to the next.

        What leaps farther than half a periodic box crossed its walls: it jumps half-way instead of
        flying across.

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
        _, box = self.frames.read(low)
        if box is not None:
            leap = np.linalg.norm(way, axis=1) > shortest_height(box) / 2
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


def _first_model(table: AtomTable, first: NDArray[np.bool_]) -> AtomTable:
    """The rows of the first model."""
    columns: dict[str, Any] = {
        f.name: value[first]
        for f in dataclasses.fields(table)
        if isinstance(value := getattr(table, f.name), np.ndarray) and len(value) == len(table)
        if f.name not in ("chain_entity", "boxes")
    }
    return dataclasses.replace(table, **columns)
