"""Settings groups from plain values, as TOML and JSON have them: what is wrong is named by its key.

Unknown keys are refused with the nearest known one; values are checked as everywhere else.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scuro.errors import SettingsError
from scuro.settings import SettingsGroup, checked, parameters, subgroups, unknown

_AUTO = "auto"
"""Stands for ``None``, which TOML does not have."""
Place = tuple[str | int, ...]
"""Where a value stands: names and, in arrays of tables, numbers."""


class Fault(Exception):
    """Something is wrong at a key: a tuple of names and, in arrays of tables, numbers."""

    def __init__(self, key: Place, why: str) -> None:
        super().__init__(why)
        self.key, self.why = key, why


def group_from(kind: type[SettingsGroup], values: Any, place: Place) -> Any:
    """A settings group from plain values; a fault names the key's place."""
    if not isinstance(values, Mapping):
        raise Fault(place, f"{dotted(place)} is a table of settings, not a single value")
    singles = {p.name: p for p in parameters(kind)}
    groups = dict(subgroups(kind))
    made: dict[str, Any] = {}
    for key, value in values.items():
        here = (*place, key)
        if key in groups:
            made[key] = group_from(groups[key], value, here)
        elif key in singles:
            p = singles[key]
            value = tuple(value) if isinstance(value, list) else value
            if p.optional and value == _AUTO:
                value = None
            try:
                made[key] = checked(p, value)
            except SettingsError as error:
                raise Fault(here, f"{dotted(here)}: {error}") from None
        else:
            names = [dotted((*place, name)) for name in (*singles, *groups)]
            raise Fault(here, unknown("key", dotted(here), names))
    try:
        return kind(**made)
    except SettingsError as error:
        raise Fault(place, f"{dotted(place)}: {error}") from None


def dotted(place: Place) -> str:
    return ".".join(str(p) for p in place if not isinstance(p, int))
