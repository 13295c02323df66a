"""Illustration: what post passes, supersampling, a large print and a film cost.

Five tables in one: the post passes of the qutemol look and each by itself against the plain frame,
supersampling 2× against one frame, a 4096 × 4096 print in parts with its peak memory, how far a
print in parts of one size differs from one in parts of another, and a turntable of 120 frames with
the size of its GIF. Frames are timed in turns: a machine that slows down slows all of them.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from scuro.export.motion import Motion, MovieSettings
from scuro.export.movie import Film
from scuro.export.parts import save_in_parts
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.measure.bench import BenchOptions
from scuro.measure.bench.visibility import droplets
from scuro.measure.memory import peak_memory_mb
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_SAMPLE = "sample:1hpv"
"""A small molecule, for the film."""
_ATOMS = 60_000
"""Of the scene of the frames and the print."""
_POST: dict[str, dict[str, Any]] = {
    "borders": {"borders__width": 1.6},
    "halos": {"halos__width": 10.0},
    "fog": {"fog__strength": 0.5},
    "toon": {"toon__steps": 4},
    "fxaa": {"antialias__method": "fxaa"},
}
_PRINT: dict[str, Any] = {
    "occlusion__technique": "hybrid", "borders__width": 6.0, "halos__width": 40.0,
}  # fmt: skip


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure; see the module. An input replaces the scene of the frames and the print."""
    renderer = Renderer(options.device)
    name = options.inputs[0] if options.inputs else f"{_ATOMS:,} atoms"
    scene = _scene(options)
    rows = _frames(renderer, scene, options)
    options.say("the print")
    rows.append(_print(renderer, scene))
    options.say("seams")
    rows.append(_seams(renderer, scene))
    options.say("the film")
    rows.append(_film(renderer))
    return {
        "adapter": str(renderer.gpu.info), "size": list(options.size), "input": name, "rows": rows
    }  # fmt: skip


def _scene(options: BenchOptions) -> Scene:
    if not options.inputs:
        return droplets(_ATOMS, 1)
    return SceneFile((Input(path=options.inputs[0]),), (Show(style="spacefill"),)).scene()


def _row(what: str, seconds: float, ratio: float, **more: Any) -> dict[str, Any]:
    row = {"what": what, "seconds": round(seconds, 4), "of_plain": round(ratio, 3)}
    return {**row, "peak_memory_mb": "", "file_mb": "", "difference": "", **more}


def _frames(renderer: Renderer, scene: Scene, options: BenchOptions) -> list[dict[str, Any]]:
    camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
    base = options.plain().replace(lighting__preset="simple", antialias__method="none")
    together = {key: value for changes in _POST.values() for key, value in changes.items()}
    variants = {"plain": {}, **_POST, "all post passes": together,
                "depth of field": {"depth_of_field__blur": 6.0},
                "supersampling 2x": {"antialias__method": "2x"}}  # fmt: skip
    drawn = {what: base.replace(**changes) for what, changes in variants.items()}
    taken: dict[str, list[float]] = {what: [] for what in drawn}
    for turn in range(options.frames + 1):
        options.say(f"frames, {turn} of {options.frames}")
        for what, settings in drawn.items():
            start = time.perf_counter()
            for _ in renderer.frames(scene, camera, settings):
                renderer.gpu.finish()
            if turn:  # the first builds and compiles
                taken[what].append(time.perf_counter() - start)
    seconds = {what: statistics.median(times) for what, times in taken.items()}
    return [_row(what, s, s / seconds["plain"]) for what, s in seconds.items()]


def _print(renderer: Renderer, scene: Scene) -> dict[str, Any]:
    settings = Settings(size=(4096, 4096)).replace(**_PRINT)
    camera = view_camera(scene, ViewSettings(), 1.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "print.png"
        start = time.perf_counter()
        save_in_parts(path, renderer, scene, camera, settings)
        seconds = time.perf_counter() - start
        size = path.stat().st_size
    return _row("print 4096x4096", seconds, 0.0,
                peak_memory_mb=peak_memory_mb(), file_mb=round(size / 1e6, 2))  # fmt: skip


def _seams(renderer: Renderer, scene: Scene) -> dict[str, Any]:
    """The largest difference, of 255, between prints in parts of two heights."""
    settings = Settings(size=(2304, 2304)).replace(**_PRINT)
    camera = view_camera(scene, ViewSettings(), 1.0)
    pictures = []
    start = time.perf_counter()
    for rows in (None, 320):
        pixels = np.empty((*settings.size[::-1], 4), np.int16)
        for part, frame in renderer.frames(scene, camera, settings, rows=rows):
            drawn = renderer.gpu.read_texture(frame.resources["picture"])
            pixels[part.rows, part.columns] = drawn[part.inside]
        pictures.append(pixels)
    seconds = time.perf_counter() - start
    apart = int(np.abs(pictures[0] - pictures[1]).max())
    return _row("print 2304x2304 twice, in parts of two sizes", seconds, 0.0, difference=apart)


def _film(renderer: Renderer) -> dict[str, Any]:
    document = SceneFile((Input(path=_SAMPLE),), settings=Settings(size=(640, 360)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "turntable.gif"
        start = time.perf_counter()
        film = Film(path, Motion(document, MovieSettings(length=120)), {})
        for _ in film.draw(renderer):
            pass
        film.join()
        seconds = time.perf_counter() - start
        size = path.stat().st_size
    return _row(
        "turntable of 1HPV, 120 frames of 640x360", seconds, 0.0, file_mb=round(size / 1e6, 2)
    )
