"""``scuro serve``: the viewer in browsers."""

from __future__ import annotations

from typing import Any

import click

from scuro.app.document import take_document, with_document
from scuro.app.options import SettingsCommand
from scuro.app.output import stage


@with_document
@click.command(cls=SettingsCommand)
@click.option("--host", default="127.0.0.1", help="Address to bind. [default 127.0.0.1]")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=8650, help="0 for any. [default 8650]"
)
@click.option("--root", metavar="FOLDER", help="Pages may open the files in this folder.")
@click.option("--clients", type=click.IntRange(1, 64), default=8, help="At once. [default 8]")
@click.option("--device", metavar="N|NAME", help="The adapter to use: see 'scuro devices'.")
def command(
    host: str, port: int, root: str | None, clients: int, device: str | None, **values: Any
) -> None:
    """Show files in browsers, drawn on this machine.

    Only this machine can connect, unless --host is given: then whoever has the link that is
    printed, with its token. Stop with Ctrl+C.
    """
    from scuro.load.source import confined
    from scuro.probe.stream import stream_handler
    from scuro.render import Renderer
    from scuro.viewer.access import Access, Files
    from scuro.viewer.model import Model
    from scuro.viewer.screen import Screen
    from scuro.viewer.server import Server, need_web, run

    need_web()
    document = take_document(values)
    files = Files.of(document, root)
    access = Access.for_host(host)
    with stage("reading"), confined(files.may_follow):
        model = Model(document, guard=files.check)
    renderer = Renderer(device)

    def make_screen(deliver: Any) -> Screen:
        return Screen(
            model, renderer, "rgba8unorm", deliver, files.listing, elsewhere=True, told=files.told
        )

    def ready(bound: int) -> None:
        click.echo(access.link(bound))
        if access.token is not None:
            click.echo(
                f"anyone who can reach {host} and has this link can look and change the scene; "
                "the connection is not encrypted",
                err=True,
            )

    server = Server(make_screen, access, clients, {"/probe": stream_handler(model)})
    with confined(files.may_follow):
        run(server, host, port, ready)
