"""GROMACS GRO: fixed columns, nanometres, numbers that wrap at 99,999."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.columns import fixed_floats, fixed_integers, strip
from scuro.load.lines import Lines
from scuro.load.source import Source
from scuro.load.table import AtomTable

ANGSTROM = 10.0
"""Å in a nanometre."""
_NO_BOX = np.zeros((3, 3))


def read_table(source: Source) -> AtomTable:
    """All frames; the frame's number is the model.

    Raises:
        LoadError: The count is missing, the file ends before it, or a number cannot be read.
    """
    lines = Lines(source.data)
    chosen, model, ends = _frames(source, lines)

    def bad(axis: str):
        return lambda i: LoadError(
            source.name, f"the atom's {axis} cannot be read", int(chosen[i]) + 1
        )

    # the distance between decimal points gives the columns' width (more digits are allowed)
    head = bytes(lines.codes[chosen[0]])
    points = [i for i, c in enumerate(head) if c == ord(".") and i >= 20]
    width = points[1] - points[0] if len(points) >= 2 else 8
    positions = np.empty((len(chosen), 3), np.float32)
    for axis in range(3):
        first = 21 + axis * width
        text = lines.columns(chosen, first, first + width - 1)
        positions[:, axis] = ANGSTROM * fixed_floats(text, bad("xyz"[axis]))
    number, _ = fixed_integers(lines.columns(chosen, 1, 5))
    serial, _ = fixed_integers(lines.columns(chosen, 16, 20))
    return AtomTable(
        name=source.stem,
        positions=positions,
        atom_name=strip(lines.columns(chosen, 11, 15)),
        residue_name=strip(lines.columns(chosen, 6, 10)),
        residue_number=number.astype(np.int32),
        chain=np.zeros(len(chosen), np.int32),
        chain_names=("",),
        serial=serial,
        model=model,
        boxes=np.stack(
            [_box(bytes(lines.codes[end])) if end < len(lines.codes) else _NO_BOX for end in ends]
        ),
    )


def _box(line: bytes) -> NDArray[np.float64]:
    """(3, 3) rows of a box: three lengths, and for slanted ones six more; zeros if unreadable."""
    try:
        numbers = [ANGSTROM * float(word) for word in line.split()]
    except ValueError:
        return _NO_BOX
    if len(numbers) not in (3, 9):
        return _NO_BOX
    x, y, z = numbers[:3]
    # the file's order: v1(x) v2(y) v3(z) v1(y) v1(z) v2(x) v2(z) v3(x) v3(y)
    a, b, c, d, e, f = numbers[3:] or [0.0] * 6
    return np.array([[x, a, b], [c, y, d], [e, f, z]])


def _frames(source: Source, lines: Lines) -> tuple[np.ndarray, np.ndarray, list[int]]:
    """Lines of the atoms, the model of each, and the lines of the boxes."""
    chosen: list[NDArray] = []
    models: list[NDArray] = []
    ends: list[int] = []
    at, total = 0, len(lines.codes)
    while at + 1 < total and bytes(lines.codes[at : at + 2]).strip():
        count_text = bytes(lines.codes[at + 1]).strip()
        if not count_text.isdigit():
            raise LoadError(source.name, "expected the number of atoms: not a GRO file?", at + 2)
        count = int(count_text)
        if at + 2 + count > total:
            raise LoadError(
                source.name, f"{count} atoms are announced, but the file ends before", at + 2
            )
        chosen.append(np.arange(at + 2, at + 2 + count))
        models.append(np.full(count, len(models) + 1, np.int32))
        ends.append(at + 2 + count)  # the box's line ends the frame
        at += 3 + count
    if not chosen or not sum(map(len, chosen)):
        raise LoadError(source.name, "has no atoms")
    return np.concatenate(chosen), np.concatenate(models), ends
