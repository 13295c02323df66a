"""Command-line options made from settings groups: a new setting has its flag without any code.

The path of field names that leads to a setting becomes its flag: ``occlusion.samples`` is
``--occlusion-samples``, and a group's *main* setting takes the group's own name, ``--occlusion``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import click

from scuro.errors import SettingsError
from scuro.settings import Parameter, SettingsGroup, checked, walk

_AUTO = "auto"
"""The word for ``None``: worked out from the scene."""
_NONE = object()
"""Stands for a given ``None``, which click cannot tell from an option that was not given."""

Path = tuple[str, ...]


class SettingType(click.ParamType):
    """Text on the command line to the value of one setting, checked as everywhere else."""

    def __init__(self, parameter: Parameter) -> None:
        self.parameter = parameter
        self.name = parameter.name

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        p = self.parameter
        if p.choices and not p.many:
            return "NAME" if len(p.choices) > 6 else "|".join(p.choices)
        word = {int: "N", float: "X", str: "TEXT", bool: "on|off"}.get(p.type, "VALUE")
        if p.many:
            return "WxH" if p.name == "size" else ",".join([word] * (p.length or 1))
        return word if not p.optional or p.type is str else f"{word}|{_AUTO}"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        p = self.parameter
        if not isinstance(value, str):
            return value
        if p.optional and value == _AUTO and not (p.choices and _AUTO in p.choices):
            return _NONE
        try:
            if p.many:
                pieces = value.replace("x", ",") if p.type in (int, float) else value
                return checked(p, tuple(parse_element(p, v) for v in pieces.split(",")))
            return checked(p, parse_element(p, value))
        except SettingsError as error:
            self.fail(str(error), param, ctx)


def parse_element(p: Parameter, text: str) -> Any:
    """One value's text as text or number, unchecked."""
    text = text.strip()
    if p.type not in (int, float):
        return text
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        raise SettingsError(f"{p.name} needs a number, not '{text}'") from None


class SettingOption(click.Option):
    """The option of one setting; knows the group of settings under which help lists it."""

    def __init__(self, path: Path, parameter: Parameter, title: str) -> None:
        self.section = path[0] if len(path) > 1 else title
        flag = flag_of(path, parameter)
        if parameter.type is bool and not parameter.many:
            declaration, kind = f"{flag}/--no-{flag[2:]}", None
        else:
            declaration, kind = flag, SettingType(parameter)
        super().__init__(
            [declaration, "__".join(path)],
            type=kind,
            default=None,
            help=help_of(parameter),
            is_flag=True if kind is None else None,
        )


def flag_of(path: Path, parameter: Parameter) -> str:
    """The long flag of the setting at ``path``."""
    names = path[:-1] if parameter.main and len(path) > 1 else path
    return "--" + "-".join(name.replace("_", "-") for name in names)


def help_of(p: Parameter) -> str:
    """One line: what it is, its unit, range or words, and its default."""
    facts = []
    if p.choices and not p.many:
        if len(p.choices) > 6:
            facts.append(f"one of {', '.join(p.choices)}")
    elif p.low is not None and p.high is not None:
        facts.append(f"{_number(p.low)} to {_number(p.high)}{_unit(p)}")
    elif p.low is not None:
        facts.append(f"at least {_number(p.low)}{_unit(p)}")
    elif p.high is not None:
        facts.append(f"at most {_number(p.high)}{_unit(p)}")
    elif p.unit:
        facts.append(p.unit)
    facts.append(f"default {_shown(p)}")
    return f"{p.help.rstrip('.')}. [{'; '.join(facts)}]"


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else f"{value:g}"


def _unit(p: Parameter) -> str:
    return f" {p.unit}" if p.unit else ""


def _shown(p: Parameter) -> str:
    value = p.default
    if value is None:
        return _AUTO
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, tuple):
        joint = "x" if p.name == "size" else ","
        return joint.join(f"{v:g}" if isinstance(v, float) else str(v) for v in value) or "none"
    return f"{value:g}" if isinstance(value, float) else str(value) or "none"


def with_settings(
    group: type[SettingsGroup], *, title: str, without: Iterable[Path] = ()
) -> Callable[[click.Command], click.Command]:
    """Decorator: give a command one option for every setting below ``group``.

    Args:
        group: The settings.
        title: Heading in the help for settings that lie directly in the group.
        without: Paths of settings, or of groups of them, to leave out.
    """

    def add(command: click.Command) -> click.Command:
        command.params.extend(SettingOption(path, p, title) for path, p in _walk(group, without))
        return command

    return add


def take_changes(
    group: type[SettingsGroup], values: dict[str, Any], *, without: Iterable[Path] = ()
) -> dict[str, Any]:
    """Remove a group's settings from a command's ``values``; return those that were given.

    The result suits :meth:`scuro.settings.SettingsGroup.replace`.
    """
    names = ["__".join(path) for path, _ in _walk(group, without)]
    given = {name: values.pop(name) for name in names}
    return {
        name: None if value is _NONE else value
        for name, value in given.items()
        if value is not None
    }


def _walk(group: type[SettingsGroup], without: Iterable[Path]) -> Iterator[tuple[Path, Parameter]]:
    left_out = tuple(without)
    for path, parameter in walk(group):
        if not any(path[: len(head)] == head for head in left_out):
            yield path, parameter


class SettingsCommand(click.Command):
    """A command whose help lists the settings group by group."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        sections: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None and isinstance(parameter, click.Option):
                name = getattr(parameter, "section", "options")
                sections.setdefault(name.replace("_", " ").capitalize(), []).append(record)
        for title, records in sections.items():
            with formatter.section(title):
                formatter.write_dl(records)
