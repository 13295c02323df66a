"""What commands print: one JSON object, rich tables, and progress on standard error."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from rich.progress import Progress

    from scuro.render_settings import Settings
    from scuro.scene.scene import Scene

_PATIENCE = 1.0
"""Seconds that work may take before progress is shown."""
_MOST_NOTES = 12
"""A model without its structures has a note for each."""


def print_json(value: Any) -> None:
    """One JSON object on standard output, and nothing else."""
    click.echo(json.dumps(value, indent=2, ensure_ascii=False, default=_plain))


def _plain(value: Any) -> Any:
    """numpy scalars and arrays as plain numbers and lists."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not JSON")


def print_table(table: Any) -> None:
    """A rich table on standard output, unbroken where that is no terminal."""
    from rich.console import Console

    width = None if sys.stdout.isatty() else 160
    Console(highlight=False, width=width).print(table)


def tell_notes(scene: Scene) -> None:
    """Say on standard error what readers mended or missed, and what is left out unasked."""
    for item in scene.molecules:
        name = item.molecule.source or item.molecule.name
        if left_out := item.left_out:
            click.echo(
                f"{name}: {left_out:,} atoms of water about it are left out; "
                "'--select all' shows them",
                err=True,
            )
        assembly, copies = item.unassembled
        if assembly:
            click.echo(
                f"{name}: this is one of {copies:,} copies in the biological assembly; "
                f"'--assembly {assembly}' shows them all",
                err=True,
            )
    for item in scene.items:
        known = (getattr(item, kind, None) for kind in ("volume", "model", "grid"))
        data: Any = next((data for data in known if data is not None), None)
        notes = list(getattr(data, "notes", ()))
        told = notes if len(notes) <= _MOST_NOTES + 1 else notes[:_MOST_NOTES]
        for note in told:
            click.echo(f"{data.source or data.name}: {note}", err=True)
        if len(told) < len(notes):
            click.echo(
                f"{data.source or data.name}: and {len(notes) - len(told)} notes more: see "
                "'scuro info'",
                err=True,
            )


def tell_of_nothing(scene: Scene) -> None:
    """Say so on standard error where clipping leaves nothing to see."""
    from scuro.scene.points import clip_keeps

    if clip_keeps(scene):
        return
    said = "clipping removes everything: this is the background"
    if any(body.context for body in scene.bodies()):
        said = "nothing lies inside the cube: --cube-center moves it, in the file's coordinates"
    click.echo(f"scuro: {said}", err=True)


def tell_of_open_triangles(scene: Scene, technique: str) -> None:
    """Say so on standard error where the technique of occlusion knows spheres and rods only."""
    if technique not in ("analytic", "baked"):
        return
    if any(len(body.geometry.triangles) for body in scene.bodies()):
        click.echo(
            f"scuro: '{technique}' occlusion does not darken cartoons and surfaces: "
            "'--occlusion hybrid' and 'ray' do",
            err=True,
        )


def tell_of_idle_cues(scene: Scene, settings: Settings) -> None:
    """Say so on standard error where depth cues find no surface to be drawn on."""
    if settings.toon.steps and scene.volumes and not scene.bodies() and not scene.reservoirs:
        click.echo(
            "scuro: toon does nothing here: its tones are those of surfaces, and volumes have none",
            err=True,
        )


def scene_counts(scene: Scene) -> dict[str, int]:
    """What a scene holds: atoms with all their copies, and more of other kinds of data."""
    models = [item.model for item in scene.items if hasattr(item, "model")]
    atoms = sum(item.atoms for item in scene.molecules)
    counts = {"atoms": atoms + sum(m.atoms for m in models)}
    if models:
        counts["instances"] = sum(m.instances for m in models)
        counts["ingredients"] = sum(len(m.ingredients) for m in models)
        counts["compartments"] = sum(m.compartments for m in models)
    cells = [item.grid.active_count for item in scene.reservoirs]
    voxels = [item.volume.values.size for item in scene.volumes]
    return (
        counts
        | ({"cells": sum(cells)} if cells else {})
        | ({"voxels": sum(voxels)} if voxels else {})
    )


@contextmanager
def stage(label: str) -> Iterator[None]:
    """Show a spinner with ``label`` while the work inside takes longer than a second."""
    if not sys.stderr.isatty():
        yield
        return
    shown: list[Any] = []

    def show() -> None:
        from rich.console import Console

        status = Console(stderr=True).status(label)
        status.start()
        shown.append(status)

    timer = threading.Timer(_PATIENCE, show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        for status in shown:
            status.stop()


@contextmanager
def progress() -> Iterator[Progress]:
    """A rich progress display on standard error; silent where that is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Remaining())
    with Progress(
        *columns, console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()
    ) as shown:
        yield shown
