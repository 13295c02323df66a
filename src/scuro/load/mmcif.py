"""mmCIF's categories, from text or binary files, to a table of atoms."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.assembly import expand_operators, part
from scuro.load.elements import atomic_numbers
from scuro.load.source import Source
from scuro.load.table import AtomTable, FileBonds, Links, SecondaryRanges, first_seen, strings
from scuro.scene.molecule import HELIX, STRAND, AssemblyPart

_ATOM_COLUMNS = (
    "group_PDB id type_symbol label_atom_id auth_atom_id label_alt_id label_comp_id auth_comp_id "
    "label_asym_id auth_asym_id label_entity_id label_seq_id auth_seq_id pdbx_PDB_ins_code "
    "Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv pdbx_formal_charge pdbx_PDB_model_num"
)
ATOM_COLUMNS = frozenset(_ATOM_COLUMNS.split())
"""The columns of ``atom_site`` that are read."""


class Column(Protocol):
    """What text and binary columns have in common."""

    def bytes_(self) -> NDArray[np.bytes_]: ...
    def numbers(self, missing: float = 0) -> NDArray: ...


class File(Protocol):
    """A CIF file, text or binary."""

    name: str

    def category(self, name: str) -> Mapping[str, Column]: ...


def read_text(source: Source) -> AtomTable:
    """The atoms of an mmCIF file, see :func:`read_table`."""
    from scuro.load.cif import TextCif

    return read_table(source, TextCif(source.data, ATOM_COLUMNS))


def read_binary(source: Source) -> AtomTable:
    """The atoms of a BinaryCIF file, see :func:`read_table`."""
    from scuro.load.bcif import BinaryCif

    return read_table(source, BinaryCif(source.data))


def read_table(source: Source, file: File) -> AtomTable:
    """The atoms and what the file says of them.

    Raises:
        LoadError: No atoms.
    """
    site = file.category("atom_site")
    if not {"Cartn_x", "Cartn_y", "Cartn_z"} <= site.keys():
        raise LoadError(
            source.name, "has no atoms (no table atom_site with Cartn_x, Cartn_y and Cartn_z)"
        )
    positions = np.stack(
        [site[f"Cartn_{axis}"].numbers(np.nan).astype(np.float32) for axis in "xyz"], axis=1
    )
    count = len(positions)

    def words(*names: str) -> NDArray[np.bytes_] | None:
        """The first of these columns that holds anything."""
        for name in names:
            if name in site:
                values = site[name].bytes_()
                if (values != b"").any():
                    return values
        return None

    def required(*names: str) -> NDArray[np.bytes_]:
        values = words(*names)
        return np.zeros(count, "S1") if values is None else values

    def integers(name: str) -> NDArray | None:
        if name not in site:
            return None
        values = site[name].numbers(0)
        return values if values.dtype.kind in "iu" else np.nan_to_num(values).astype(np.int64)

    author = words("auth_asym_id", "label_asym_id")
    chain, labels = first_seen(required("label_asym_id", "auth_asym_id"))
    heads = np.unique(chain, return_index=True)[1]
    names = strings(labels if author is None else author[heads])
    index = {name: i for i, name in enumerate(strings(labels))}
    number = integers("auth_seq_id")
    sequence = integers("label_seq_id")
    if number is None or not number.any():
        number = sequence if sequence is not None else np.zeros(count, np.int64)
    entity_of_chain, entity_names, types = _entities(file, required("label_entity_id"), heads)
    symbols = words("type_symbol")
    return AtomTable(
        name=file.name or source.stem,
        positions=positions,
        atom_name=required("label_atom_id", "auth_atom_id"),
        residue_name=required("label_comp_id", "auth_comp_id"),
        residue_number=number.astype(np.int32),
        chain=chain,
        chain_names=names,
        element=None if symbols is None else atomic_numbers(symbols),
        insertion=words("pdbx_PDB_ins_code"),
        altloc=words("label_alt_id"),
        hetero=required("group_PDB") == b"HETATM",
        polymer=_polymer(types, entity_of_chain, chain, words("label_seq_id")),
        b_factor=_floats(site, "B_iso_or_equiv", 0.0),
        occupancy=_floats(site, "occupancy", 1.0),
        charge=None if (c := integers("pdbx_formal_charge")) is None else c.astype(np.int8),
        serial=integers("id"),
        model=None if (m := integers("pdbx_PDB_model_num")) is None else m.astype(np.int32),
        chain_entity=entity_of_chain,
        entity_names=entity_names,
        bonds=FileBonds(links=_links(file, index)),
        secondary=_secondary(file, index),
        assemblies=_assemblies(file, index),
    )


def _floats(site: Mapping[str, Column], name: str, missing: float) -> NDArray[np.float32] | None:
    if name not in site:
        return None
    return np.nan_to_num(site[name].numbers(missing).astype(np.float32), nan=missing)


def _entities(
    file: File, of_atom: NDArray[np.bytes_], heads: NDArray[np.intp]
) -> tuple[NDArray[np.int32], tuple[str, ...], NDArray[np.bytes_] | None]:
    """Entity of each chain, entities' names, and their types (None where not given)."""
    of_chain, distinct = first_seen(of_atom[heads])
    table = file.category("entity")
    if "id" not in table:
        return of_chain, strings(distinct), None
    rows = {key: i for i, key in enumerate(table["id"].bytes_().tolist())}
    place = np.array([rows.get(key, -1) for key in distinct.tolist()])

    def column(name: str) -> NDArray[np.bytes_] | None:
        if name not in table:
            return None
        values = table[name].bytes_()
        return np.where(place >= 0, values[place], b"")

    described, types = column("pdbx_description"), column("type")
    names = strings(
        distinct if described is None else np.where(described == b"", distinct, described)
    )
    return of_chain, names, types


def _polymer(
    types: NDArray[np.bytes_] | None,
    of_chain: NDArray[np.int32],
    chain: NDArray[np.int32],
    sequence: NDArray[np.bytes_] | None,
) -> NDArray[np.int8] | None:
    """By the entity's type, else by whether the residue has a place in a sequence."""
    if types is not None and (types != b"").any():
        by_type = np.where(types == b"", -1, types == b"polymer").astype(np.int8)
        return by_type[of_chain][chain]
    return None if sequence is None else (sequence != b"").astype(np.int8)


def _texts(table: Mapping[str, Column], names: tuple[str, ...], count: int) -> NDArray[np.bytes_]:
    """(count, len(names)) text of several columns, empty where one is missing."""
    columns = [table[name].bytes_() if name in table else np.zeros(count, "S1") for name in names]
    return np.stack(columns, axis=1)


def _links(file: File, index: dict[str, int]) -> Links | None:
    """Covalent, disulfide and metal bonds of ``struct_conn`` within the asymmetric unit."""
    table = file.category("struct_conn")
    if "conn_type_id" not in table or "ptnr1_label_asym_id" not in table:
        return None
    kind = table["conn_type_id"].bytes_()
    count = len(kind)

    def both(pattern: str) -> NDArray[np.bytes_]:
        return _texts(table, (pattern.format(1), pattern.format(2)), count)

    symmetry = both("ptnr{}_symmetry")
    chosen = (kind != b"hydrog") & (symmetry[:, 0] == symmetry[:, 1])
    names = both("ptnr{}_label_asym_id")[chosen]
    number = both("ptnr{}_auth_seq_id")[chosen]
    chain = [index.get(name.decode("latin-1"), -1) for name in names.ravel().tolist()]
    return Links(
        chain=np.array(chain, np.int32).reshape(-1, 2),
        number=_whole(number),
        insertion=both("pdbx_ptnr{}_PDB_ins_code")[chosen].astype("S1"),
        atom=both("ptnr{}_label_atom_id")[chosen],
    )


def _whole(values: NDArray[np.bytes_]) -> NDArray[np.int32]:
    """Whole numbers; 0 where the text is none."""
    good = [v.lstrip(b"-").isdigit() and len(v) < 10 for v in values.ravel().tolist()]
    return np.where(np.reshape(good, values.shape), values, b"0").astype(np.int32)


def _secondary(file: File, index: dict[str, int]) -> SecondaryRanges | None:
    parts = []
    conf, sheet = file.category("struct_conf"), file.category("struct_sheet_range")
    if "conf_type_id" in conf:
        kinds = conf["conf_type_id"].bytes_()
        kind = np.zeros(len(kinds), np.uint8)
        kind[np.char.startswith(kinds, b"HELX")] = HELIX
        kind[np.char.startswith(kinds, b"STRN")] = STRAND
        parts.append((conf, kind))
    if "beg_label_asym_id" in sheet:
        parts.append((sheet, np.full(len(sheet["beg_label_asym_id"].bytes_()), STRAND, np.uint8)))
    if not parts:
        return None
    columns: dict[str, list[NDArray]] = {
        key: [] for key in ("kind", "chain", "first", "first_ins", "last", "last_ins")
    }
    for table, kind in parts:
        names = _texts(
            table,
            ("beg_label_asym_id", "beg_auth_seq_id", "pdbx_beg_PDB_ins_code", "end_auth_seq_id",
             "pdbx_end_PDB_ins_code"),
            len(kind),
        )  # fmt: skip
        named = [index.get(name.decode("latin-1"), -1) for name in names[:, 0].tolist()]
        columns["kind"].append(kind)
        columns["chain"].append(np.array(named, np.int32))
        columns["first"].append(_whole(names[:, 1]))
        columns["first_ins"].append(names[:, 2].astype("S1"))
        columns["last"].append(_whole(names[:, 3]))
        columns["last_ins"].append(names[:, 4].astype("S1"))
    kind, chain, first, first_ins, last, last_ins = (np.concatenate(c) for c in columns.values())
    good = (kind > 0) & (chain >= 0)
    return SecondaryRanges(
        kind[good], chain[good], first[good], first_ins[good], last[good], last_ins[good]
    )


def _assemblies(file: File, index: dict[str, int]) -> dict[str, tuple[AssemblyPart, ...]]:
    rows, operators = file.category("pdbx_struct_assembly_gen"), _operators(file)
    if not operators or "oper_expression" not in rows or "asym_id_list" not in rows:
        return {}
    expressions = rows["oper_expression"].bytes_()
    table = _texts(rows, ("assembly_id", "oper_expression", "asym_id_list"), len(expressions))
    found: dict[str, list[AssemblyPart]] = {}
    for key, expression, asym in table.astype(str).tolist():
        chains = tuple(index[name] for name in asym.replace(" ", "").split(",") if name in index)
        products = [
            reduce(np.matmul, (operators[name] for name in names))
            for names in expand_operators(expression)
            if all(name in operators for name in names)
        ]
        if chains and products:
            found.setdefault(key, []).append(part(chains, np.stack(products)[:, :3]))
    return {key: tuple(parts) for key, parts in found.items()}


def _operators(file: File) -> dict[str, NDArray[np.float64]]:
    """(4, 4) matrices of ``pdbx_struct_oper_list`` by name."""
    table = file.category("pdbx_struct_oper_list")
    tags = [f"matrix[{i}][{j}]" for i in (1, 2, 3) for j in (1, 2, 3)]
    shifts = [f"vector[{i}]" for i in (1, 2, 3)]
    if not {"id", *tags, *shifts} <= table.keys():
        return {}
    names = strings(table["id"].bytes_())
    matrices = np.tile(np.eye(4), (len(names), 1, 1))
    matrices[:, :3, :3] = np.stack([table[t].numbers(0) for t in tags], 1).reshape(-1, 3, 3)
    matrices[:, :3, 3] = np.stack([table[t].numbers(0) for t in shifts], 1)
    good = np.flatnonzero(np.isfinite(matrices).all(axis=(1, 2)))
    return {names[i]: matrices[i] for i in good}
