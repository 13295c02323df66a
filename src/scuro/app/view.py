"""``scuro view``: the viewer in a window."""

from __future__ import annotations

from typing import Any

import click

from scuro.app.document import take_document, with_document
from scuro.app.options import SettingsCommand
from scuro.app.output import stage


@with_document
@click.command(cls=SettingsCommand)
@click.option("--device", metavar="N|NAME", help="The adapter to use: see 'scuro devices'.")
def command(device: str | None, **values: Any) -> None:
    """Show files in a window: turn, cut, ask, light and measure them with the mouse.

    --size is the window's. Pictures and scene files are saved in the working directory.
    """
    from scuro.render import Renderer
    from scuro.viewer.model import Model
    from scuro.viewer.window import open_window, run_windows

    document = take_document(values)
    with stage("reading"):
        model = Model(document)
    open_window(model, Renderer(device))
    run_windows()
