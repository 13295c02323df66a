"""WGSL structs as numpy dtypes, so that a uniform is filled by field name.

Alignment and size follow the WGSL specification, section "Alignment and Size". Matrices are stored
column by column, hence a 4×4 numpy matrix is transposed on the way in.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from scuro.errors import ShaderError

_SCALARS = {"f32": np.float32, "i32": np.int32, "u32": np.uint32}
_SUFFIX = {"f": "f32", "i": "i32", "u": "u32"}
_STRUCT = re.compile(r"\bstruct\s+(\w+)\s*\{(.*?)\}", re.S)
_FIELD = re.compile(r"(?:@\w+(?:\([^)]*\))?\s*)*(\w+)\s*:\s*(.+)", re.S)


@dataclass(frozen=True)
class WgslType:
    """A host-shareable WGSL type: its numpy dtype (padding included) and its alignment."""

    dtype: np.dtype
    align: int
    columns: int = 0
    """Number of columns of a matrix, 0 otherwise."""
    rows: int = 0


def _round_up(value: int, multiple: int) -> int:
    return -(-value // multiple) * multiple


def parse_structs(source: str, file: str) -> dict[str, WgslType]:
    """All structs of ``source`` that can be filled from the host, by name."""
    plain = re.sub(r"//[^\n]*", "", source)
    bodies = {m.group(1): m.group(2) for m in _STRUCT.finditer(plain)}
    constants = {
        m.group(1): int(m.group(2))
        for m in re.finditer(r"\bconst\s+(\w+)\s*(?::\s*\w+)?\s*=\s*(\d+)u?\s*;", plain)
    }
    found: dict[str, WgslType] = {}

    def resolve(name: str) -> WgslType | None:
        if name in found:
            return found[name]
        if name in bodies:
            made = _struct(bodies[name], resolve_type, file)
            if made is not None:
                found[name] = made
            return made
        return None

    def resolve_type(text: str) -> WgslType | None:
        return _parse_type(text.strip(), resolve, constants)

    for name in bodies:
        resolve(name)
    return found


def _struct(body: str, resolve_type: Any, file: str) -> WgslType | None:
    names, formats, offsets = [], [], []
    offset, align = 0, 1
    for part in _split_fields(body):
        match = _FIELD.fullmatch(part.strip())
        if match is None:
            raise ShaderError(file, None, f"cannot read the struct field '{part.strip()}'")
        kind = resolve_type(match.group(2))
        if kind is None:
            return None
        offset = _round_up(offset, kind.align)
        names.append(match.group(1))
        formats.append(kind.dtype)
        offsets.append(offset)
        # a vec3 followed by a scalar packs tightly: its size is 12, its alignment 16
        offset += kind.dtype.itemsize
        align = max(align, kind.align)
    dtype = np.dtype(
        {
            "names": names,
            "formats": formats,
            "offsets": offsets,
            "itemsize": _round_up(offset, align),
        }
    )
    return WgslType(dtype, align)


def _split_fields(body: str) -> list[str]:
    parts, depth, start = [], 0, 0
    for i, c in enumerate(body):
        if c in "<(":
            depth += 1
        elif c in ">)":
            depth -= 1
        elif c == "," and depth == 0:
            parts.append(body[start:i])
            start = i + 1
    parts.append(body[start:])
    return [p for p in parts if p.strip()]


def _parse_type(text: str, resolve: Any, constants: dict[str, int]) -> WgslType | None:
    if text in _SCALARS:
        return WgslType(np.dtype(_SCALARS[text]), 4)
    if m := re.fullmatch(r"vec([234])(?:([fiu])|<\s*(f32|i32|u32)\s*>)", text):
        n, scalar = int(m.group(1)), _SCALARS[m.group(3) or _SUFFIX[m.group(2)]]
        return WgslType(np.dtype((scalar, (n,))), 8 if n == 2 else 16)
    if m := re.fullmatch(r"mat([234])x([234])(?:f|<\s*f32\s*>)", text):
        columns, rows = int(m.group(1)), int(m.group(2))
        stored = 2 if rows == 2 else 4
        return WgslType(np.dtype((np.float32, (columns, stored))), 4 * stored, columns, rows)
    if m := re.fullmatch(r"array<\s*(.+?)\s*,\s*(\w+)\s*>", text, re.S):
        inner = _parse_type(m.group(1), resolve, constants)
        count = constants.get(m.group(2)) or (
            int(m.group(2).rstrip("u")) if m.group(2).rstrip("u").isdigit() else 0
        )
        if inner is None or count == 0:
            return None
        stride = _round_up(inner.dtype.itemsize, inner.align)
        padded = inner.dtype
        if stride != inner.dtype.itemsize:
            padded = np.dtype({"names": ["v"], "formats": [inner.dtype], "itemsize": stride})
        return WgslType(np.dtype((padded, (count,))), inner.align)
    return resolve(text)


def pack(kind: WgslType, values: Mapping[str, Any], file: str, name: str) -> bytes:
    """The bytes of a uniform struct, filled by field name; every field must be given, no other."""
    out = np.zeros((), kind.dtype)
    _fill(out, kind.dtype, values, file, name)
    return out.tobytes()


def _fill(
    out: np.ndarray, dtype: np.dtype, values: Mapping[str, Any], file: str, name: str
) -> None:
    wanted, given = set(dtype.names or ()), set(values)
    if wanted != given:
        missing, extra = sorted(wanted - given), sorted(given - wanted)
        why = "; ".join(
            [f"missing {', '.join(missing)}"] * bool(missing)
            + [f"no field {', '.join(extra)}"] * bool(extra)
        )
        raise ShaderError(file, None, f"uniform '{name}': {why}")
    for key, value in values.items():
        field = dtype[key]
        base = field.base
        if isinstance(value, Mapping):
            _fill(out[key], field, value, file, f"{name}.{key}")
            continue
        if base.names and base.names != ("v",):
            # an array of structs may be given in part, from its start
            for i, element in enumerate(value):
                _fill(out[key][i, ...], base, element, file, f"{name}.{key}")
            continue
        array = np.asarray(value)
        if array.ndim == 2 and base == np.float32 and len(field.shape) == 2:
            # a matrix: columns are stored one after the other, each padded to four rows
            columns = array.T
            out[key][: columns.shape[0], : columns.shape[1]] = columns
            continue
        slot = out[key]
        if base.names == ("v",):
            slot = slot["v"]
        vector = not base.names and not base.shape
        if array.ndim and not vector and len(array) < len(slot):
            # an array may be given in part, a vector may not
            slot[: len(array)] = array
        else:
            try:
                slot[...] = array
            except ValueError:
                raise ShaderError(
                    file, None, f"uniform '{name}.{key}' has shape {slot.shape}, not {array.shape}"
                ) from None
