"""GRDECL text: keywords with numbers, ``n*value`` repeats, comments and INCLUDE files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.options import LoadOptions
from scuro.load.reservoir_build import build_grid
from scuro.load.source import Source, open_source
from scuro.scene.cornerpoint import CornerPointGrid

_KEYWORD = re.compile(r"^([A-Za-z][A-Za-z0-9_+-]{0,7})[ \t]*(?:/.*)?$", re.M)
_COMMENT = re.compile(r"--[^\n]*")
_REPEAT = re.compile(r"(?<![\w.])(\d+)\*(\S+)")
_QUOTED = re.compile(r"['\"]([^'\"]*)['\"]")
_FLAGS = {"METRIC": "METRES", "FIELD": "FEET", "LAB": "CM"}
DEEPEST_INCLUDE = 16


def read_grdecl(source: Source, options: LoadOptions) -> CornerPointGrid:
    """Read a text grid, and properties from files of its name with ``_something`` appended."""
    arrays: dict[str, NDArray] = {}
    texts: dict[str, str] = {}
    notes: list[str] = []
    _read_into(source, arrays, texts, notes, 0)
    for sibling in _siblings(source):
        extra: dict[str, NDArray] = {}
        try:
            _read_into(sibling, extra, texts, notes, 0)
        except LoadError as error:
            notes.append(f"{error}; left out")
            continue
        for name, values in extra.items():
            if name not in ("COORD", "ZCORN", "SPECGRID", "DIMENS"):
                arrays.setdefault(name, values)
    size = arrays.get("SPECGRID", arrays.get("DIMENS"))
    for needed, found in (("SPECGRID", size), ("COORD", arrays.get("COORD")),
                          ("ZCORN", arrays.get("ZCORN"))):  # fmt: skip
        if found is None or len(found) == 0:
            raise LoadError(source.name, f"has no {needed}: it is not a whole corner-point grid")
    assert size is not None
    if len(size) < 3 or not np.isfinite(size[:3]).all():
        raise LoadError(source.name, "SPECGRID needs the numbers of cells along i, j and k")
    dimensions = tuple(int(n) for n in size[:3])
    count = int(np.prod(dimensions))
    active = arrays.get("ACTNUM")
    if active is not None and active.size != count:
        raise LoadError(
            source.name, f"ACTNUM has {active.size:,} values, but the grid has {count:,} cells"
        )
    mask = slice(None) if active is None else active > 0
    statics = {}
    for name, values in arrays.items():
        if name in ("SPECGRID", "DIMENS", "COORD", "ZCORN", "ACTNUM", "MAPAXES"):
            continue
        if values.size == count:
            statics[name] = values[mask].astype(np.float32)
        elif values.size >= min(count, 20):
            notes.append(
                f"{name} has {values.size:,} values, but the grid has {count:,} cells: left out"
            )
    notes.append("a text grid has no time steps: no pressures or saturations")
    unit = (texts.get("GRIDUNIT", "") or texts.get("UNITS", "")).split()
    word = unit[0] if unit else None
    return build_grid(
        source,
        dimensions,
        arrays["COORD"],
        arrays["ZCORN"],
        active=active,
        unit=word,
        unit_system="",
        options=options,
        map_axes=None if "MAP" in unit[1:] else arrays.get("MAPAXES"),
        map_unit=(texts.get("MAPUNITS", "").split() or [""])[0],
        statics=statics,
        notes=notes,
    )


def _siblings(source: Source) -> Iterator[Source]:
    if source.path is None:
        return
    for path in sorted(source.path.parent.glob("*")):
        name = path.name.lower().removesuffix(".gz")
        if name.endswith(".grdecl") and name.startswith(f"{source.stem.lower()}_"):
            yield open_source(path)


def _read_into(
    source: Source,
    arrays: dict[str, NDArray],
    texts: dict[str, str],
    notes: list[str],
    depth: int,
) -> None:
    if depth > DEEPEST_INCLUDE:
        raise LoadError(source.name, "INCLUDE files nest too deep: do they include each other?")
    text = _COMMENT.sub("", source.text.replace("\r", ""))
    found = list(_KEYWORD.finditer(text))
    if not found:
        raise LoadError(source.name, "has no keywords: it is not a GRDECL file")
    ends = [m.start() for m in found[1:]] + [len(text)]
    for match, end in zip(found, ends, strict=True):
        keyword = match.group(1).upper()
        body = text[match.end() : end].partition("/")[0]
        if keyword in _FLAGS and not body.strip():
            texts.setdefault("UNITS", _FLAGS[keyword])
        elif keyword == "INCLUDE":
            whole = text[match.end() : end]  # the path may hold slashes
            included = _included(source, whole, text.count("\n", 0, match.start()) + 1)
            _read_into(included, arrays, texts, notes, depth + 1)
        elif keyword in ("GRIDUNIT", "MAPUNITS"):
            texts[keyword] = body.replace("'", " ").upper().strip() or "METRES"
        else:
            values = _numbers(body)
            if values is None:
                if keyword in ("COORD", "ZCORN", "SPECGRID", "ACTNUM"):
                    line = text.count("\n", 0, match.start()) + 1
                    raise LoadError(source.name, f"{keyword} has words that are not numbers", line)
            elif values.size:
                arrays[keyword] = values


def _included(source: Source, body: str, line: int) -> Source:
    quoted = _QUOTED.search(body)
    name = quoted.group(1) if quoted else body.strip().removesuffix("/").strip()
    path = (source.path.parent if source.path else Path()) / name
    if not name or not path.is_file():
        raise LoadError(source.name, f"includes '{name}', which is not there", line)
    return open_source(path)


def _numbers(body: str) -> NDArray[np.float64] | None:
    """The numbers of a keyword with repeats written out; None where they are not all numbers."""
    words = body.replace("'", " ").replace("D+", "E+").replace("D-", "E-").split()
    if not any("*" in w for w in words):
        try:
            return np.array([w for w in words if w not in "FfTt"], np.float64)
        except ValueError:
            return None
    counts, values = [], []
    for word in words:
        match = _REPEAT.fullmatch(word)
        if match is None and word.removesuffix("*").isdigit() and word.endswith("*"):
            match = re.fullmatch(r"(\d+)\*(.*)", word + "nan")  # "3*": three defaults
        count, value = match.groups() if match else (1, word)
        try:
            counts.append(int(count))
            values.append(float(value))
        except ValueError:
            return None
    if sum(counts) > 1 << 31:
        return None
    return np.repeat(np.array(values), counts)
