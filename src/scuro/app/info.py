"""``scuro info``: what a file holds."""

from __future__ import annotations

from typing import Any

import click

from scuro.app.options import SettingsCommand, take_changes, with_settings
from scuro.app.output import print_json, print_table, stage
from scuro.load import LoadOptions, load


@with_settings(LoadOptions, title="Reading")
@click.command(cls=SettingsCommand)
@click.argument("input")
@click.option("--format", metavar="ENDING", help="The file's format, where its name does not say.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(input: str, format: str | None, as_json: bool, **values: Any) -> None:
    """Say what INPUT holds: a path, '-' for standard input, or a PDB ID."""
    changes = take_changes(LoadOptions, values)
    with stage(f"reading {input}"):
        data = load(input, format=format, **changes)
        summary = {"input": input, "type": type(data).__name__, **data.summary()}
    if as_json:
        print_json(summary)
    else:
        _print(summary)


def _print(summary: dict[str, Any]) -> None:
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    for name, value in summary.items():
        text = _text(value)
        if text:
            table.add_row(name.replace("_", " "), text)
    print_table(table)


def _text(value: Any) -> str:
    """A value in one or a few readable lines; empty where there is nothing to say."""
    if isinstance(value, dict):
        return ", ".join(f"{k}: {_text(v)}" for k, v in value.items())
    if isinstance(value, list):
        if any(isinstance(v, str) and len(v) > 30 for v in value):
            return "\n".join(value)
        return ", ".join(
            f"({_text(v)})" if isinstance(v, list) else _text(v) or "(blank)" for v in value
        )
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:g}" if isinstance(value, float) else str(value)
