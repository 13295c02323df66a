"""Paths in scene files: as seen from the file's folder, so that it can be moved as a whole."""

from __future__ import annotations

import os
from pathlib import Path

from scuro.load import LoadOptions


def moved(load: LoadOptions, folder: Path | None, absolute: bool = False) -> LoadOptions:
    """Options whose files are named as seen from a folder."""
    name = named_path if absolute else relative_path
    given = {key: getattr(load, key) for key in ("trajectory", "structures")}
    return load.replace(**{k: name(path, folder) for k, path in given.items() if path is not None})


def named_path(path: str, folder: Path | None) -> str:
    """A file's path as seen from a folder, or its absolute one; IDs and samples as they are."""
    if folder is None and Path(path).exists():
        return str(Path(path).resolve())
    return relative_path(path, folder)


def relative_path(path: str, folder: Path | None) -> str:
    """A file's path as seen from a folder; IDs and samples as they are."""
    if folder is None or not Path(path).exists():
        return path
    return Path(os.path.relpath(path, folder)).as_posix()


def found_path(path: str, folder: Path) -> str:
    """Inverse of :func:`relative_path`."""
    there = folder / path
    return str(there) if path != "-" and there.exists() else path
