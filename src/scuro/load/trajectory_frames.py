"""Where the frames of a trajectory come from: a file of them, or the models of a structure file.

Trajectory files are read when asked for, by biotraj (its import takes a fifth of MDAnalysis's).
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.periodic import box_of
from scuro.load.source import Source
from scuro.load.table import AtomTable

_READERS = {
    ".xtc": ("XTCTrajectoryFile", 10.0),
    ".trr": ("TRRTrajectoryFile", 10.0),
    ".dcd": ("DCDTrajectoryFile", 1.0),
}
"""Suffix to biotraj's reader and Å per unit of length."""

Frame = tuple[NDArray[np.float32], NDArray[np.float64] | None]
"""Positions (n, 3) and the rows of the periodic box (3, 3), Å; None where there is no box."""


class Frames(Protocol):
    """Sets of positions of all atoms of a file."""

    notes: tuple[str, ...]
    """What the reader mended, one sentence each."""

    def __len__(self) -> int: ...
    def read(self, frame: int) -> Frame: ...


class ModelFrames:
    """The models of one file as frames.

    Raises:
        LoadError: They differ in their atoms.
    """

    notes: tuple[str, ...] = ()

    def __init__(self, source: Source, table: AtomTable) -> None:
        numbers = np.ones(len(table), np.int32) if table.model is None else table.model
        sizes = np.diff(np.r_[0, np.flatnonzero(np.diff(numbers)) + 1, len(table)])
        if (sizes != sizes[0]).any():
            raise LoadError(source.name, "its models differ in their atoms: it is no trajectory")
        self._all = table.positions.reshape(len(sizes), int(sizes[0]), 3)
        self._boxes = table.boxes

    def __len__(self) -> int:
        return len(self._all)

    def read(self, frame: int) -> Frame:
        return self._all[frame], box_of(None if self._boxes is None else self._boxes[frame])


class TrajectoryFile:
    """An XTC, TRR or DCD file, opened once; frames are sought.

    Args:
        source: The file.
        atoms: How many the structure has.

    Raises:
        LoadError: It is damaged, has no frames, or another number of atoms.
    """

    def __init__(self, source: Source, atoms: int) -> None:
        self.source = source
        if source.path is None or source.suffix not in _READERS:
            known = ", ".join(_READERS)
            raise LoadError(source.name, f"is not a trajectory file ({known})")
        reader, self._scale = _READERS[source.suffix]
        self._said: list[str] = []
        self._file = self._guarded(lambda: _open(reader, source.path))
        self._count = self._guarded(lambda: len(self._file))
        if self._count == 0:
            raise LoadError(source.name, "has no frames")
        found = len(self.read(0)[0])
        if found != atoms:
            raise LoadError(source.name, f"has {found} atoms, its structure has {atoms}")
        self.notes = tuple(f"{Path(source.name).name}: {said}" for said in self._said)

    def __len__(self) -> int:
        return self._count

    def read(self, frame: int) -> Frame:
        def take() -> Any:
            self._file.seek(frame)
            return self._file.read(n_frames=1)

        arrays = self._guarded(take)
        positions = arrays[0][0] * np.float32(self._scale)
        if not np.isfinite(positions).all():
            raise LoadError(self.source.name, f"frame {frame} has coordinates that are not numbers")
        return positions.astype(np.float32, copy=False), self._box(arrays)

    def _box(self, arrays: Any) -> NDArray[np.float64] | None:
        if self.source.suffix != ".dcd":
            box = arrays[3]
            return None if box is None else box_of(box[0] * self._scale)
        _, lengths, angles = arrays
        if lengths is None or angles is None:
            return None
        return box_of(cell_vectors(lengths[0], angles[0]))

    def _guarded(self, action: Any) -> Any:
        """What an action gives; what the library prints becomes notes, or part of the error."""
        with _captured() as printed:
            try:
                result, error = action(), None
            except Exception as raised:
                result, error = None, raised
        if error is not None:
            said = "; ".join([*printed, " ".join(str(error).split())])[:200]
            why = f"is damaged or cut off ({said or type(error).__name__})"
            raise LoadError(self.source.name, why) from error
        self._said += [line for line in printed if line not in self._said]
        return result


def cell_vectors(lengths: NDArray, degrees: NDArray) -> NDArray[np.float64]:
    """(3, 3) rows of a unit cell from its lengths a, b, c and angles α, β, γ; a lies along x."""
    a, b, c = np.asarray(lengths, np.float64)
    cos_a, cos_b, cos_c = np.cos(np.radians(np.asarray(degrees, np.float64)))
    sin_c = np.sqrt(max(1 - cos_c**2, 0))
    y = (cos_a - cos_b * cos_c) / sin_c if sin_c else 0.0
    z = np.sqrt(max(1 - cos_b**2 - y**2, 0))
    return np.array([[a, 0, 0], [b * cos_c, b * sin_c, 0], [c * cos_b, c * y, c * z]])


def _open(reader: str, path: Path | None) -> Any:
    import biotraj

    return getattr(biotraj, reader)(str(path))


@contextlib.contextmanager
def _captured() -> Iterator[list[str]]:
    """Lines that compiled code prints meanwhile, instead of showing them.

    The readers print warnings straight to the process's output, where they would mix with what a
    command prints.
    """
    lines: list[str] = []
    with tempfile.TemporaryFile() as kept, contextlib.ExitStack() as restored:
        for stream in (1, 2):
            restored.enter_context(_redirected(stream, kept.fileno()))
        try:
            yield lines
        finally:
            restored.close()
            kept.seek(0)
            text = kept.read().decode("utf-8", "replace")
            lines += [_plain(line) for line in text.splitlines() if line.strip()]


@contextlib.contextmanager
def _redirected(stream: int, to: int) -> Iterator[None]:
    """Send what is written to a file descriptor to another one, C's buffers included."""
    flush = ctypes.CDLL(None).fflush if os.name == "posix" else lambda _: None
    for python in (sys.stdout, sys.stderr):
        python.flush()
    flush(None)
    try:
        before = os.dup(stream)
    except OSError:  # closed: nothing can be printed there
        yield
        return
    os.dup2(to, stream)
    try:
        yield
    finally:
        flush(None)
        os.dup2(before, stream)
        os.close(before)


def _plain(line: str) -> str:
    """A printed line without who said it."""
    _, _, said = line.rpartition("plugin) ")
    return said.removeprefix("Warning: ").strip()
