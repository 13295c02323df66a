"""What a PDB file says besides its atoms: entities, helices and strands, bonds, assemblies."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from scuro.load.assembly import part
from scuro.load.columns import fixed_integers, strip
from scuro.load.lines import Lines
from scuro.load.source import Source
from scuro.load.table import FileBonds, Links, SecondaryRanges
from scuro.scene.molecule import HELIX, STRAND, AssemblyPart


def read_secondary(lines: Lines, chains: tuple[str, ...]) -> SecondaryRanges | None:
    """HELIX and SHEET records; None where there are none."""
    helix, sheet = lines.of(b"HELIX "), lines.of(b"SHEET ")
    if len(helix) + len(sheet) == 0:
        return None
    index = {name: i for i, name in enumerate(chains)}

    def both(helix_columns: tuple[int, int], sheet_columns: tuple[int, int]) -> NDArray[np.bytes_]:
        return strip(
            np.concatenate(
                [lines.columns(helix, *helix_columns), lines.columns(sheet, *sheet_columns)]
            )
        )

    names = both((20, 20), (22, 22))
    chain = np.array([index.get(n.decode("latin-1"), -1) for n in names.tolist()], np.int32)
    first, bad_first = fixed_integers(both((22, 25), (23, 26)), hybrid=True)
    last, bad_last = fixed_integers(both((34, 37), (34, 37)), hybrid=True)
    kind = np.repeat(np.array([HELIX, STRAND], np.uint8), [len(helix), len(sheet)])
    good = (chain >= 0) & ~bad_first & ~bad_last
    return SecondaryRanges(
        kind=kind[good],
        chain=chain[good],
        first=first[good].astype(np.int32),
        first_insertion=both((26, 26), (27, 27))[good],
        last=last[good].astype(np.int32),
        last_insertion=both((38, 38), (38, 38))[good],
    )


def read_bonds(lines: Lines, chains: tuple[str, ...]) -> FileBonds:
    """CONECT (by serial; a bond told twice from the same atom is a double bond), LINK, SSBOND."""
    conect = lines.of(b"CONECT")
    pairs = []
    if len(conect):
        atom, bad_atom = fixed_integers(lines.columns(conect, 7, 11), hybrid=True)
        for first in (12, 17, 22, 27):
            other, bad = fixed_integers(lines.columns(conect, first, first + 4), hybrid=True)
            pairs.append(np.stack([atom, other], 1)[~bad & ~bad_atom])
    told = np.concatenate(pairs) if pairs else np.zeros((0, 2), np.int64)
    directed, counts = np.unique(told, axis=0, return_counts=True)
    order = np.where(counts > 1, np.minimum(counts, 3), 0).astype(np.uint8)
    return FileBonds(directed, order, links=_links(lines, chains))


def _links(lines: Lines, chains: tuple[str, ...]) -> Links | None:
    link, disulfide = lines.of(b"LINK  "), lines.of(b"SSBOND")
    if len(link) + len(disulfide) == 0:
        return None
    # bonds into other asymmetric units have a symmetry operator that is not 1555
    foreign = [strip(lines.columns(link, 67, 72)), strip(lines.columns(disulfide, 67, 72))]
    link = link[(foreign[0] == b"1555") | (foreign[0] == b"")]
    disulfide = disulfide[(foreign[1] == b"1555") | (foreign[1] == b"")]
    index = {name: i for i, name in enumerate(chains)}

    def ends(link_first: tuple[int, int], bridge_first: tuple[int, int], width: int) -> NDArray:
        found = []
        for a, b in zip(link_first, bridge_first, strict=True):
            texts = [lines.columns(link, a, a + width - 1)]
            texts.append(lines.columns(disulfide, b, b + width - 1))
            found.append(strip(np.concatenate(texts)))
        return np.stack(found, 1)

    names = ends((22, 52), (16, 30), 1)
    chain = np.array([index.get(n.decode("latin-1"), -1) for n in names.ravel().tolist()], np.int32)
    number, bad = fixed_integers(ends((23, 53), (18, 32), 4).ravel(), hybrid=True)
    atom = [
        strip(np.r_[lines.columns(link, c, c + 3), np.full(len(disulfide), b"SG")])
        for c in (13, 43)
    ]
    chain = np.where(bad, -1, chain)
    return Links(
        chain=chain.reshape(-1, 2),
        number=number.reshape(-1, 2).astype(np.int32),
        insertion=ends((27, 57), (22, 36), 1),
        atom=np.stack(atom, 1),
    )


def read_entities(
    lines: Lines, chains: tuple[str, ...]
) -> tuple[NDArray[np.int32] | None, tuple[str, ...]]:
    """COMPND: the entity of each chain, and their names; (None, ()) where it says nothing."""
    rows = lines.of(b"COMPND")
    told = " ".join(s.decode("latin-1").strip() for s in lines.columns(rows, 11, 80).tolist())
    names: list[str] = []
    entity = np.full(len(chains), -1, np.int32)
    index = {name: i for i, name in enumerate(chains)}
    for block in re.split(r"MOL_ID\s*:", told)[1:]:
        name = re.search(r"MOLECULE\s*:\s*([^;]*)", block)
        owned = re.search(r"CHAIN\s*:\s*([^;]*)", block)
        if owned is None:
            continue
        names.append(name.group(1).strip() if name else f"molecule {len(names) + 1}")
        for chain in re.split(r"[,\s]+", owned.group(1).strip()):
            if chain in index:
                entity[index[chain]] = len(names) - 1
    if not names:
        return None, ()
    if (entity < 0).any():
        entity[entity < 0] = len(names)
        names.append("other")
    return entity, tuple(names)


_BIOMOLECULE = re.compile(r"^REMARK 350 BIOMOLECULE:\s*(\S+)")
_CHAINS = re.compile(r"^REMARK 350 (?:APPLY THE FOLLOWING TO CHAINS|\s+AND CHAINS)\s*:(.*)")
_MATRIX_ROW = re.compile(r"^REMARK 350\s+BIOMT([123])(.*)")


def read_assemblies(
    source: Source, lines: Lines, chains: tuple[str, ...]
) -> dict[str, tuple[AssemblyPart, ...]]:
    """REMARK 350: biological assemblies as operators on chains.

    Rows are split on white space, not by columns: programs write serials and values wider than
    the format allows.
    """
    rows = lines.of(b"REMARK")
    remark = rows[lines.columns(rows, 8, 10) == b"350"]
    index = {name: i for i, name in enumerate(chains)}
    found: dict[str, list[tuple[list[int], list[list[float]]]]] = {}
    current: list[tuple[list[int], list[list[float]]]] = found.setdefault("1", [])
    for line in (bytes(codes).decode("latin-1").rstrip() for codes in lines.codes[remark]):
        if match := _MATRIX_ROW.match(line):
            values = _row(match.group(2))
            if values is None:
                continue
            if not current:
                current.append((list(range(len(chains))), []))
            current[-1][1].append(values)
        elif match := _CHAINS.match(line):
            named = [c for c in re.split(r"[,\s]+", match.group(1)) if c]
            # no chain named means all of them
            owned = [index[c] for c in named if c in index] if named else list(index.values())
            if current and not current[-1][1]:
                current[-1][0].extend(owned)  # a second line of chains before the matrices
            else:
                current.append((owned, []))
        elif match := _BIOMOLECULE.match(line):
            current = found.setdefault(match.group(1).rstrip(","), [])
    assemblies = {}
    for key, parts in found.items():
        # chains that a part names but the file does not have are left out: splits of large entries
        made = [
            part(tuple(owned), np.array(values[: len(values) // 3 * 3]).reshape(-1, 3, 4))
            for owned, values in parts
            if owned and len(values) >= 3
        ]
        if made:
            assemblies[key] = tuple(made)
    return assemblies


def _row(text: str) -> list[float] | None:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return None
    return values[-4:] if len(values) == 5 and np.isfinite(values).all() else None
