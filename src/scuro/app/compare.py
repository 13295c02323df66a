"""``scuro compare``: every technique beside the reference, in pictures and numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from scuro.app.document import take_document, with_document
from scuro.app.options import SettingsCommand, parse_element
from scuro.app.output import print_json, print_table, progress, stage, tell_notes
from scuro.errors import SaveError, SettingsError
from scuro.settings import unknown, walk

if TYPE_CHECKING:
    from scuro.measure.compare import Drawn
    from scuro.measure.report import Row
    from scuro.measure.variant import Variant
    from scuro.render_settings import Settings
    from scuro.scene.scene import Scene

_DEFAULTS = {
    "occlusion": "ray,samples=1024",
    "light": "monte-carlo,samples=64",
    "strategy": "plts",
}
"""References by what is varied: occlusion of surfaces, light in volumes, rays in reservoirs."""
_MOST_DIFFERENCE = 20.0
"""CIE ΔE2000 that difference maps show as brightest."""
_OTHER_QUESTION = {"light": ("path",)}
"""Values that are compared only when named: they are slow, and show other light."""


@with_document
@click.command(cls=SettingsCommand)
@click.option(
    "--vary",
    metavar="SETTING",
    help="The setting whose values are compared. [default occlusion; light for volumes; "
    "strategy for reservoirs]",
)
@click.option(
    "--techniques",
    default="all",
    metavar="NAME,…",
    help="Which of its values to compare. [default all]",
)
@click.option(
    "--reference",
    metavar="NAME[,key=…]",
    help="What they are held against: a value, and settings of its group. "
    f"[default {_DEFAULTS['occlusion']}; {_DEFAULTS['light']} for volumes; "
    f"{_DEFAULTS['strategy']} for reservoirs]",
)
@click.option(
    "--fit",
    is_flag=True,
    help="Fit the attenuation of each technique for volumes to the reference first.",
)
@click.option(
    "--turns",
    type=click.IntRange(2, 180),
    metavar="N",
    help="Compare in N views of a half turn about each of the axes X, Y and Z, and give the means.",
)
@click.option(
    "--frames",
    type=click.IntRange(1, 1000),
    default=3,
    metavar="N",
    help="Frames timed for each. [default 3]",
)
@click.option(
    "-o", "--output", default="compare", metavar="FOLDER", help="Where to. [default compare]"
)
@click.option("--device", metavar="N|NAME", help="The adapter to use: see 'scuro devices'.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def command(
    vary: str | None,
    techniques: str,
    reference: str | None,
    fit: bool,
    turns: int | None,
    frames: int,
    output: str,
    device: str | None,
    as_json: bool,
    **values: Any,
) -> None:
    """Hold every technique against the reference.

    Draws IN with each value of a setting and with the reference, all else equal, and writes into a
    folder the pictures, maps of their CIELAB difference (ΔE2000), labelled contact sheets of both,
    and compare.json with times, RMSE, PSNR, SSIM, mean CIE ΔE2000, FLIP and local contrast, over
    the object's pixels and over the whole picture.
    """
    from scuro.measure.compare import compare, variants
    from scuro.measure.fit import rgb
    from scuro.measure.metrics import delta_e_map
    from scuro.measure.report import table, write_json
    from scuro.measure.sheet import contact_sheet, difference_picture
    from scuro.measure.turns import AXES, compare_turned, means
    from scuro.measure.turns import table as table_of_views
    from scuro.passes.post.stereo import eye_size
    from scuro.render import Renderer
    from scuro.scene.view import view_camera

    document = take_document(values)
    named = () if techniques == "all" else tuple(techniques.split(","))
    if vary is not None:  # wrong words are told before anything is read
        variants(vary, named)
        reference_variant(vary, reference or variants(vary)[0].name)
    with stage("reading"):
        scene = document.scene()
    tell_notes(scene)
    vary = vary or _question(scene)
    if reference is None and vary not in _DEFAULTS:
        raise SettingsError(f"say what to hold the values of '{vary}' against: --reference NAME")
    truth = reference_variant(vary, reference or _DEFAULTS[vary])
    chosen = _chosen(vary, named, truth, document.settings)
    folder = _made(output)
    renderer = Renderer(device)
    width, height = eye_size(document.settings.stereo, document.settings.size)
    camera = view_camera(scene, document.view, width / height)
    pictures: dict[str, Any] = {}
    maps: dict[str, Any] = {}
    files: list[str] = []
    drawn_rows: list[Row] = []
    with progress() as shown:
        total = (len(chosen) + 1) * (len(AXES) * turns if turns else 1)
        task = shown.add_task("comparing", total=total)
        first: Any = None

        def keep(drawn: Drawn, row: Row, view: str = "") -> None:
            nonlocal first
            label = f"reference: {row.technique}" if row.object is None else row.technique
            label = f"{label} {view}".strip()
            first = drawn.pixels if row.object is None else first
            pictures[label] = drawn.pixels
            drawn_rows.append(row)
            files.append(f"{label.replace(': ', '-')}.png")
            _write(folder / files[-1], drawn)
            if row.object is not None:
                difference = delta_e_map(rgb(drawn.pixels), rgb(first))
                maps[label] = difference_picture(difference, _MOST_DIFFERENCE)
                _write_map(folder / f"{label}-difference.png", maps[label])
            shown.advance(task)

        how = (renderer, scene, camera, document.settings, chosen, truth)
        if turns:
            views = compare_turned(
                *how, turns, frames=frames, fit=fit,
                on_drawn=lambda view, drawn, row: keep(drawn, row, view),
            )  # fmt: skip
            rows = means(views)
        else:
            rows = compare(*how, frames=frames, fit=fit, on_drawn=keep)
            rows = [replace(row, image=file) for row, file in zip(rows, files, strict=True)]
    notes = {label: _note(row) for label, row in zip(pictures, drawn_rows, strict=True)}
    columns = len(chosen) + 1 if turns else None
    _save_sheet(folder / "sheet.png", contact_sheet(pictures, notes, columns=columns))
    if maps:
        told = {label: f"{notes[label]} · yellow: dE {_MOST_DIFFERENCE:.0f}" for label in maps}
        _save_sheet(folder / "differences.png", contact_sheet(maps, told))
    about: dict[str, Any] = {
        "input": [line.path for line in document.input],
        "atoms": sum(len(item.molecule) for item in scene.molecules),
        "adapter": str(renderer.gpu.info),
        "settings": document.as_dict(),
    }
    if turns:
        about["views"] = [view.as_dict() for view in views]
    write_json(folder / "compare.json", rows, **about)
    if as_json:
        print_json({**about, "techniques": [row.as_dict() for row in rows]})
        return
    names = ", ".join(about["input"])
    seen = f", mean of {len(views)} views" if turns else ""
    print_table(table(rows, f"{names}, {_size(scene)}{seen}"))
    if turns:
        print_table(table_of_views(views))
    click.echo(f"pictures, sheet.png, differences.png and compare.json are in {folder}")


def _question(scene: Scene) -> str:
    """What there is to compare in a scene."""
    if scene.reservoirs and len(scene.reservoirs) == len(scene.items):
        return "strategy"
    return "light" if scene.volumes and not scene.bodies() else "occlusion"


def _size(scene: Scene) -> str:
    voxels = sum(item.volume.values.size for item in scene.volumes)
    cells = sum(item.grid.active_count for item in scene.reservoirs)
    atoms = sum(len(item.molecule) for item in scene.molecules)
    counts = {"voxels": voxels, "active cells": cells, "atoms": atoms}
    return ", ".join(f"{n:,} {what}" for what, n in counts.items() if n) or "0 atoms"


def _chosen(vary: str, named: tuple[str, ...], truth: Variant, settings: Settings) -> list[Variant]:
    """The variants to compare: those named, or all that are not the reference itself."""
    from scuro.measure.compare import variants

    same = settings.replace(**truth.changes)
    others = [
        variant for variant in variants(vary)
        if variant.name not in _OTHER_QUESTION.get(vary, ())
        and settings.replace(**variant.changes) != same
    ]  # fmt: skip
    return variants(vary, named) if named else others


def reference_variant(vary: str, text: str) -> Variant:
    """Read ``NAME[,key=value…]``, keys being settings in the varied one's group.

    A key with dots is a setting of any group: ``path,path.samples=256``.

    Raises:
        SettingsError: The name or a key is not known.
    """
    from scuro.measure.compare import variants, varied
    from scuro.measure.variant import Variant
    from scuro.render_settings import Settings

    name, *rest = text.split(",")
    (made,) = variants(vary, [name])
    group = varied()[vary][0].rpartition("__")[0]
    siblings = {
        path[-1]: p for path, p in walk(Settings) if path[:-1] == tuple(filter(None, [group]))
    }
    anywhere = {".".join(path): p for path, p in walk(Settings) if len(path) > 1}
    changes = dict(made.changes)
    for part in rest:
        key, _, value = part.partition("=")
        if key in anywhere:
            changes[key.replace(".", "__")] = parse_element(anywhere[key], value)
            continue
        if key not in siblings:
            raise SettingsError(f"--reference '{text}': {unknown('key', key, siblings)}")
        changes[f"{group}__{key}" if group else key] = parse_element(siblings[key], value)
    return Variant(text, changes)


def _made(output: str) -> Path:
    folder = Path(output)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SaveError(output, f"this folder cannot be made: {error.strerror}") from None
    return folder


def _write(path: Path, drawn: Drawn) -> None:
    from scuro.image import Image

    Image(drawn.pixels).save(path, settings=drawn.variant.changes)


def _write_map(path: Path, pixels: Any) -> None:
    from PIL import Image

    _save_sheet(path, Image.fromarray(pixels))


def _save_sheet(path: Path, sheet: Any) -> None:
    from scuro.export.files import replacing

    with replacing(path) as file:
        sheet.save(file, "PNG")


def _note(row: Row) -> str:
    if row.object is None:
        return f"{row.milliseconds:.0f} ms"
    o = row.object
    return f"{row.milliseconds:.0f} ms · SSIM {o.ssim:.3f} · dE {o.delta_e:.2f}"
