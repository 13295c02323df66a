"""``scuro devices``: the GPU adapters of this machine."""

from __future__ import annotations

from dataclasses import asdict

import click

from scuro.app.output import print_json


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(as_json: bool) -> None:
    """List the GPU adapters of this machine, the default one first.

    Give a number or part of a name to --device of the other commands to choose one.
    """
    from scuro.errors import GpuError
    from scuro.gpu.device import NO_ADAPTER, list_adapters

    adapters = list_adapters()
    if as_json:
        print_json({"adapters": [asdict(a) | {"software": a.software} for a in adapters]})
    elif not adapters:
        raise GpuError(NO_ADAPTER)
    else:
        for number, adapter in enumerate(adapters):
            driver = f", driver {adapter.driver}" if adapter.driver else ""
            click.echo(f"{number}: {adapter}{driver}")
