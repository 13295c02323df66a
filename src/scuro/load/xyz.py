"""XYZ: a count, a comment, and a line ``symbol x y z`` for each atom; frames follow each other."""

from __future__ import annotations

import numpy as np

from scuro.errors import LoadError
from scuro.load.columns import fixed_floats
from scuro.load.elements import SYMBOLS, atomic_numbers
from scuro.load.source import Source
from scuro.load.table import AtomTable

_BY_NUMBER = np.array([s.encode() for s in SYMBOLS])


def read_table(source: Source) -> AtomTable:
    """All frames; the frame's number is the model. Symbols may be atomic numbers.

    Raises:
        LoadError: A count or coordinate cannot be read, or a frame is cut off (names the line).
    """
    data = source.data
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    codes = np.frombuffer(data, np.uint8)
    # starts[i] is where line i begins; one more entry closes the last line
    starts = np.r_[0, np.flatnonzero(codes == ord("\n")) + 1]
    if starts[-1] != len(data):
        starts = np.r_[starts, len(data) + 1]
    lines = len(starts) - 1
    frames, line = [], 0
    while line < lines:
        head = data[starts[line] : starts[line + 1]].split()
        if not head:
            line += 1
            continue
        if len(head) != 1 or not head[0].isdigit():
            raise LoadError(source.name, "expected the number of atoms: not an XYZ file?", line + 1)
        count = int(head[0])
        if line + 2 + count > lines:
            raise LoadError(
                source.name, f"{count} atoms are announced, but the file ends before", line + 1
            )
        if count:
            body = data[starts[line + 2] : starts[line + 2 + count]].split()
            if len(body) % count or len(body) < 4 * count:
                raise LoadError(source.name, "an atom's line has not 'symbol x y z'", line + 3)
            frames.append(np.array(body).reshape(count, -1)[:, :4])
        line += 2 + count
    if not frames:
        raise LoadError(source.name, "has no atoms")
    sizes = [len(frame) for frame in frames]
    cells = np.concatenate(frames)

    def bad(i: int) -> LoadError:
        return LoadError(source.name, f"the coordinates of atom {i // 3 + 1} cannot be read")

    positions = fixed_floats(cells[:, 1:4].ravel(), bad).reshape(-1, 3)
    symbols = cells[:, 0]
    numeric = np.char.isdigit(symbols)
    if numeric.any():
        number = np.minimum(np.where(numeric, symbols, b"0").astype(np.int64), len(SYMBOLS) - 1)
        symbols = np.where(numeric, _BY_NUMBER[number], symbols)
    count = len(cells)
    return AtomTable(
        name=source.stem,
        positions=positions.astype(np.float32),
        atom_name=symbols,
        residue_name=np.full(count, b"LIG"),
        residue_number=np.ones(count, np.int32),
        chain=np.zeros(count, np.int32),
        chain_names=("",),
        element=atomic_numbers(symbols),
        model=np.repeat(np.arange(1, len(frames) + 1), sizes).astype(np.int32),
        polymer=np.zeros(count, np.int8),
    )
