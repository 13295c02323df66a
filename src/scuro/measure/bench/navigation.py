"""Navigation cube: frame time by atoms inside it (Easdon 2013, Tables 3.1 and 5.1).

Table 3.1 asks how drawing time falls with the share of a molecule that is drawn, Table 5.1 what a
cube of some size costs in molecules of different sizes. The first rows shrink the cube in one
molecule; the last hold the cube and grow the molecule around it. Cost should follow the atoms
inside the cube; the backbone outside is left out, to time what the cube shows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.bench.visibility import droplets
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, ClippingSettings
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_ATOMS = 60_000
_EDGES = (None, 120.0, 80.0, 50.0, 30.0)
"""Å; None draws all."""
_SIZES = (6_000, 60_000, 600_000)
_CUBE = 30.0


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure; see the module. Inputs take the place of the molecules of growing size."""
    renderer = Renderer(options.device)
    scene = droplets(_ATOMS, 1)
    rows = [_measure(renderer, f"{_ATOMS:,} atoms", scene, edge, options) for edge in _EDGES]
    rows += [_measure(renderer, name, grown, _CUBE, options) for name, grown in _grown(options)]
    return {"adapter": str(renderer.gpu.info), "size": list(options.size), "rows": rows}


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

    def frame() -> None:
        renderer.frame(scene, camera, settings).recorder.submit()
        renderer.gpu.finish()

    seconds = median_seconds(frame, options.frames)
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
