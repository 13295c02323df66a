"""From a file's table of atoms to a :class:`~scuro.scene.molecule.Molecule`."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load import bonds, secondary
from scuro.load.elements import infer
from scuro.load.kind import name_classes, residue_kinds
from scuro.load.options import LoadOptions
from scuro.load.source import Source
from scuro.load.table import AtomTable, first_seen, text
from scuro.scene.molecule import ION, LIGAND, SOLVENT, Molecule


def build(source: Source, table: AtomTable, options: LoadOptions) -> Molecule:
    """Choose atoms by the options and group them into residues and chains.

    Raises:
        LoadError: No atoms, coordinates that are not finite, no such model, or nothing left.
    """
    notes = list(table.notes)
    rows, element, kind = _choose(source, table, options, notes)
    return _molecule(source, table, rows, element, kind, notes)


def chosen_rows(source: Source, table: AtomTable, options: LoadOptions) -> NDArray[np.intp]:
    """Rows of the table that :func:`build` keeps.

    Raises:
        LoadError: As :func:`build`.
    """
    return _choose(source, table, options, [])[0]


def _choose(
    source: Source, table: AtomTable, options: LoadOptions, notes: list[str]
) -> tuple[NDArray[np.intp], NDArray[np.uint8], NDArray[np.uint8]]:
    """Rows to keep, and element and kind of all rows."""
    if len(table) == 0:
        raise LoadError(source.name, "has no atoms")
    _check_finite(source, table)
    keep = _chosen_model(source, table, options)
    keep &= _chosen_altlocs(table, options, keep, notes)
    heads, residue = _residues(table)
    element = _elements(table)
    kind = residue_kinds(table, heads, residue, element)[residue]
    if not options.hydrogens:
        keep &= element != 1
    if not options.waters:
        keep &= kind != SOLVENT
    if not options.ligands:
        keep &= (kind != LIGAND) & (kind != ION)
    if not keep.any():
        raise LoadError(source.name, "nothing is left of it: the options drop all of its atoms")
    return np.flatnonzero(keep), element, kind


def _check_finite(source: Source, table: AtomTable) -> None:
    wrong = ~np.isfinite(table.positions).all(axis=1)
    if wrong.all():
        raise LoadError(
            source.name, "has no coordinates; name the trajectory that has them (option trajectory)"
        )
    if wrong.any():
        first = int(np.argmax(wrong))
        raise LoadError(
            source.name,
            f"{int(wrong.sum())} atoms have coordinates that are not numbers, the first is atom "
            f"{first + 1} ({table.atom_name[first].decode('latin-1')})",
        )


def _chosen_model(source: Source, table: AtomTable, options: LoadOptions) -> NDArray[np.bool_]:
    if options.model == "all":
        return np.ones(len(table), bool)
    model = np.ones(len(table), np.int32) if table.model is None else table.model
    number = int(model[0]) if options.model == "first" else int(options.model)
    keep = model == number
    if not keep.any():
        there = np.unique(model)
        span = f"only {there[0]}" if len(there) == 1 else f"{len(there)}: {there[0]} to {there[-1]}"
        raise LoadError(source.name, f"there is no model {number}; it has {span}")
    return keep


def _sites(table: AtomTable) -> NDArray[np.bool_]:
    """Whether each atom begins a new place in a chain (whatever residue stands there)."""
    new = np.ones(len(table), bool)
    new[1:] = table.chain[1:] != table.chain[:-1]
    for column in (table.residue_number, table.insertion, table.model):
        if column is not None:
            new[1:] |= column[1:] != column[:-1]
    return new


def _residues(table: AtomTable) -> tuple[NDArray[np.intp], NDArray[np.int32]]:
    """First atom of each residue, and each atom's residue."""
    new = _sites(table)
    new[1:] |= table.residue_name[1:] != table.residue_name[:-1]
    return np.flatnonzero(new), (np.cumsum(new) - 1).astype(np.int32)


def _chosen_altlocs(
    table: AtomTable, options: LoadOptions, candidates: NDArray[np.bool_], notes: list[str]
) -> NDArray[np.bool_]:
    """One alternate location per residue: that of highest mean occupancy (first letter in ties).

    Chosen per residue, not per atom, so that what is kept is one conformation.
    """
    keep = np.ones(len(table), bool)
    if table.altloc is None or options.altloc == "all":
        return keep
    rows = np.flatnonzero((table.altloc != b"") & candidates)
    if len(rows) == 0:
        return keep
    if options.altloc != "highest":
        keep[rows] = table.altloc[rows] == options.altloc.encode("latin-1", "replace")
    else:
        site = np.cumsum(_sites(table))[rows]
        letter, letters = _letters(table.altloc[rows])
        key = site * len(letters) + letter
        groups, member = np.unique(key, return_inverse=True)
        occupancy = np.ones(len(rows)) if table.occupancy is None else table.occupancy[rows]
        mean = np.bincount(member, occupancy) / np.bincount(member)
        order = np.lexsort((groups, -mean.round(4), groups // len(letters)))
        place = groups[order] // len(letters)
        best = order[np.r_[True, place[1:] != place[:-1]]]
        keep[rows] = np.isin(member, best)
    dropped = int((~keep[candidates]).sum())
    if dropped:
        notes.append(f"{dropped} atoms at other alternate locations were left out")
    return keep


def _letters(altloc: NDArray[np.bytes_]) -> tuple[NDArray[np.intp], NDArray]:
    letters, inverse = np.unique(altloc, return_inverse=True)
    return inverse.ravel(), letters


def _elements(table: AtomTable) -> NDArray[np.uint8]:
    """The file's elements; where it has none, inferred from the atom's and residue's names."""
    if table.element is not None and table.element.all():
        return table.element
    element = np.zeros(len(table), np.uint8) if table.element is None else table.element.copy()
    rows = np.flatnonzero(element == 0)
    names = table.atom_name if table.padded_name is None else table.padded_name
    name, name_values = first_seen(names[rows])
    residue, residue_values = first_seen(table.residue_name[rows])
    _, amino, nucleic = name_classes(residue_values)
    pairs, inverse = np.unique(
        name.astype(np.int64) * len(residue_values) + residue, return_inverse=True
    )
    width = names.dtype.itemsize if table.padded_name is not None else 0
    numbers = [
        # numpy strips trailing NULs only, but padded names end in blanks: restore their width
        infer(
            name_values[pair // len(residue_values)].ljust(width),
            residue_values[pair % len(residue_values)],
            bool((amino | nucleic)[pair % len(residue_values)]),
        )
        for pair in pairs.tolist()
    ]
    element[rows] = np.array(numbers, np.uint8)[inverse.ravel()]
    return element


def _molecule(
    source: Source,
    table: AtomTable,
    rows: NDArray[np.intp],
    element: NDArray[np.uint8],
    kind: NDArray[np.uint8],
    notes: list[str],
) -> Molecule:
    kept = len(rows) < len(table)

    def take(column: NDArray | None, default: float, dtype: type) -> NDArray:
        if column is None:
            return np.full(len(rows), default, dtype)
        return (column[rows] if kept else column).astype(dtype, copy=False)

    def take_text(column: NDArray[np.bytes_] | None) -> NDArray[np.str_]:
        return text(np.zeros(len(rows), "S1") if column is None else column[rows])

    heads, residue = _residues_of(table, rows)
    first = rows[heads]
    entity = table.chain_entity
    if entity is None:
        entity = np.zeros(len(table.chain_names), np.int32)
    ranges = table.secondary
    return Molecule(
        name=table.name,
        positions=np.ascontiguousarray(take(table.positions, 0, np.float32)),
        element=element[rows],
        atom_name=take_text(table.atom_name),
        residue=residue,
        chain=take(table.chain, 0, np.int32),
        kind=kind[rows],
        hetero=take(table.hetero, False, np.bool_),
        b_factor=take(table.b_factor, 0.0, np.float32),
        occupancy=take(table.occupancy, 1.0, np.float32),
        altloc=take_text(table.altloc),
        formal_charge=take(table.charge, 0, np.int8),
        serial=(rows + 1 if table.serial is None else table.serial[rows]).astype(np.int32),
        model=take(table.model, 1, np.int32),
        residue_name=text(table.residue_name[first]),
        residue_number=table.residue_number[first].astype(np.int32),
        insertion_code=text(
            np.zeros(len(first), "S1") if table.insertion is None else table.insertion[first]
        ),
        chain_names=table.chain_names,
        chain_entity=entity,
        entity_names=table.entity_names,
        secondary=(secondary.assign if ranges is None else partial(secondary.from_ranges, ranges)),
        secondary_from="assigned" if ranges is None else "file",
        **bonds.deferred(table.bonds),
        assemblies=table.assemblies,
        source=source.name,
        notes=tuple(notes),
        radius=None if table.radius is None else table.radius[rows],
        models=1 if table.model is None else 1 + int(np.count_nonzero(np.diff(table.model))),
    )


def _residues_of(
    table: AtomTable, rows: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.int32]]:
    """First of ``rows`` in each residue, and the residue of each row, numbered without gaps."""
    _, of_all = _residues(table)
    mine = of_all[rows]
    new = np.ones(len(rows), bool)
    new[1:] = mine[1:] != mine[:-1]
    return np.flatnonzero(new), (np.cumsum(new) - 1).astype(np.int32)
