"""``scuro bench``: speed and memory of the parts, on this machine."""

from __future__ import annotations

import sys
from typing import Any

import click

from scuro.app.output import print_json, print_table
from scuro.errors import SettingsError


@click.command()
@click.argument("name", required=False)
@click.argument("inputs", nargs=-1, metavar="[IN]...")
@click.option("--size", default="1280x720", metavar="WxH", help="Picture size. [default 1280x720]")
@click.option(
    "--frames",
    type=click.IntRange(1, 1000),
    default=5,
    metavar="N",
    help="Frames of which the median is taken. [default 5]",
)
@click.option("--device", metavar="N|NAME", help="The adapter to use: see 'scuro devices'.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(
    name: str | None,
    inputs: tuple[str, ...],
    size: str,
    frames: int,
    device: str | None,
    as_json: bool,
) -> None:
    """Measure speed and memory of a part of scuro, by NAME; without one, list the benchmarks.

    IN are the files to measure on, instead of each benchmark's own.
    """
    from importlib import import_module

    from scuro.measure import bench

    modules = {n: f"scuro.measure.bench.{n}" for n in bench.names()}
    if name is None:
        for known, module in modules.items():
            summary = (import_module(module).__doc__ or "").partition("\n")[0]
            click.echo(f"{known}: {summary}")
        return
    bench.check(name)
    options = bench.BenchOptions(inputs, _size(size), frames, device, _say)
    report = {"benchmark": name, **import_module(modules[name]).run(options)}
    if as_json:
        print_json(report)
    else:
        _print(report)


def _size(text: str) -> tuple[int, int]:
    from scuro.app.options import parse_element
    from scuro.render_settings import Settings
    from scuro.settings import checked, parameters

    parameter = next(p for p in parameters(Settings) if p.name == "size")
    value = checked(parameter, tuple(parse_element(parameter, v) for v in text.split("x")))
    return value[0], value[1]


def _say(text: str) -> None:
    if sys.stderr.isatty():
        click.echo(f"measuring {text}", err=True)


def _print(report: dict[str, Any]) -> None:
    """A table of the rows, and one of each further list of rows under its own name."""
    if not report["rows"]:
        raise SettingsError("nothing was measured")
    title = f"{report['benchmark']} on {report.get('adapter', 'this machine')}"
    _print_rows(title, report["rows"])
    for name, rows in report.items():
        listed = name != "rows" and isinstance(rows, list) and rows
        if listed and all(isinstance(row, dict) for row in rows):
            _print_rows(f"{report['benchmark']}: {name.replace('_', ' ')}", rows)


def _print_rows(title: str, rows: list[dict[str, Any]]) -> None:
    from rich import box
    from rich.table import Table

    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for key, value in rows[0].items():
        name = key.replace("_", " ")
        table.add_column(name, justify="left" if isinstance(value, str) else "right")
    for row in rows:
        table.add_row(*(f"{v:,}" if isinstance(v, int) else str(v) for v in row.values()))
    print_table(table)
