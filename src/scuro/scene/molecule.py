"""A molecule: atoms, bonds and what the file says of them, as plain arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError

POLYMER_PROTEIN, POLYMER_NUCLEIC, LIGAND, SOLVENT, ION, OTHER_POLYMER = range(6)
"""Values of :attr:`Molecule.kind`."""

COIL, HELIX, STRAND = range(3)
"""Values of :attr:`Molecule.secondary` (one per residue)."""


T = TypeVar("T")


class Deferred(Generic[T]):
    """A dataclass field given as a value, or as a function of the object, called on first use.

    Bonds and secondary structure cost more than all the rest of loading, and a space-filling
    picture needs neither.
    """

    def __init__(self, default: Callable[[Any], T]) -> None:
        self.default = default

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> Callable[[Any], T]: ...
    @overload
    def __get__(self, instance: object, owner: type) -> T: ...
    def __get__(self, instance: object | None, owner: type) -> T | Callable[[Any], T]:
        if instance is None:  # the dataclass asks for the default
            return self.default
        value = instance.__dict__[self.name]
        if callable(value):
            value = instance.__dict__[self.name] = value(instance)
        return value

    def __set__(self, instance: object, value: T | Callable[[Any], T]) -> None:
        # reached from the dataclass's __init__ only: a frozen dataclass refuses assignment
        instance.__dict__[self.name] = value


@dataclass(frozen=True, eq=False)
class AssemblyPart:
    """Some chains of a biological assembly and the operators that place them.

    ``chains`` are indices into :attr:`Molecule.chain_names`; ``rotations`` (k, 4) unit quaternions
    x, y, z, w and ``positions`` (k, 3) take file coordinates to the assembly.
    """

    chains: tuple[int, ...]
    rotations: NDArray[np.float32]
    positions: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Molecule:
    """Atoms in file order; every per-atom array has length n. Ångström.

    ``residue[i]`` and ``chain[i]`` are zero-based indices into the per-residue and per-chain
    arrays. A residue is a run of atoms; a chain need not be (PDB files append a chain's ligands
    and waters after all polymers).
    """

    name: str
    positions: NDArray[np.float32]
    """(n, 3)"""
    element: NDArray[np.uint8]
    """Atomic number; 0 where unknown."""
    atom_name: NDArray[np.str_]
    residue: NDArray[np.int32]
    chain: NDArray[np.int32]
    kind: NDArray[np.uint8]
    """POLYMER_PROTEIN … OTHER_POLYMER."""
    hetero: NDArray[np.bool_]
    b_factor: NDArray[np.float32]
    """Å², or pLDDT for predicted structures."""
    occupancy: NDArray[np.float32]
    altloc: NDArray[np.str_]
    formal_charge: NDArray[np.int8]
    serial: NDArray[np.int32]
    """The number that the file gives the atom."""
    model: NDArray[np.int32]
    """The file's model number, where several models were loaded together; else all 1."""

    residue_name: NDArray[np.str_]
    """Per residue."""
    residue_number: NDArray[np.int32]
    """Per residue: author's number."""
    insertion_code: NDArray[np.str_]
    """Per residue; empty where none."""

    chain_names: tuple[str, ...]
    """Per chain: author's name. May repeat: mmCIF numbers a chain's ligands as chains of their
    own (``label_asym_id``) under the same author's name."""
    chain_entity: NDArray[np.int32]
    """Per chain: zero-based entity index."""
    entity_names: tuple[str, ...] = ()

    secondary: Deferred[NDArray[np.uint8]] = Deferred(
        lambda molecule: np.full(len(molecule.residue_name), COIL, np.uint8)
    )
    """Per residue: COIL, HELIX or STRAND; worked out on first use."""
    bonds: Deferred[NDArray[np.int32]] = Deferred(lambda molecule: np.zeros((0, 2), np.int32))
    """(m, 2) atom indices, each bond once, lower index first; worked out on first use."""
    bond_order: Deferred[NDArray[np.uint8]] = Deferred(
        lambda molecule: np.zeros(len(molecule.bonds), np.uint8)
    )
    """(m,): 1, 2, 3; 4 aromatic; 0 unknown; worked out on first use."""

    assemblies: dict[str, tuple[AssemblyPart, ...]] = field(default_factory=dict)
    """Biological assemblies by their id in the file."""
    source: str = ""
    """The path or ID it was read from."""
    notes: tuple[str, ...] = ()
    """What the reader mended or dropped, one sentence each."""
    secondary_from: str = ""
    """``"file"`` or ``"assigned"`` (P-SEA)."""
    radius: NDArray[np.float32] | None = None
    """Per-atom radii where the file gives them (sphere files, coarse grains); else None."""
    models: int = 1
    """How many models the file has, of which these atoms are the chosen ones."""

    def __len__(self) -> int:
        """Number of atoms."""
        return len(self.positions)

    def assembly(self, key: str) -> tuple[AssemblyPart, ...]:
        """The biological assembly of this id.

        Raises:
            LoadError: The file has none of that id.
        """
        if key not in self.assemblies:
            known = ", ".join(self.assemblies)
            why = f"it has {known}" if known else "it has none: leave out the assembly"
            raise LoadError(self.source or self.name, f"there is no assembly '{key}'; {why}")
        return self.assemblies[key]

    @cached_property
    def bounds(self) -> NDArray[np.float32]:
        """(2, 3) box around the atoms' centres."""
        if len(self) == 0:
            return np.zeros((2, 3), np.float32)
        return np.stack([self.positions.min(axis=0), self.positions.max(axis=0)])

    def summary(self) -> dict[str, Any]:
        """What ``scuro info`` prints."""
        from scuro.scene.describe import describe

        return describe(self)


def first_atoms(molecule: Molecule) -> NDArray[np.intp]:
    """First atom of each residue."""
    if len(molecule) == 0:
        return np.zeros(0, np.intp)
    return np.flatnonzero(np.r_[True, molecule.residue[1:] != molecule.residue[:-1]])
