"""``scuro save``: everything a picture depends on, as a scene file."""

from __future__ import annotations

from typing import Any

import click

from scuro.app.document import take_document, with_document
from scuro.app.options import SettingsCommand
from scuro.errors import SettingsError


@with_document
@click.command(cls=SettingsCommand)
@click.option("-o", "--output", required=True, metavar="SCENE.toml", help="Where to.")
def command(output: str, **values: Any) -> None:
    """Write a scene file: the inputs, how they are shown, the view and every setting.

    Takes the options of 'scuro render'; 'scuro render SCENE.toml -o picture.png' then makes the
    picture. A picture that scuro made can be the input, too.
    """
    from scuro.export.scene_file import write_scene_file

    if not output.lower().endswith(".toml"):
        raise SettingsError(f"{output}: a scene file's name ends in .toml")
    write_scene_file(output, take_document(values))
