"""The errors scuro raises. Only :mod:`scuro.app` turns them into sentences and exit codes."""

from __future__ import annotations

from os import PathLike


class ScuroError(Exception):
    """Base of all errors scuro raises on purpose. Its text is one sentence for the user."""


class LoadError(ScuroError):
    """A file could not be read.

    Args:
        path: The file as the user named it.
        why: What is wrong and the way out, without the file's name.
        line: One-based line, where the format has lines and the fault lies on one.
    """

    def __init__(self, path: str | PathLike[str], why: str, line: int | None = None) -> None:
        where = f"{path}, line {line}" if line is not None else f"{path}"
        super().__init__(f"{where}: {why}")
        self.path = path
        self.line = line
        self.why = why


class SaveError(ScuroError):
    """An output could not be written; nothing was left half-written.

    Args:
        path: The output as the user named it.
        why: What is wrong and the way out.
    """

    def __init__(self, path: str | PathLike[str], why: str) -> None:
        super().__init__(f"{path}: {why}")
        self.path = path
        self.why = why


class SettingsError(ScuroError):
    """A setting or an argument has a value it cannot have (a usage error: exit code 2)."""


class MissingExtraError(ScuroError):
    """A library of an optional extra is not installed.

    Args:
        what: What was asked for, e.g. ``"NIfTI volumes"``.
        extra: The extra that brings it, e.g. ``"volume"``.
    """

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f"{what} need an optional part of scuro: pip install 'scuro[{extra}]'")
        self.extra = extra


class GpuError(ScuroError):
    """The GPU (or its software stand-in) is missing, out of memory or lost."""


class ShaderError(GpuError):
    """A WGSL file does not compile or does not fit what is bound to it.

    Args:
        file: The WGSL file, relative to the package.
        line: One-based line in that file, if known.
        why: What the compiler or the binder said.
    """

    def __init__(self, file: str, line: int | None, why: str) -> None:
        super().__init__(f"{file}:{line}: {why}" if line is not None else f"{file}: {why}")
        self.file = file
        self.line = line
