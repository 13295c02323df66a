"""Text CIF: gemmi for the syntax, numpy for the one table that is large.

gemmi takes seconds to read a million atoms as separate strings, so the loop of ``_atom_site`` is
cut out and split at blanks, vectorised; whatever numpy cannot split (values with blanks inside
quotes, text blocks) is left to gemmi.
"""

from __future__ import annotations

import re

import gemmi
import numpy as np
from numpy.typing import NDArray

from scuro.load.columns import fixed_floats
from scuro.load.table import text

CHUNK = 1 << 20
"""Bytes split at once: what fits a processor's cache beats one pass over all."""
MAX_WORD = 256
"""Longest word that numpy splits off."""


class TextColumn:
    """One column of a category as text; ``.`` and ``?`` are empty."""

    def __init__(self, values: NDArray[np.bytes_]) -> None:
        self.values = values

    def bytes_(self) -> NDArray[np.bytes_]:
        """Text as bytes; empty where missing."""
        return self.values

    def text(self) -> NDArray[np.str_]:
        """Text; empty where missing."""
        return text(self.values)

    def numbers(self, missing: float = 0) -> NDArray[np.float64]:
        """Numbers; ``missing`` where there is none, NaN where the text is not a number."""
        empty = self.values == b""
        if not empty.any():
            return fixed_floats(self.values, default=np.nan)
        values = np.full(len(self.values), missing, np.float64)
        values[~empty] = fixed_floats(self.values[~empty], default=np.nan)
        return values


class TextCif:
    """The first data block of a CIF file that has a category ``atom_site``, or the first.

    Args:
        data: The file's content.
        wanted: Columns of ``atom_site`` to keep; the others are not even split off.

    Raises:
        ValueError: The text is not CIF (gemmi's message names the line).
    """

    def __init__(self, data: bytes, wanted: frozenset[str]) -> None:
        if b"\r" in data:
            data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        atoms, rest = _cut(data, b"_atom_site.")
        _, rest = _cut(rest, b"_atom_site_anisotrop.")
        self._atoms = None if atoms is None else _split(*atoms, wanted)
        if self._atoms is None:
            rest = data
        # gemmi takes text; entries' titles and authors hold any character
        document = gemmi.cif.read_string(rest.decode("utf-8", "replace"))
        if len(document) == 0:
            raise ValueError("the file has no data block")
        holding = [b for b in document if b.get_mmcif_category_names().count("_atom_site.")]
        self.block = (holding or [document[0]])[0]
        self.name = self.block.name

    def category(self, name: str) -> dict[str, TextColumn]:
        """Columns of a category by name; empty where the file does not have it."""
        if name == "atom_site" and self._atoms is not None:
            return self._atoms
        table = self.block.find_mmcif_category(f"_{name}.")
        columns = {}
        for tag in table.tags:
            values = [gemmi.cif.as_string(v) for v in self.block.find_values(tag)]
            encoded = [v.encode("latin-1", "replace") for v in values]
            columns[tag.partition(".")[2]] = TextColumn(np.array(encoded or [], "S"))
        return columns


def _cut(data: bytes, prefix: bytes) -> tuple[tuple[list[str], bytes] | None, bytes]:
    """Cut the loop of a category out of a file.

    Returns:
        The loop's column names and body (None without such a loop), and the file without it.
    """
    head = re.search(
        rb"^loop_\s+((?:" + re.escape(prefix) + rb"\S+\s+)+)", data, re.MULTILINE | re.IGNORECASE
    )
    if head is None:
        return None, data
    end = len(data)
    for mark in (b"\n#", b"\nloop_", b"\n_", b"\ndata_"):
        found = data.find(mark, head.end() - 1, end)
        if found >= 0:
            end = found + 1
    tags = [tag[len(prefix) :].decode("latin-1") for tag in head.group(1).split()]
    return (tags, data[head.end() : end]), data[: head.start()] + data[end:]


def _split(tags: list[str], body: bytes, wanted: frozenset[str]) -> dict[str, TextColumn] | None:
    """Columns of a loop's body; None where it is not plain words between blanks."""
    kept = [(i, tag) for i, tag in enumerate(tags) if tag in wanted]
    parts: dict[str, list[NDArray[np.bytes_]]] = {tag: [] for _, tag in kept}
    # blanks around the body give every word two edges and every window of characters its width
    codes = np.frombuffer(b"\n" + body + b"\n" * MAX_WORD, np.uint8)
    blank = codes <= 32
    start, last = 0, len(body) + 1
    while start < last:
        end = min(start + CHUNK, last)
        if end < last:  # on to the end of the line
            end += int(np.argmax(codes[end:] == ord("\n")))
        edges = np.flatnonzero(blank[start + 1 : end + 1] != blank[start:end]) + (start + 1)
        start = end
        if len(edges) % (2 * len(tags)):
            return None
        if len(edges) == 0:
            continue
        spans = edges.reshape(-1, len(tags), 2)
        for i, tag in kept:
            values = _words(codes, spans[:, i, 0], spans[:, i, 1])
            if values is None:
                return None
            parts[tag].append(values)
    if not kept or not parts[kept[0][1]]:
        return None
    return {tag: TextColumn(np.concatenate(chunks)) for tag, chunks in parts.items()}


def _words(codes: NDArray[np.uint8], start: NDArray, end: NDArray) -> NDArray[np.bytes_] | None:
    """Text between ``start`` and ``end``, quotes taken off, ``.`` and ``?`` made empty."""
    first, length = codes[start], end - start
    if (first == ord(";")).any() or int(length.max()) > MAX_WORD:
        return None
    quoted = (first == ord('"')) | (first == ord("'"))
    if quoted.any():
        if (quoted & ((codes[end - 1] != first) | (length < 2))).any():
            return None  # a quoted value with a blank inside
        start, length = start + quoted, length - 2 * quoted
    length[(length == 1) & ~quoted & ((first == ord(".")) | (first == ord("?")))] = 0
    width = max(int(length.max()), 1)
    values = np.lib.stride_tricks.sliding_window_view(codes, width)[start]
    values *= np.arange(width) < length[:, None]
    return values.view(f"S{width}").ravel()
