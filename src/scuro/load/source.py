"""Where bytes come from: a path, standard input, a shipped sample, or an entry of the PDB."""

from __future__ import annotations

import gzip
import io
import sys
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path

from scuro.errors import LoadError
from scuro.load import fetch

GZIP_MAGIC = b"\x1f\x8b"
SAMPLE_PREFIX = "sample:"
SAMPLES = {"1tii": "1tii.pdb.gz", "1hpv": "1hpv.pdb.gz"}
"""Structures shipped inside the package; see ``data/README.md``."""


@dataclass(frozen=True, eq=False)
class Source:
    """One input: what the user called it, and its bytes on demand.

    Readers that need a real file (to map it, or to find others beside it) use :attr:`path`, which
    is None for standard input; all others use :attr:`data`.
    """

    name: str
    """As the user wrote it: a path, ``-``, ``sample:1tii`` or a PDB ID."""
    path: Path | None

    @property
    def suffix(self) -> str:
        """The file's ending in lower case without ``.gz``, e.g. ``".pdb"``; empty where none."""
        if self.path is None:
            return ""
        suffixes = [s.lower() for s in self.path.suffixes]
        if suffixes and suffixes[-1] == ".gz":
            suffixes.pop()
        return suffixes[-1] if suffixes else ""

    @property
    def stem(self) -> str:
        """The file's name without endings, for naming what was read."""
        if self.path is None:
            return "stdin"
        stem = self.path.name.removesuffix(".gz")
        return stem.rsplit(".", 1)[0] if "." in stem else stem

    @cached_property
    def data(self) -> bytes:
        """The content, unzipped where it is gzip whatever the ending says.

        Raises:
            LoadError: The file cannot be read, is empty, or is a damaged gzip.
        """
        data = self._raw()
        if data[:2] == GZIP_MAGIC:
            try:
                data = gzip.decompress(data)
            except EOFError:
                raise LoadError(
                    self.name, "the gzip ends too early: the file is cut off; copy it again"
                ) from None
            except (OSError, zlib.error) as error:
                raise LoadError(self.name, f"the gzip is damaged ({error})") from None
        if not data or data.isspace():
            raise LoadError(self.name, "the file is empty")
        return data

    def _raw(self) -> bytes:
        try:
            return sys.stdin.buffer.read() if self.path is None else self.path.read_bytes()
        except OSError as error:
            raise LoadError(self.name, f"cannot be read ({error.strerror})") from None

    @cached_property
    def text(self) -> str:
        """The content as text (UTF-8, else Latin-1: old files have accents in authors' names)."""
        try:
            return self.data.decode("utf-8")
        except UnicodeDecodeError:
            return self.data.decode("latin-1")

    def lines(self) -> io.StringIO:
        """The text, line by line, whatever the line ends."""
        return io.StringIO(self.text, newline=None)


_may_read: Callable[[Path], bool] | None = None


@contextmanager
def confined(may_read: Callable[[Path], bool]) -> Iterator[None]:
    """Let this process read only files that ``may_read`` allows, also those that others lead to.

    For servers: what a page opens may name any file of the machine (``INCLUDE``, structures). It
    holds for all threads: files are read beside the pages.
    """
    global _may_read
    before, _may_read = _may_read, may_read
    try:
        yield
    finally:
        _may_read = before


def open_source(name: str | Path) -> Source:
    """Find what the user means.

    A PDB ID is downloaded (or taken from the cache) unless a file of that name exists.

    Raises:
        LoadError: Nothing of that name, a folder, an unreadable file, or a failed download.
    """
    text = str(name)
    if text == "-":
        return Source(text, None)
    if text.lower().startswith(SAMPLE_PREFIX):
        return Source(text, _sample(text))
    path = Path(text).expanduser()
    try:
        if path.exists():
            if _may_read is not None and not _may_read(path):
                raise LoadError(text, "is not among the files that are served here")
            return Source(text, path)
    except OSError as error:
        raise LoadError(text[:80], f"cannot be read ({error.strerror})") from None
    if fetch.is_pdb_id(text):
        return Source(text, fetch.fetch(text))
    word = text.isalnum()  # what has a dot or a folder was never meant for an ID
    either = ", and it is not a PDB ID (like 1aon) either" if word else ""
    raise LoadError(text, f"there is no such file{either}")


def _sample(name: str) -> Path:
    key = name[len(SAMPLE_PREFIX) :].lower()
    if key not in SAMPLES:
        raise LoadError(name, f"no such sample; there are {', '.join(sorted(SAMPLES))}")
    return Path(str(resources.files("scuro") / "data" / SAMPLES[key]))
