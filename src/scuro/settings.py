"""One definition of a parameter.

A technique's settings are a frozen dataclass deriving from :class:`SettingsGroup`; each field is
made by :func:`setting` with its default, help, range and unit in place. Command-line flags, viewer
controls, scene-file keys, documentation tables and JSON are all derived from these fields.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import types
import typing
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import TYPE_CHECKING, Any, Self, TypeVar, dataclass_transform

from scuro.errors import SettingsError

if TYPE_CHECKING:
    _F = TypeVar("_F", bound=Callable[..., Any])

    def cache(function: _F) -> _F:
        """As functools.cache, for which mypy takes our classes for unhashable."""
        return function

else:
    from functools import cache


def setting(
    default: Any,
    help: str,
    *,
    low: float | None = None,
    high: float | None = None,
    unit: str = "",
    choices: tuple[str, ...] | Callable[[], tuple[str, ...]] | None = None,
    main: bool = False,
    check: Callable[[Any], None] | None = None,
    switch: bool = False,
) -> Any:
    """Declare one setting of a :class:`SettingsGroup`.

    Args:
        default: The value when nobody says otherwise. ``None`` means "worked out from the scene",
            or, for a ``switch``, "off".
        help: One line for people.
        low: Smallest value allowed (each element's, for tuples).
        high: Largest value allowed.
        unit: Unit of the value, e.g. ``"px"``, ``"Å"``, ``"deg"``.
        choices: The words allowed, for text settings.
        main: The group's own flag: ``occlusion.technique`` with ``main`` is ``--occlusion``.
        check: Further check; raises :class:`SettingsError`.
        switch: Whether ``None`` turns it off.
    """
    metadata = dict(
        help=help, low=low, high=high, unit=unit, choices=choices, main=main, check=check,
        switch=switch,
    )  # fmt: skip
    return field(default=default, metadata=metadata)


@dataclass(frozen=True)
class Parameter:
    """A setting as the tools see it: its place, type, range, unit and help."""

    name: str
    type: type
    optional: bool
    default: Any
    help: str
    low: float | None
    high: float | None
    unit: str
    choices: tuple[str, ...] | None
    main: bool
    length: int | None
    """Number of elements, for tuples; ``None`` for single values and tuples of any length."""
    many: bool
    """Whether the value is a tuple; ``type`` is then its elements' type."""
    check: Callable[[Any], None] | None
    switch: bool
    """Whether ``None`` turns it off, instead of leaving it to the scene."""


@dataclass_transform(frozen_default=True)
class SettingsGroup:
    """Base of all settings dataclasses: checks values on construction and on ``replace``."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        dataclass(frozen=True)(cls)

    def __post_init__(self) -> None:
        for parameter in parameters(type(self)):
            value = checked(parameter, getattr(self, parameter.name))
            object.__setattr__(self, parameter.name, value)

    def replace(self, **changes: Any) -> Self:
        """A copy with some values changed; ``a__b=v`` reaches into group ``a``."""
        direct: dict[str, Any] = {}
        nested: dict[str, dict[str, Any]] = {}
        for key, value in changes.items():
            head, _, rest = key.partition("__")
            if rest:
                nested.setdefault(head, {})[rest] = value
            else:
                direct[key] = value
        names = {f.name for f in fields(self)}  # type: ignore[arg-type]
        for key in (*direct, *nested):
            if key not in names:
                raise SettingsError(unknown("setting", key, names))
        for head, inner in nested.items():
            direct[head] = getattr(self, head).replace(**inner)
        return dataclasses.replace(self, **direct)  # type: ignore[type-var]

    def as_dict(self) -> dict[str, Any]:
        """All values as plain nested dictionaries, lists, numbers and text."""
        return {
            f.name: value.as_dict() if isinstance(value, SettingsGroup) else _plain(value)
            for f in fields(self)  # type: ignore[arg-type]
            for value in (getattr(self, f.name),)
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], where: str = "") -> Self:
        """Inverse of :meth:`as_dict`; unknown keys are refused with the nearest known one."""
        known = {f.name: f for f in fields(cls)}  # type: ignore[arg-type]
        groups = dict(subgroups(cls))
        made: dict[str, Any] = {}
        for key, value in values.items():
            place = f"{where}{key}"
            if key not in known:
                raise SettingsError(unknown("setting", place, [f"{where}{k}" for k in known]))
            if key in groups:
                if not isinstance(value, Mapping):
                    raise SettingsError(f"{place} is a group of settings, not a single value")
                made[key] = groups[key].from_dict(value, f"{place}.")
            else:
                made[key] = tuple(value) if isinstance(value, list) else value
        return cls(**made)


def unknown(kind: str, name: str, known: Any) -> str:
    """The sentence for a name nobody knows: suggests the nearest known one and lists them all."""
    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.6)
    hint = f"did you mean '{near[0]}'? " if near else ""
    return f"unknown {kind} '{name}': {hint}known: {', '.join(names)}"


@cache
def parameters(group: type[SettingsGroup]) -> tuple[Parameter, ...]:
    """The settings declared directly in ``group`` (not those of its nested groups)."""
    hints = typing.get_type_hints(group)
    found = []
    for f in fields(group):  # type: ignore[arg-type]
        if "help" not in f.metadata:
            continue
        kind, optional = _without_none(hints[f.name])
        many = typing.get_origin(kind) is tuple
        length = None
        if many:
            arguments = typing.get_args(kind)
            length = None if arguments[-1] is Ellipsis else len(arguments)
            kind = arguments[0]
        meta = dict(f.metadata)
        choices = meta.pop("choices")
        found.append(
            Parameter(
                name=f.name,
                type=kind,
                optional=optional,
                default=f.default,
                choices=choices() if callable(choices) else choices,
                length=length,
                many=many,
                **meta,
            )
        )
    return tuple(found)


@cache
def subgroups(group: type[SettingsGroup]) -> tuple[tuple[str, type[SettingsGroup]], ...]:
    """The groups nested directly in ``group``, by field name."""
    hints = typing.get_type_hints(group)
    return tuple(
        (f.name, hints[f.name])
        for f in fields(group)  # type: ignore[arg-type]
        if is_dataclass(hints[f.name])
        and issubclass(typing.cast(type, hints[f.name]), SettingsGroup)
    )


def walk(
    group: type[SettingsGroup], path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], Parameter]]:
    """Every setting below ``group`` with the path of field names that leads to it."""
    for parameter in parameters(group):
        yield (*path, parameter.name), parameter
    for name, inner in subgroups(group):
        yield from walk(inner, (*path, name))


def _without_none(hint: Any) -> tuple[Any, bool]:
    if isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union:
        rest = [a for a in typing.get_args(hint) if a is not type(None)]
        return rest[0], len(rest) < len(typing.get_args(hint))
    return hint, False


def _plain(value: Any) -> Any:
    return [_plain(v) for v in value] if isinstance(value, tuple) else value


def checked(p: Parameter, value: Any) -> Any:
    """The value as the setting keeps it; :class:`SettingsError` if it cannot have it."""
    if value is None and p.optional:
        return None
    if p.many:
        if isinstance(value, str) or not hasattr(value, "__len__"):
            raise SettingsError(f"{p.name} needs {p.length or 'several'} values, not {value!r}")
        if p.length is not None and len(value) != p.length:
            raise SettingsError(f"{p.name} needs {p.length} values, not {len(value)}")
        value = tuple(_checked_element(p, v) for v in value)
    else:
        value = _checked_element(p, value)
    if p.check is not None:
        p.check(value)
    return value


def _checked_element(p: Parameter, value: Any) -> Any:
    if p.type is bool:
        if not isinstance(value, bool):
            raise SettingsError(f"{p.name} is on or off (true or false), not {value!r}")
        return value
    if p.type is str:
        if not isinstance(value, str):
            raise SettingsError(f"{p.name} needs a word, not {value!r}")
        if p.choices is not None and value not in p.choices:
            raise SettingsError(unknown(p.name, value, p.choices))
        return value
    if isinstance(value, (bool, str)):
        raise SettingsError(f"{p.name} needs a number, not {value!r}")
    try:
        number = p.type(value)
    except (TypeError, ValueError, OverflowError):
        raise SettingsError(f"{p.name} needs a number, not {value!r}") from None
    if not math.isfinite(number):
        raise SettingsError(f"{p.name} needs a finite number, not {value!r}")
    if p.type is int and number != value:
        raise SettingsError(f"{p.name} needs a whole number, not {value!r}")
    unit = f" {p.unit}" if p.unit else ""
    if p.low is not None and number < p.low:
        raise SettingsError(f"{p.name} must be at least {p.low:g}{unit}, not {value!r}")
    if p.high is not None and number > p.high:
        raise SettingsError(f"{p.name} must be at most {p.high:g}{unit}, not {value!r}")
    return number
