"""Who may connect, and which files a served viewer may open."""

from __future__ import annotations

import hmac
import ipaddress
import os
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

from scuro.errors import SettingsError
from scuro.export.scene_file import SceneFile
from scuro.load.fetch import is_pdb_id

COOKIE = "scuro_token"
_LOCAL_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach a server bound to ``host``."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True)
class Access:
    """Decides about each request.

    Args:
        host: The address that is bound.
        token: What everybody must know; ``None`` on loopback.
    """

    host: str
    token: str | None

    @classmethod
    def for_host(cls, host: str) -> Access:
        """No token is needed on loopback; anywhere else a new random one is made."""
        return cls(host, None if is_loopback(host) else secrets.token_urlsafe(24))

    def link(self, port: int) -> str:
        """The address to open."""
        name = f"[{self.host}]" if ":" in self.host else self.host
        query = f"/?token={self.token}" if self.token else "/"
        return f"http://{name}:{port}{query}"

    def knows(self, given: str | None) -> bool:
        """Whether a token is right; compared in constant time."""
        if self.token is None:
            return True
        return hmac.compare_digest((given or "").encode(), self.token.encode())

    def right_host(self, headers: Mapping[str, str]) -> bool:
        """Whether the ``Host`` a browser believes to speak to is ours.

        On loopback this keeps pages of other sites out whose names were made to point here.
        """
        name = urlsplit(f"//{headers.get('Host', '')}").hostname
        return self.token is not None or name in _LOCAL_NAMES or name == self.host

    def right_origin(self, headers: Mapping[str, str], required: bool) -> bool:
        """Whether a WebSocket was opened by a page of ours.

        Args:
            headers: Of the request.
            required: Browsers always send an ``Origin``; other programs need not.
        """
        origin = headers.get("Origin")
        if origin is None:
            return not required
        parts = urlsplit(origin)
        return parts.scheme in ("http", "https") and parts.netloc == headers.get("Host")


@dataclass(frozen=True)
class Files:
    """The files that may be opened: those named at the start, and all below a folder."""

    named: frozenset[Path] = field(default_factory=frozenset)
    root: Path | None = None
    folders: frozenset[str] = field(default_factory=frozenset)
    """Where they lie, in every spelling: what pages need not know."""

    @classmethod
    def of(cls, document: SceneFile, root: str | None = None) -> Files:
        """Those of a document, and of a folder.

        Raises:
            SettingsError: The folder is none.
        """
        folder = None if root is None else Path(root).resolve()
        if folder is not None and not folder.is_dir():
            raise SettingsError(f"--root {root}: there is no such folder")
        paths = _paths(document)
        folders = {str(Path(path).expanduser().absolute().parent) for path in paths}
        folders |= {str(_resolved(path).parent) for path in paths}
        if root is not None:
            folders |= {str(folder), str(Path(root).absolute())}
        return cls(frozenset(map(_resolved, paths)), folder, frozenset(folders))

    def check(self, document: SceneFile) -> None:
        """See that a document names no other files; links are followed first.

        Raises:
            SettingsError: It does.
        """
        for path in _paths(document):
            file, _, preset = path.rpartition(":")
            chosen_part = bool(file) and "/" not in preset and "\\" not in preset
            if not (self.may_open(path) or (chosen_part and self.may_open(file))):
                raise SettingsError(f"{path} is not among the files that are served here")

    def may_open(self, path: str) -> bool:
        """Whether a path, with all links followed, is one of them."""
        try:
            real = _resolved(path)
            if real in self.named:
                return True
            below = self.root is not None and real.is_relative_to(self.root)
            # a PDB ID would be downloaded, and a dash waits for what is typed at the server
            return below and path != "-" and (real.exists() or not is_pdb_id(path))
        except (OSError, ValueError, RuntimeError):  # no path at all, or links in a circle
            return False

    def told(self, words: str) -> str:
        """Words for a page: files are named as it knows them, not by where they lie here."""
        for folder in sorted(self.folders, key=len, reverse=True):
            words = words.replace(folder.rstrip(os.sep) + os.sep, "")
        return words

    def may_follow(self, path: Path) -> bool:
        """Whether a file may be read that another leads to: also beside and below named files."""
        try:
            real = path.resolve()
        except (OSError, ValueError, RuntimeError):
            return False
        if self.root is not None and real.is_relative_to(self.root):
            return True
        # samples and PDB IDs are no files: they open no folder
        return any(file.exists() and real.is_relative_to(file.parent) for file in self.named)

    def listing(self) -> list[str]:
        """Files of known endings below the folder, sorted, at most :data:`MOST_LISTED`."""
        if self.root is None:
            return []
        found = (p for p in sorted(self.root.rglob("*")) if _readable(p) and p.is_file())
        inside = (str(p) for p in found if self.may_open(str(p)))
        return [path for path, _ in zip(inside, range(MOST_LISTED), strict=False)]


MOST_LISTED = 500
"""Files of a folder that the panel lists."""


def _readable(path: Path) -> bool:
    """Whether a file's name says that scuro opens it: data, a scene, or a picture of its own."""
    from scuro.load import READERS, Source

    return path.suffix.lower() in (".toml", ".png") or Source(path.name, path).suffix in READERS


def _resolved(path: str) -> Path:
    # as it is opened: a ~ is a home
    return Path(path).expanduser().resolve()


def _paths(document: SceneFile) -> list[str]:
    """Everything in a document that scuro would open.

    Any text setting may be the name of a file (a transfer function, a trajectory, a map): each one
    that names an existing path counts, and a trajectory or a folder of structures always does.
    Samples are no files.
    """
    found = [line.path for line in document.input]
    found += [p for p in (document.load.trajectory, document.load.structures) if p is not None]
    for group in (document.load, document.settings):
        found += [text for text in _texts(group.as_dict()) if _names_a_file(text)]
    return [p for p in found if not p.startswith("sample:")]


def _texts(values: object) -> list[str]:
    if isinstance(values, str):
        return [values]
    if isinstance(values, dict):
        values = list(values.values())
    if isinstance(values, list):
        return [text for value in values for text in _texts(value)]
    return []


def _names_a_file(text: str) -> bool:
    # FILE:PRESET is a file with a part of it chosen
    candidates = [text, text.rpartition(":")[0]]
    try:
        return any(c and ("/" in c or "\\" in c or Path(c).exists()) for c in candidates)
    except (OSError, ValueError):
        return True
