"""TOML out of settings groups, with their help as comments; and which line a key is on."""

from __future__ import annotations

import json
import re
import tomllib
from os import PathLike
from pathlib import Path
from typing import Any

from scuro.errors import LoadError
from scuro.settings import Parameter, SettingsGroup, parameters, subgroups

_AUTO = "auto"
_HEADER = re.compile(r"^\s*(\[\[?)\s*([A-Za-z0-9_.\-\s\"]+?)\s*\]\]?\s*(#.*)?$")
_KEY = re.compile(r"^\s*([A-Za-z0-9_.\-\"]+)\s*=")


def read(path: str | PathLike[str]) -> str:
    """The text of a file.

    Raises:
        LoadError: It cannot be read, or is no text.
    """
    try:
        return Path(path).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise LoadError(path, "there is no such file") from None
    except OSError as error:
        raise LoadError(path, f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise LoadError(path, "is not a text file in UTF-8") from None


def parse(text: str, path: str | PathLike[str]) -> dict[str, Any]:
    """Read TOML.

    Raises:
        LoadError: The syntax is wrong; the message names the line.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        match = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        why = str(error).split(" (at ")[0]
        if match is None:
            raise LoadError(path, f"is not TOML: {why}") from None
        raise LoadError(path, f"is not TOML: {why} in column {match[2]}", int(match[1])) from None


class Lines:
    """Where each key of a TOML text stands; tomllib does not say."""

    def __init__(self, text: str) -> None:
        self._lines: dict[tuple[str | int, ...], int] = {}
        table: tuple[str | int, ...] = ()
        counts: dict[tuple[str | int, ...], int] = {}
        for number, line in enumerate(text.splitlines(), 1):
            if header := _HEADER.match(line):
                name = _names(header[2])
                if header[1] == "[[":
                    index = counts[name] = counts.get(name, -1) + 1
                    table = (*name, index)
                elif name[:1] in counts:  # a table inside the last element of an array
                    table = (name[0], counts[name[:1]], *name[1:])
                else:
                    table = name
                self._lines.setdefault(table, number)
            elif key := _KEY.match(line):
                self._lines.setdefault((*table, *_names(key[1])), number)

    def find(self, key: tuple[str | int, ...]) -> int | None:
        """The one-based line of a key, or of the nearest table around it."""
        while key and key not in self._lines:
            key = key[:-1]
        return self._lines.get(key)


def _names(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip().strip('"') for part in dotted.split("."))


def dump(name: str, group: SettingsGroup, *, array: bool = False) -> str:
    """A settings group as a table ``[name]`` (or element ``[[name]]``) and those inside it."""
    header = f"[[{name}]]" if array else f"[{name}]"
    lines = [
        f"{p.name} = {_value(getattr(group, p.name))}  # {_comment(p)}"
        for p in parameters(type(group))
    ]
    text = "\n".join([header, *lines]) + "\n"
    for inner, _ in subgroups(type(group)):
        text += "\n" + dump(f"{name}.{inner}", getattr(group, inner))
    return text


def _value(value: Any) -> str:
    if value is None:
        return f'"{_AUTO}"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for DEL, which TOML wants escaped
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)


def _comment(p: Parameter) -> str:
    unit = f" ({p.unit})" if p.unit else ""
    words = f": {', '.join(p.choices)}" if p.choices else ""
    return f"{p.help}{unit}{words}"
