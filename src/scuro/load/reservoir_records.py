"""Fortran records of ECLIPSE output files, found once and read when asked for (by resfo)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, MissingExtraError
from scuro.load.source import GZIP_MAGIC, Source


def resfo_module() -> Any:
    """The library that knows the records.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import resfo
    except ImportError:
        raise MissingExtraError("reservoir models", "reservoir") from None
    return resfo


@dataclass(frozen=True)
class Record:
    """One keyword and where its array lies."""

    keyword: str
    start: int
    length: int


class RecordFile:
    """The records of one binary or formatted output file.

    Args:
        source: The file; gzip is unpacked in memory.

    Raises:
        LoadError: It cannot be read, or does not start with a record.
    """

    def __init__(self, source: Source) -> None:
        self.name = source.name
        self._path: Path | None = None
        self._data = b""
        if source.path is not None and not _is_gzip(source):
            self._path = source.path
        else:
            self._data = source.data
        self.records: list[Record] = []
        self.cut_off = ""
        """Why reading ended before the end of the file, empty for a whole file."""
        self._find_records()

    @contextmanager
    def _open(self) -> Iterator[IO[Any]]:
        try:
            stream: IO[Any] = self._path.open("rb") if self._path else BytesIO(self._data)
        except OSError as error:
            raise LoadError(self.name, f"cannot be read ({error.strerror})") from None
        with stream:
            if self._formatted(stream):
                import io

                yield io.TextIOWrapper(stream, encoding="latin-1")
            else:
                yield stream

    @staticmethod
    def _formatted(stream: IO[bytes]) -> bool:
        """Formatted files start with a quote; binary ones with a record's length."""
        head = stream.read(8)
        stream.seek(0)
        return head.lstrip()[:1] == b"'"

    def _find_records(self) -> None:
        resfo = resfo_module()
        with self._open() as stream:
            size = stream.seek(0, 2)
            stream.seek(0)
            if size == 0:
                raise LoadError(self.name, "the file is empty")
            try:
                for entry in resfo.lazy_read(stream):
                    keyword, length = entry.read_keyword().strip(), entry.read_length()
                    if stream.tell() > size:
                        self.cut_off = f"the file ends within {keyword}"
                        break
                    self.records.append(Record(keyword, entry.start, length))
            except _damages(resfo) as error:
                self.cut_off = f"no further record can be read ({_short(error)})"
        if not self.records:
            raise LoadError(
                self.name, f"is not an ECLIPSE output file: {self.cut_off or 'it has no records'}"
            )

    def find(self, keyword: str, first: int = 0, last: int | None = None) -> Record | None:
        """The first record of a keyword among a range of records."""
        found = (r for r in self.records[first:last] if r.keyword == keyword)
        return next(found, None)

    def read(self, record: Record) -> NDArray:
        """The array of a record.

        Raises:
            LoadError: It is damaged.
        """
        resfo = resfo_module()
        with self._open() as stream:
            stream.seek(record.start)
            try:
                entry = next(resfo.lazy_read(stream))
                array = entry.read_array()
            except _damages(resfo) as error:
                raise LoadError(
                    self.name, f"{record.keyword} is damaged ({_short(error)}); copy the file again"
                ) from None
        return np.asarray(array) if record.length else np.zeros(0)

    def array(self, keyword: str, first: int = 0, last: int | None = None) -> NDArray | None:
        """The array of a keyword, None where there is none."""
        record = self.find(keyword, first, last)
        return None if record is None else self.read(record)

    def needed(self, keyword: str) -> NDArray:
        """The array of a keyword that must be there.

        Raises:
            LoadError: It is not, or is damaged.
        """
        found = self.array(keyword)
        if found is None:
            why = self.cut_off or "it is not a grid file, or not whole"
            raise LoadError(self.name, f"has no {keyword}: {why}")
        return found


def words(array: NDArray | None) -> list[str]:
    """CHAR arrays as text without padding."""
    if array is None:
        return []
    return [(w.decode("latin-1") if isinstance(w, bytes) else str(w)).strip() for w in array]


def _is_gzip(source: Source) -> bool:
    try:
        with source.path.open("rb") as stream:  # type: ignore[union-attr]
            return stream.read(2) == GZIP_MAGIC
    except OSError as error:
        raise LoadError(source.name, f"cannot be read ({error.strerror})") from None


def _damages(resfo: Any) -> tuple[type[Exception], ...]:
    """What reading raises on damaged records.

    Offsets beyond the file are an OSError, no record at an offset a StopIteration.
    """
    return (resfo.ResfoParsingError, ValueError, KeyError, OSError, StopIteration)


def _short(error: Exception) -> str:
    return str(error).split("(b'")[0].strip().rstrip(".").lower() or type(error).__name__
