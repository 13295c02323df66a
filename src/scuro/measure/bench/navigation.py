"""Navigation cube: frame time by atoms inside it (Easdon 2013, Tables 3.1 and 5.1).

Table 3.1 asks how drawing time falls with the share of a molecule that is drawn, Table 5.1 what a
cube of some size costs in molecules of different sizes. The first rows shrink the cube in one
molecule; the last hold the cube and grow the molecule around it. Cost should follow the atoms
inside the cube; the rest outside is left out, to time what the cube shows. What it adds is timed
last: cut in turn with and without the rest of the molecule in simple light, in one go.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.measure.bench import BenchOptions, label, median_seconds
from scuro.measure.bench.visibility import droplets
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, ClippingSettings
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_ATOMS = 60_000
_EDGES = (None, 120.0, 80.0, 50.0, 30.0)
"""Å; None draws all."""
_SIZES = (6_000, 60_000, 600_000)
_CUBE = 30.0
_RESTED = (18.0, 30.0)
_RESTS = ("none", "backbone", "cartoon")


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure; see the module. Inputs take the place of the molecules of growing size."""
    renderer = Renderer(options.device)
    scene = droplets(_ATOMS, 1)
    rows = [_measure(renderer, f"{_ATOMS:,} atoms", scene, edge, options) for edge in _EDGES]
    rows += [_measure(renderer, name, grown, _CUBE, options) for name, grown in _grown(options)]
    rests = [row for edge in _RESTED for row in _with_rests(renderer, edge, options)]
    return {
        "adapter": str(renderer.gpu.info), "size": list(options.size), "rows": rows, "rest": rests
    }  # fmt: skip


def _grown(options: BenchOptions) -> Any:
    if options.inputs:
        from scuro.load import load

        for name in options.inputs:
            yield name, Scene().add(load(name)).show("spacefill")
        return
    for count in _SIZES:
        yield f"{count:,} atoms", droplets(count, 1)


def _measure(
    renderer: Renderer, name: str, scene: Scene, edge: float | None, options: BenchOptions
) -> dict[str, Any]:
    options.say(f"{name}, {edge or 'no'} cube")
    middle = scene.bounds().mean(axis=0)
    cube = None if edge is None else (edge, edge, edge)
    scene.clip = Clip(ClippingSettings(cube=cube).box(middle))
    settings = Settings(size=options.size).replace(occlusion__technique="ray")
    camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])

    seconds = median_seconds(partial(_draw, renderer, scene, camera, settings), options.frames)
    inside = sum(
        int(scene.clip.keeps(body.geometry.spheres[:, :3] + np.asarray(body.positions[0])).sum())
        for body in scene.bodies()
    )
    return {
        "molecule": name,
        "cube": "none" if edge is None else f"{edge:g} Å",
        "atoms_inside": inside,
        "frame_s": round(seconds, 4),
    }


def _with_rests(renderer: Renderer, edge: float, options: BenchOptions) -> list[dict[str, Any]]:
    """Frames of a cube in a protein, with full light inside, and each kind of rest around it."""
    path = options.inputs[0] if options.inputs else "sample:1hpv"
    settings = Settings(size=options.size).replace(lighting__preset="full")
    drawn: dict[str, Callable[[], None]] = {}
    for rest in _RESTS:
        document = SceneFile(
            (Input(path=path),),
            (Show(style="spacefill"),),
            clipping=ClippingSettings(cube=(edge,) * 3, cube_rest=rest),
        )
        own, scene = renderer.sibling(), document.scene()
        camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
        drawn[rest] = partial(_draw, own, scene, camera, settings)
    seconds: dict[str, list[float]] = {rest: [] for rest in _RESTS}
    for _ in range(options.frames + 1):
        for rest, draw in drawn.items():
            start = time.perf_counter()
            draw()
            seconds[rest].append(time.perf_counter() - start)
    found = {rest: statistics.median(times[1:]) for rest, times in seconds.items()}
    return [
        {
            "molecule": label(path),
            "cube": f"{edge:g} Å",
            "rest": rest,
            "frame_s": round(found[rest], 4),
            "ratio": round(found[rest] / found["none"], 3),
        }
        for rest in _RESTS
    ]


def _draw(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings) -> None:
    renderer.frame(scene, camera, settings).recorder.submit()
    renderer.gpu.finish()
