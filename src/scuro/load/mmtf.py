"""MMTF, the PDB's former compressed format (retired in 2024, still found in archives).

The format: https://github.com/rcsb/mmtf/blob/master/spec.md. MessagePack with encoded columns;
residues refer to shared templates (``groupList``) that hold atom names, elements and bonds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray

from scuro.load.assembly import part
from scuro.load.bcif import MAX_LENGTH
from scuro.load.elements import atomic_numbers
from scuro.load.source import Source
from scuro.load.table import AtomTable, FileBonds, SecondaryRanges, strings
from scuro.scene.molecule import COIL, HELIX, STRAND, AssemblyPart

_DSSP = np.array([HELIX, COIL, HELIX, STRAND, HELIX, COIL, COIL, COIL], np.uint8)
"""By MMTF's code: pi helix, bend, alpha helix, extended, 3-10 helix, bridge, turn, coil."""


def read_table(source: Source) -> AtomTable:
    """The atoms, bonds, secondary structure and assemblies of an MMTF file."""
    raw = msgpack.unpackb(source.data, strict_map_key=False)
    file: dict[str, Any] = {
        key: _decode(v) if isinstance(v, bytes) else v for key, v in raw.items()
    }
    group_type = np.asarray(file["groupTypeList"], np.int64)
    groups = file["groupList"]
    sizes = np.array([len(g["atomNameList"]) for g in groups])
    group_of_atom = np.repeat(np.arange(len(group_type)), sizes[group_type])
    starts = np.r_[0, np.cumsum(sizes[group_type])]
    # each atom's place among all templates' atoms, laid end to end
    place = (np.r_[0, np.cumsum(sizes)][group_type] - starts[:-1])[group_of_atom]
    place += np.arange(len(group_of_atom))

    def of_template(key: str) -> NDArray:
        return np.array([value for g in groups for value in g[key]])[place]

    chain_of_group = np.repeat(np.arange(len(file["groupsPerChain"])), file["groupsPerChain"])
    model_of_chain = np.repeat(np.arange(len(file["chainsPerModel"])), file["chainsPerModel"])
    names = _names(file.get("chainNameList", file["chainIdList"]))
    entity, entity_names, polymer = _entities(file.get("entityList", []), len(names))
    chain = chain_of_group[group_of_atom].astype(np.int32)
    positions = np.stack([file[f"{axis}CoordList"] for axis in "xyz"], axis=1).astype(np.float32)
    if len(positions) != len(place):
        raise ValueError(f"{len(positions)} coordinates for {len(place)} atoms")
    group_names = np.array([g["groupName"].encode("latin-1", "replace") for g in groups])
    return AtomTable(
        name=str(file.get("structureId", source.stem)),
        positions=positions,
        atom_name=of_template("atomNameList").astype("S"),
        residue_name=group_names[group_type][group_of_atom],
        residue_number=np.asarray(file["groupIdList"])[group_of_atom].astype(np.int32),
        chain=chain,
        chain_names=names,
        element=atomic_numbers(of_template("elementList").astype("S")),
        insertion=_letters(file.get("insCodeList"), len(group_type))[group_of_atom],
        altloc=_letters(file.get("altLocList"), len(place)),
        hetero=~polymer[chain],
        polymer=polymer[chain].astype(np.int8),
        b_factor=_optional(file.get("bFactorList"), len(place)),
        occupancy=_optional(file.get("occupancyList"), len(place)),
        charge=of_template("formalChargeList").astype(np.int8),
        # the file's serials may repeat; its bonds count atoms by place
        serial=np.arange(1, len(place) + 1),
        model=(model_of_chain[chain] + 1).astype(np.int32),
        chain_entity=entity,
        entity_names=entity_names,
        bonds=_bonds(file, groups, group_type, starts),
        secondary=_secondary(file, chain_of_group),
        assemblies=_assemblies(file.get("bioAssemblyList", []), len(names)),
    )


def _names(values: Any) -> tuple[str, ...]:
    if isinstance(values, np.ndarray):
        return strings(values)
    return tuple(str(value) for value in values)


def _letters(values: NDArray | None, count: int) -> NDArray[np.bytes_]:
    if values is None or len(values) != count:
        return np.zeros(count, "S1")
    return np.ascontiguousarray(values, np.uint8).view("S1")


def _optional(values: NDArray | None, count: int) -> NDArray[np.float32] | None:
    return None if values is None or len(values) != count else values.astype(np.float32)


def _entities(
    entities: list[Mapping[str, Any]], chains: int
) -> tuple[NDArray[np.int32], tuple[str, ...], NDArray[np.bool_]]:
    """Entity of each chain, entities' names, and whether each chain is a polymer."""
    entity = np.zeros(chains, np.int32)
    polymer = np.zeros(chains, bool)
    for i, found in enumerate(entities):
        mine = [c for c in found["chainIndexList"] if 0 <= c < chains]
        entity[mine] = i
        polymer[mine] = found.get("type") == "polymer"
    return entity, tuple(str(e.get("description", "")) for e in entities), polymer


def _bonds(
    file: Mapping[str, Any],
    groups: list[Mapping[str, Any]],
    group_type: NDArray,
    starts: NDArray,
) -> FileBonds:
    """Bonds of the templates, repeated for every residue, and those between residues."""
    pairs, orders = [], []
    for number, group in enumerate(groups):
        local = np.array(group.get("bondAtomList", []), np.int64).reshape(-1, 2)
        order = np.array(group.get("bondOrderList", []), np.int64)
        if len(local) == 0:
            continue
        first = starts[:-1][group_type == number]
        pairs.append((first[:, None, None] + local).reshape(-1, 2))
        orders.append(
            np.tile(order if len(order) == len(local) else np.zeros(len(local)), len(first))
        )
    between = np.asarray(file.get("bondAtomList", []), np.int64).reshape(-1, 2)
    order = np.asarray(file.get("bondOrderList", []), np.int64)
    pairs.append(between)
    orders.append(order if len(order) == len(between) else np.zeros(len(between)))
    joined = np.concatenate(orders)
    joined[(joined < 1) | (joined > 3)] = 0
    return FileBonds(np.concatenate(pairs) + 1, joined.astype(np.uint8), complete=True)


def _secondary(file: Mapping[str, Any], chain: NDArray) -> SecondaryRanges | None:
    codes = file.get("secStructList")
    if codes is None or len(codes) != len(chain) or (codes < 0).all():
        return None
    kind = np.where((codes >= 0) & (codes < 8), _DSSP[np.clip(codes, 0, 7)], COIL)
    new = np.r_[True, (kind[1:] != kind[:-1]) | (chain[1:] != chain[:-1])]
    first = np.flatnonzero(new)
    last = np.r_[first[1:], len(kind)] - 1
    chosen = kind[first] != COIL
    first, last = first[chosen], last[chosen]
    number = np.asarray(file["groupIdList"], np.int32)
    insertion = _letters(file.get("insCodeList"), len(chain))
    return SecondaryRanges(
        kind=kind[first],
        chain=chain[first].astype(np.int32),
        first=number[first],
        first_insertion=insertion[first],
        last=number[last],
        last_insertion=insertion[last],
    )


def _assemblies(
    assemblies: list[Mapping[str, Any]], chains: int
) -> dict[str, tuple[AssemblyPart, ...]]:
    found = {}
    for number, assembly in enumerate(assemblies, 1):
        parts: dict[tuple[int, ...], list[NDArray]] = {}
        for transform in assembly["transformList"]:
            mine = tuple(c for c in transform["chainIndexList"] if 0 <= c < chains)
            matrix = np.array(transform["matrix"], np.float64).reshape(4, 4)
            parts.setdefault(mine, []).append(matrix[:3])
        made = tuple(part(c, np.stack(m)) for c, m in parts.items() if c)
        if made:
            found[str(assembly.get("name") or number)] = made
    return found


def _decode(data: bytes) -> NDArray:
    """One encoded column: codec, length and parameter (big-endian int32), then the payload."""
    codec, length, parameter = np.frombuffer(data[:12], ">i4").tolist()
    values = _CODECS[codec](data[12:], parameter)
    if len(values) != length:
        raise ValueError(f"a column has {len(values)} values instead of {length}")
    return values


def _big(type: str) -> Callable[[bytes, int], NDArray]:
    return lambda data, _: np.frombuffer(data, f">{type}").astype(type)


def _runs(data: bytes) -> NDArray:
    pairs = np.frombuffer(data, ">i4").reshape(-1, 2).astype(np.int64)
    if (pairs[:, 1] < 0).any() or pairs[:, 1].sum() > MAX_LENGTH:
        raise ValueError("a run length is damaged")
    return np.repeat(pairs[:, 0], pairs[:, 1])


def _recursive(data: bytes, type: str) -> NDArray:
    """Recursive indexing: limits of the type are added up until another value ends the sum."""
    values = np.frombuffer(data, f">{type}").astype(type)
    limits = np.iinfo(type)
    ends = np.flatnonzero((values != limits.max) & (values != limits.min))
    return np.diff(np.cumsum(values, dtype=np.int64)[ends], prepend=0)


_CODECS: dict[int, Callable[[bytes, int], NDArray]] = {
    1: _big("f4"),
    2: _big("i1"),
    3: _big("i2"),
    4: _big("i4"),
    5: lambda data, width: np.char.rstrip(np.frombuffer(data, f"S{width}"), b"\0"),
    6: lambda data, _: _runs(data),
    7: lambda data, _: _runs(data),
    8: lambda data, _: np.cumsum(_runs(data)),
    9: lambda data, divisor: _runs(data) / divisor,
    10: lambda data, divisor: np.cumsum(_recursive(data, "i2")) / divisor,
    11: lambda data, divisor: np.frombuffer(data, ">i2") / divisor,
    12: lambda data, divisor: _recursive(data, "i2") / divisor,
    13: lambda data, divisor: _recursive(data, "i1") / divisor,
    14: lambda data, _: _recursive(data, "i2"),
    15: lambda data, _: _recursive(data, "i1"),
    16: lambda data, _: _runs(data),
}
