"""Writing files so that they are whole or not there."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import BinaryIO

from scuro.errors import SaveError


@contextmanager
def replacing(path: str | PathLike[str], folder: Path | None = None) -> Iterator[BinaryIO]:
    """Open a file beside ``path`` for writing and rename it to ``path`` when all went well.

    On any error the file beside is removed and what was at ``path`` stays as it was.

    Args:
        path: Where to.
        folder: Where to write meanwhile, on the same disk; beside ``path`` by default.

    Raises:
        SaveError: The folder is missing or not writable, or the disk is full.
    """
    target = Path(path)
    if target.is_dir():
        raise SaveError(path, "is a folder: give a file name")
    if target.exists() and not target.is_file():
        # a device or a pipe, such as /dev/stdout: there is nothing to rename
        with _saving(path), open(target, "wb") as file:
            yield file
        return
    with _saving(path):
        handle, beside = tempfile.mkstemp(prefix=f".{target.name}.", dir=folder or target.parent)
    try:
        with _saving(path):
            os.close(handle)
            with open(beside, "wb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            os.chmod(beside, _mode(target))
            os.replace(beside, target)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise


@contextmanager
def _saving(path: str | PathLike[str]) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise SaveError(path, "its folder does not exist: make it first") from None
    except PermissionError:
        raise SaveError(path, "cannot be written: no permission, choose another place") from None
    except OSError as error:
        raise SaveError(path, f"cannot be written: {error.strerror or error}") from None


def _mode(target: Path) -> int:
    """The mode of the file replaced, or that of any new file (mkstemp makes private ones)."""
    if target.exists():
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def check_writable(path: str | PathLike[str]) -> None:
    """Raise :class:`SaveError` early where ``path`` could not be written, before work is spent."""
    target = Path(path)
    if target.is_dir():
        raise SaveError(path, "is a folder: give a file name")
    if not target.parent.is_dir():
        raise SaveError(path, "its folder does not exist: make it first")
    place = target if target.exists() else target.parent
    if not os.access(place, os.W_OK):
        raise SaveError(path, "cannot be written: no permission, choose another place")
