"""What every structure reader fills: one row per atom as the file has it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import AssemblyPart


@dataclass(frozen=True, eq=False)
class Links:
    """Bonds that the file gives by the atoms' names (LINK, SSBOND, ``struct_conn``).

    All arrays are (k, 2), one column per end.
    """

    chain: NDArray[np.int32]
    number: NDArray[np.int32]
    insertion: NDArray[np.bytes_]
    atom: NDArray[np.bytes_]


@dataclass(frozen=True, eq=False)
class FileBonds:
    """The bonds that the file gives."""

    serials: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """(k, 2) serial numbers of the bonded atoms."""
    order: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(0, np.uint8))
    """(k,) 1, 2, 3; 4 aromatic; 0 unknown."""
    complete: bool = False
    """Whether these are all bonds, so that none are to be added from templates or distances."""
    links: Links | None = None


@dataclass(frozen=True, eq=False)
class SecondaryRanges:
    """Helices and strands that the file gives, as ranges of residues; arrays of length k."""

    kind: NDArray[np.uint8]
    chain: NDArray[np.int32]
    first: NDArray[np.int32]
    first_insertion: NDArray[np.bytes_]
    last: NDArray[np.int32]
    last_insertion: NDArray[np.bytes_]


@dataclass(eq=False)
class AtomTable:
    """Atoms in file order, all models and alternate locations. Text columns are bytes.

    Optional columns that the file does not have stay None and get a constant.
    """

    name: str
    positions: NDArray[np.float32]
    """(n, 3), Å"""
    atom_name: NDArray[np.bytes_]
    residue_name: NDArray[np.bytes_]
    residue_number: NDArray[np.int32]
    chain: NDArray[np.int32]
    """Index into ``chain_names``."""
    chain_names: tuple[str, ...]
    element: NDArray[np.uint8] | None = None
    """Atomic number; 0 where the file does not say: it is then inferred from the name."""
    padded_name: NDArray[np.bytes_] | None = None
    """The four name columns of a PDB file, where the element begins in the first or the second."""
    insertion: NDArray[np.bytes_] | None = None
    altloc: NDArray[np.bytes_] | None = None
    hetero: NDArray[np.bool_] | None = None
    polymer: NDArray[np.int8] | None = None
    """1 part of a polymer, 0 not, -1 the file does not say."""
    b_factor: NDArray[np.floating] | None = None
    occupancy: NDArray[np.floating] | None = None
    charge: NDArray[np.int8] | None = None
    serial: NDArray[np.int64] | None = None
    model: NDArray[np.int32] | None = None
    radius: NDArray[np.float32] | None = None
    boxes: NDArray[np.floating] | None = None
    """(models, 3, 3) rows of the periodic box of each model, Å."""
    chain_entity: NDArray[np.int32] | None = None
    entity_names: tuple[str, ...] = ()
    bonds: FileBonds = field(default_factory=FileBonds)
    secondary: SecondaryRanges | None = None
    assemblies: dict[str, tuple[AssemblyPart, ...]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.positions)


def first_seen(values: NDArray) -> tuple[NDArray[np.int32], NDArray]:
    """Number the distinct values in order of first appearance.

    Returns:
        The number of each value, and the distinct values.
    """
    if len(values) == 0:
        return np.zeros(0, np.int32), values
    # long runs are the rule, so only the runs' heads are sorted
    heads = np.flatnonzero(np.r_[True, values[1:] != values[:-1]])
    distinct, first, inverse = np.unique(values[heads], return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    lengths = np.diff(np.r_[heads, len(values)])
    return np.repeat(rank[inverse.ravel()], lengths), distinct[order]


def text(values: NDArray[np.bytes_]) -> NDArray[np.str_]:
    """Bytes to text; what is not ASCII is read as Latin-1 (a ``U`` cast would raise)."""
    width = max(values.dtype.itemsize, 1)
    codes = np.ascontiguousarray(values).view(np.uint8).astype(np.uint32)
    return codes.view(f"U{width}") if len(values) else np.zeros(0, f"U{width}")


def strings(values: NDArray[np.bytes_]) -> tuple[str, ...]:
    """Bytes to a tuple of Python strings, surrounding blanks removed."""
    return tuple(value.decode("latin-1").strip() for value in values.tolist())
