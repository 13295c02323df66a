"""``scuro movie``: a film of a file."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import click

from scuro.app.cli import INTERRUPTED
from scuro.app.document import take_document, with_document
from scuro.app.options import SettingsCommand, take_changes, with_settings
from scuro.app.output import (
    print_json,
    progress,
    stage,
    tell_notes,
    tell_of_idle_cues,
    tell_of_nothing,
    tell_of_open_triangles,
)
from scuro.export.motion import MovieSettings


@with_document
@with_settings(MovieSettings, title="Film")
@click.command(cls=SettingsCommand)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FILM",
    help="Where to: .gif, .mp4, .webm, or a folder for numbered frames.",
)
@click.option("--device", metavar="N|NAME", help="The adapter to use: see 'scuro devices'.")
@click.option("--json", "as_json", is_flag=True, help="Say what was done as one JSON object.")
def command(output: str, device: str | None, as_json: bool, **values: Any) -> None:
    """Make a film of a file: a turntable unless told otherwise.

    Takes the options of 'scuro render'. Frames are kept beside the film until it is finished: after
    Ctrl-C, a crash or a full disk, the same command goes on where it stopped.
    """
    from scuro.export.motion import Motion
    from scuro.export.movie import Film, check_format, stamps
    from scuro.scene.points import clip_keeps

    start = time.perf_counter()
    movie = MovieSettings().replace(**take_changes(MovieSettings, values))
    document = take_document(values)
    check_format(output)
    with stage(f"reading {', '.join(Path(line.path).name for line in document.input)}"):
        motion = Motion(document, movie)
    tell_notes(motion.scene)
    tell_of_idle_cues(motion.scene, document.settings)
    tell_of_open_triangles(motion.scene, document.settings.occlusion.technique)
    some = (motion.at(number).scene for number in (0, motion.length // 2, motion.length - 1))
    if not any(map(clip_keeps, some)):
        tell_of_nothing(motion.scene)
    files = [line.path for line in document.input]
    files += [p for p in (document.load.trajectory, movie.keys) if p]
    about = {"document": document.as_dict(), "movie": movie.as_dict(), "files": stamps(files)}
    film = Film(output, motion, about)
    drawn = _draw(film, motion.length, device)
    try:
        with stage(f"writing {output}"):
            film.join()
    except KeyboardInterrupt:
        raise _stopped(f"while writing {output}, all frames are kept") from None
    if as_json:
        seconds = round(time.perf_counter() - start, 3)
        size = Path(output).stat().st_size if Path(output).is_file() else None
        print_json(
            {"output": output, "frames": motion.length, "drawn": drawn, "seconds": seconds,
             "bytes": size}
        )  # fmt: skip


def _draw(film: Any, length: int, device: str | None) -> int:
    """Draw what is missing; the number of frames drawn."""
    from scuro.render import Renderer

    missing = len(film.missing)
    renderer = Renderer(device) if missing else None
    done = length - missing
    with progress() as shown:
        task = shown.add_task("drawing frames", total=length, completed=done)
        try:
            for _ in film.draw(renderer) if renderer else ():
                done += 1
                shown.advance(task)
        except KeyboardInterrupt:
            raise _stopped(f"after {done} of {length} frames") from None
    return missing


def _stopped(where: str) -> click.exceptions.Exit:
    """Say where a film was broken off; the exit to raise."""
    click.echo(f"scuro: stopped {where}; the same command goes on", err=True)
    return click.exceptions.Exit(INTERRUPTED)
