"""``scuro render``: a picture of a file."""

from __future__ import annotations

import statistics
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from scuro.app.cli import STARTED
from scuro.app.document import take_document, with_document
from scuro.app.options import SettingsCommand
from scuro.app.output import (
    print_json,
    progress,
    scene_counts,
    stage,
    tell_notes,
    tell_of_idle_cues,
    tell_of_nothing,
    tell_of_open_triangles,
)
from scuro.errors import SettingsError
from scuro.measure.memory import peak_memory_mb

if TYPE_CHECKING:
    from scuro.export.scene_file import SceneFile
    from scuro.image import Image
    from scuro.passes.frame import Frame
    from scuro.render import Renderer
    from scuro.scene.camera import Camera
    from scuro.scene.scene import Scene


@with_document
@click.command(cls=SettingsCommand)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="PICTURE",
    help="Where to: .png, .tif, .exr, .jpg or .webp.",
)
@click.option("--buffers", metavar="FILE.npz", help="Also write what is behind the picture.")
@click.option(
    "--inspect",
    metavar="NAME",
    help="Write a buffer in place of the picture: depth, normal, or any that a pass makes, such as "
    "regions or gathered; NAME.y is one channel. A wrong name lists those there are.",
)
@click.option(
    "--bits", type=click.Choice(["8", "16"]), default="8", help="Per channel. [default 8]"
)
@click.option("--device", metavar="N|NAME", help="The adapter to use: see 'scuro devices'.")
@click.option(
    "--frames",
    type=click.IntRange(0, 100_000),
    metavar="N",
    help="Draw N more frames and time them. [default 0; 1 with --json]",
)
@click.option("--json", "as_json", is_flag=True, help="Say what was done as one JSON object.")
def command(
    output: str,
    buffers: str | None,
    inspect: str | None,
    bits: str,
    device: str | None,
    frames: int | None,
    as_json: bool,
    **values: Any,
) -> None:
    """Render a picture of a file.

    IN is a path (PDB, mmCIF, BinaryCIF, SDF, MOL2, XYZ … plain or gzipped), '-' for standard
    input, a PDB ID, which is downloaded once, a scene file (.toml), or a picture that scuro made,
    which makes it again. Several inputs share one scene.
    """
    from scuro.export.files import check_writable
    from scuro.export.formats import check_format

    document = take_document(values)
    check_format(output, document.settings.size, int(bits))
    for path in filter(None, (output, buffers)):
        check_writable(path)
    seconds: dict[str, float | None] = {}
    clock = _Clock(seconds)
    with stage(f"reading {', '.join(Path(line.path).name for line in document.input)}"):
        scene = document.scene()
        clock("load")
    renderer, camera = _prepare(document, scene, device, clock)
    tell_notes(scene)
    tell_of_nothing(scene)
    tell_of_idle_cues(scene, document.settings)
    tell_of_open_triangles(scene, document.settings.occlusion.technique)
    note = document.as_dict(Path(output).parent)
    parts = len(renderer.parts(document.settings))
    if parts > 1 and (buffers or inspect is not None):
        raise SettingsError("a picture drawn in parts has no buffers: lower --size or --antialias")
    if parts > 1:
        _print(output, renderer, scene, camera, document, parts, bits=int(bits), note=note)
        clock("first_frame")
    else:
        with stage("drawing"):
            image = renderer.render(scene, camera, document.settings)
            clock("first_frame")
        with stage(f"writing {output}"):
            if inspect is not None:
                _save_inspected(image, inspect, output, document.settings.dpi)
            else:
                image.save(output, bits=int(bits), settings=note)
            if buffers:
                from scuro.export.image import save_buffers

                save_buffers(buffers, image.buffers())
            clock("write")
    seconds["total"] = time.perf_counter() - STARTED
    # extra frames come last: they are no part of what the picture took
    wanted = frames if frames is not None else int(as_json)
    seconds["frame"] = _steady(renderer, scene, camera, document, wanted)
    if as_json:
        accelerator = renderer.accelerator(scene)
        print_json(
            {
                "output": output,
                "adapter": str(renderer.gpu.info),
                "instances": accelerator.instances,
                **scene_counts(scene),
                "spheres": accelerator.spheres,
                "seconds": {name: value and round(value, 4) for name, value in seconds.items()},
                "passes": {
                    name: round(value, 5) for name, value in renderer.timings.seconds.items()
                },
                "peak_memory_mb": peak_memory_mb(),
                "settings": document.as_dict(),
            }
        )


class _Clock:
    """Notes under a name the seconds since the last note."""

    def __init__(self, seconds: dict[str, float | None]) -> None:
        self._seconds = seconds
        self._last = time.perf_counter()

    def __call__(self, name: str) -> None:
        now = time.perf_counter()
        self._seconds[name] = now - self._last
        self._last = now


def _prepare(
    document: SceneFile, scene: Scene, device: str | None, clock: _Clock
) -> tuple[Renderer, Camera]:
    from scuro.passes.post.stereo import eye_size
    from scuro.render import Renderer
    from scuro.scene.view import view_camera

    renderer = Renderer(device)
    clock("device")
    width, height = eye_size(document.settings.stereo, document.settings.size)
    camera = view_camera(scene, document.view, width / height)
    renderer.accelerator(scene)
    clock("build")
    return renderer, camera


def _print(
    output: str,
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    document: SceneFile,
    parts: int,
    **options: Any,
) -> None:
    """Draw a picture in parts, straight into its file."""
    from scuro.export.parts import save_in_parts

    def done(frame: Frame) -> None:
        shown.advance(task)

    with progress() as shown:
        task = shown.add_task("drawing parts", total=parts)
        save_in_parts(
            output,
            renderer,
            scene,
            camera,
            document.settings,
            on_part=done,
            **options,
        )


def _save_inspected(image: Image, name: str, output: str, dpi: float | None) -> None:
    """Write a buffer as a picture; it notes no settings, since they would not make it again."""
    from scuro.export.inspect import buffer_picture
    from scuro.image import Image

    Image(buffer_picture(name, image.buffer(name))).save(output, dpi=dpi)


def _steady(
    renderer: Renderer, scene: Scene, camera: Camera, document: SceneFile, count: int
) -> float | None:
    """Median seconds of ``count`` further frames, each until the GPU is done."""
    times = []
    with progress() as shown:
        for _ in shown.track(range(count), description="timing frames"):
            start = time.perf_counter()
            for _part in renderer.frames(scene, camera, document.settings):
                pass
            renderer.gpu.finish()
            times.append(time.perf_counter() - start)
    return statistics.median(times) if times else None
