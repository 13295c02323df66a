"""BinaryCIF: MessagePack with per-column encodings, decoded with numpy.

The format: https://github.com/molstar/BinaryCIF (Sehnal et al., PLoS Comput. Biol. 2020). Written
here because reading a million atoms through ``biotite.structure.io.pdbx`` takes several times as
long (docs/decisions.md, "Reading structures").
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from itertools import pairwise
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray

_TYPES = {1: "i1", 2: "<i2", 3: "<i4", 4: "u1", 5: "<u2", 6: "<u4", 32: "<f4", 33: "<f8"}
MAX_LENGTH = 1 << 31
"""A bound on what a damaged run length may expand to."""


class Column:
    """One column of a category; decoded on first use."""

    def __init__(self, encoded: Mapping[str, Any]) -> None:
        self.encoded = encoded["data"]
        self.encoded_mask = encoded.get("mask")

    @cached_property
    def _steps(self) -> list[Mapping[str, Any]]:
        return self.encoded["encoding"]

    @cached_property
    def mask(self) -> NDArray[np.uint8] | None:
        """0 where there is a value, 1 for ``.`` (not applicable), 2 for ``?`` (unknown)."""
        if self.encoded_mask is None:
            return None
        mask = decode(self.encoded_mask["data"], self.encoded_mask["encoding"])
        return mask.astype(np.uint8) if mask.any() else None

    @property
    def is_text(self) -> bool:
        return bool(self._steps) and self._steps[0]["kind"] == "StringArray"

    def coded(self) -> tuple[NDArray[np.int64], list[str]]:
        """Text as an index into the list of distinct strings; masked values are the last, empty."""
        if not self.is_text:
            values, inverse = np.unique(self.numbers(), return_inverse=True)
            index = inverse.ravel().astype(np.int64)
            names = [f"{v:g}" for v in values.tolist()]
        else:
            step = self._steps[0]
            index = decode(self.encoded["data"], step["dataEncoding"]).astype(np.int64)
            offsets = decode(step["offsets"], step["offsetEncoding"]).astype(np.int64).tolist()
            joined = step["stringData"]
            names = [joined[a:b] for a, b in pairwise(offsets)]
        missing = (index < 0) | (index >= len(names))
        if self.mask is not None:
            missing |= self.mask != 0
        if missing.any():
            index = np.where(missing, len(names), index)
            names = [*names, ""]
        return index, names

    def bytes_(self) -> NDArray[np.bytes_]:
        """Text as bytes (Latin-1); empty where masked."""
        index, names = self.coded()
        encoded = [name.encode("latin-1", "replace") for name in names]
        return np.array(encoded or [b""])[index]

    def text(self) -> NDArray[np.str_]:
        """Text; empty where masked."""
        index, names = self.coded()
        return np.array(names or [""])[index]

    def numbers(self, missing: float = 0) -> NDArray:
        """Numbers; ``missing`` where masked, NaN where a text column holds something else."""
        if self.is_text:
            index, names = self.coded()
            return np.array([_number(name, missing) for name in names] or [missing])[index]
        values = decode(self.encoded["data"], self._steps)
        if self.mask is not None:
            values = np.where(self.mask != 0, missing, values)
        return values


def _number(name: str, missing: float) -> float:
    if not name:
        return missing
    try:
        return float(name)
    except ValueError:
        return float("nan")


class BinaryCif:
    """The first data block of a BinaryCIF file that has a category ``atom_site``, or the first.

    Raises:
        ValueError, KeyError, TypeError, msgpack errors: The bytes are damaged.
    """

    def __init__(self, data: bytes) -> None:
        self.blocks = msgpack.unpackb(data, strict_map_key=False)["dataBlocks"]
        if not self.blocks:
            raise ValueError("the file has no data block")
        holding = [
            b for b in self.blocks if any(c["name"] == "_atom_site" for c in b["categories"])
        ]
        self.block = (holding or self.blocks)[0]
        self.name = str(self.block.get("header", ""))
        self._categories = {c["name"].lstrip("_"): c for c in self.block["categories"]}

    def category(self, name: str) -> dict[str, Column]:
        """Columns of a category by name; empty where the file does not have it."""
        found = self._categories.get(name)
        return {} if found is None else {c["name"]: Column(c) for c in found["columns"]}


def decode(data: Any, encodings: list[Mapping[str, Any]]) -> NDArray:
    """Undo the encodings, last first."""
    for step in reversed(encodings):
        data = _DECODERS[step["kind"]](data, step)
    return data


def _byte_array(data: bytes, step: Mapping[str, Any]) -> NDArray:
    return np.frombuffer(data, _TYPES[step["type"]])


def _fixed_point(data: NDArray, step: Mapping[str, Any]) -> NDArray:
    return (data / step["factor"]).astype(_TYPES[step["srcType"]])


def _interval(data: NDArray, step: Mapping[str, Any]) -> NDArray:
    width = (step["max"] - step["min"]) / (step["numSteps"] - 1)
    return (step["min"] + data * width).astype(_TYPES[step["srcType"]])


def _run_length(data: NDArray, step: Mapping[str, Any]) -> NDArray:
    counts = data[1::2].astype(np.int64)
    if (counts < 0).any() or counts.sum() > MAX_LENGTH:
        raise ValueError("a run length is damaged")
    return np.repeat(data[::2], counts).astype(_TYPES[step["srcType"]])


def _delta(data: NDArray, step: Mapping[str, Any]) -> NDArray:
    return (np.cumsum(data, dtype=np.int64) + step["origin"]).astype(_TYPES[step["srcType"]])


def _integer_packing(data: NDArray, step: Mapping[str, Any]) -> NDArray:
    """Values beyond the packed type's limits are written as a run of limits and a rest."""
    limits = np.iinfo(data.dtype)
    more = data == limits.max
    if not step["isUnsigned"]:
        more |= data == limits.min
    if not more.any():
        return data.astype(np.int32)
    ends = np.flatnonzero(~more)
    sums = np.cumsum(data, dtype=np.int64)[ends]
    return np.diff(sums, prepend=0).astype(np.int32)


_DECODERS: dict[str, Callable[..., NDArray]] = {
    "ByteArray": _byte_array,
    "FixedPoint": _fixed_point,
    "IntervalQuantization": _interval,
    "RunLength": _run_length,
    "Delta": _delta,
    "IntegerPacking": _integer_packing,
}
