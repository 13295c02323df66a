"""Download entries of the Protein Data Bank as BinaryCIF, once, into the user's cache folder.

``SCURO_PDB_URL`` names another server (a mirror): the address below which ``<id>.bcif.gz`` lies.
"""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from pathlib import Path

from scuro.errors import LoadError

DEFAULT_URL = "https://models.rcsb.org"
TIMEOUT = 30.0
"""Seconds without an answer after which a download is given up."""

_PDB_ID = re.compile(r"(?:[0-9][a-z0-9]{3}|pdb_[0-9]{4}[0-9][a-z0-9]{3})", re.IGNORECASE)


def is_pdb_id(text: str) -> bool:
    """Whether ``text`` has the form of a PDB ID: ``1aon``, or the extended ``pdb_00001aon``."""
    return _PDB_ID.fullmatch(text) is not None


def cache_folder() -> Path:
    """The folder in which downloaded entries are kept."""
    import platformdirs

    return Path(platformdirs.user_cache_dir("scuro")) / "pdb"


def fetch(pdb_id: str) -> Path:
    """The entry's BinaryCIF file in the cache, downloaded if it is not there yet.

    Raises:
        LoadError: No network, no such entry, or an answer that is not a BinaryCIF file.
    """
    entry = pdb_id.lower()
    if entry.startswith("pdb_0000"):  # the extended form of a four-letter ID
        entry = entry[-4:]
    path = cache_folder() / f"{entry}.bcif.gz"
    if path.is_file() and path.stat().st_size > 0:
        return path
    data = _download(pdb_id, entry)
    if data[:2] != b"\x1f\x8b":
        raise LoadError(pdb_id, "the server's answer is not a gzipped BinaryCIF file; try again")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _write_beside(path, data)
    except OSError as error:
        raise LoadError(
            pdb_id, f"cannot be kept in the cache {path.parent} ({error.strerror})"
        ) from None
    return path


def _download(pdb_id: str, entry: str) -> bytes:
    # imported here: few runs download anything, and all would wait for it
    import http.client
    import urllib.error
    import urllib.request

    base = os.environ.get("SCURO_PDB_URL", DEFAULT_URL).rstrip("/")
    try:
        with urllib.request.urlopen(f"{base}/{entry}.bcif.gz", timeout=TIMEOUT) as answer:
            return answer.read()
    except urllib.error.HTTPError as error:
        if error.code in (400, 404):
            why = f"no such file here, and the PDB has no entry of that ID (asked {base})"
        else:
            why = f"{base} answered with error {error.code}; try again later"
    except (OSError, http.client.HTTPException, ValueError) as error:
        reason = getattr(error, "reason", None) or error
        why = (
            f"no such file here, and it could not be downloaded from {base} ({reason}): "
            "is there a network connection? else download the entry elsewhere and name the file"
        )
    raise LoadError(pdb_id, why)


def _write_beside(path: Path, data: bytes) -> None:
    """Write whole or not at all: beside the target first, then renamed."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise
