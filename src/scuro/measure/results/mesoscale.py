"""Cell-scale models: clutter, the zoom, cost and calm beside Koch's thesis (2018).

A cell generated from samples, and the inputs, which are cell-scale models. All are cut in half, so
that their inner compartments show.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from scuro.errors import SettingsError
from scuro.export.zoom import Zoom, zoom_of, zoom_settings
from scuro.load import load
from scuro.load.mesoscale_structures import structure_of_molecule
from scuro.measure.bench import BenchOptions, label
from scuro.measure.bench.mesoscale import table_4_1
from scuro.measure.calm import shimmer, zoom_shimmer
from scuro.measure.clutter import edge_density, subband_entropy
from scuro.measure.results.page import grid
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.clip import Clip, Plane
from scuro.scene.generate import GenerateSettings, generate
from scuro.scene.model import MesoscaleModel
from scuro.scene.scene import Scene

TITLE = "Cell-scale models: semantic occlusion"
SAMPLES = ("sample:1tii", "sample:1hpv")
ATOMS = 1e8
THESIS = {"light bounce": 10.0, "shadows": 2.1, "blur 1 to 10": 2.1, "samples 16 to 64": 77.6}
"""Table 4.1: growth of the frame, per cent, on a GeForce GTX 1070 at 1920 × 1080."""
FRAMES = 300
"""Of the film whose jumps are measured."""
SMALL = (320, 180)
"""Size of pictures that are many."""
VIEWS = {"a, whole": 0.0, "b": 1 / 3, "c": 2 / 3, "d, atoms": 1.0}
"""The pictures of Figure 5.2 as shares of the zoom."""
MODES = {"without semantics": "plain", "screen space": "screen", "traced": "traced"}
CALM: dict[str, dict[str, Any]] = {
    "atoms as they are": {"detail": 0.0, "semantic__calm": 0.0},
    "atoms merged": {"semantic__calm": 0.0},
    "atoms merged, edges smoothed by rays": {},
    "16 samples a pixel": {"detail": 0.0, "semantic__calm": 0.0, "antialias__method": "4x"},
}
PICTURES = r"""Pictures of a generated cell of 10⁸ atoms (without semantics, with them, with names
and attention; then the zoom of Figure 5.2) by

    scuro make-mesoscale sample:1tii sample:1hpv -o cell.meso --atoms 1e8
    scuro render cell.meso -o plain.jpg --size 640x360 --clip 0,0,-1 --semantic plain
    scuro render cell.meso -o semantic.jpg --size 640x360 --clip 0,0,-1 --semantic screen
    scuro render cell.meso -o names.jpg --size 640x360 --clip 0,0,-1 --semantic screen \
        --labels regions --attention "compartment 2"
    scuro movie cell.meso -o zoom --size 640x360 --clip 0,0,-1 --motion zoom --length 4

![without semantics](images/mesoscale-plain.jpg)
![with semantics](images/mesoscale-semantic.jpg)
![names and attention](images/mesoscale-names.jpg)

![zoom, b](images/mesoscale-zoom-b.jpg)
![zoom, c](images/mesoscale-zoom-c.jpg)
![zoom, d](images/mesoscale-zoom-d.jpg)"""


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs, measured as they are asked for."""
    renderer = Renderer(options.device)
    yield f"Adapter: {renderer.gpu.info}."
    for name, model in _models(options):
        scene = Scene().add(model)
        middle = tuple(scene.bounds().mean(axis=0).tolist())
        scene.clip = Clip((Plane(middle, (0.0, 0.0, -1.0)),))
        base = zoom_settings(scene, Settings(size=options.size))
        zoom = zoom_of(scene, renderer.fitted(scene, base), None)
        yield f"### {name}, {model.instances:,} instances, {model.atoms:,} atoms, cut in half"
        options.say(f"{name}, clutter")
        yield from _clutter(renderer, scene, zoom, base)
        options.say(f"{name}, cost")
        yield (
            "Growth of the frame by each part, per cent (Table 4.1). The bounce is measured at the "
            "atoms, all else at view b, as in the thesis; medians of both sides in turns."
        )
        here = table_4_1(renderer, scene, options)
        yield grid(
            ["", "here", "thesis"], {row: (here[row], printed) for row, printed in THESIS.items()}
        )
        options.say(f"{name}, calm")
        yield from _calm(renderer, scene, zoom, base)
        options.say(f"{name}, zoom")
        yield _jump(renderer, scene, zoom, base)
    yield PICTURES


def _clutter(renderer: Renderer, scene: Scene, zoom: Zoom, base: Settings) -> Iterator[str]:
    yield (
        "Clutter (edge density; subband entropy in bits) along the zoom of Figure 5.2: less with "
        "semantics from afar, about the same at the atoms (Figure 5.1 is view a). Of occlusion "
        "alone: shadows are off on both sides."
    )
    rows: dict[str, tuple[float | str | None, ...]] = {}
    for view, share in VIEWS.items():
        found = []
        for mode in MODES.values():
            settings = base.replace(semantic__mode=mode, semantic__shadow=0.0)
            picture = np.asarray(renderer.render(scene, zoom.camera(share), settings))
            found.append(f"{edge_density(picture):.3f}; {subband_entropy(picture):.2f}")
        rows[view] = tuple(found)
    yield grid(["view", *MODES], rows)


def _calm(renderer: Renderer, scene: Scene, zoom: Zoom, base: Settings) -> Iterator[str]:
    yield (
        "What moves in view a while the camera shifts by quarters of a pixel, and while it comes "
        "closer by half a pixel at the edge: deviation of luminance, in thousandths of white. The "
        "last rows are what an ideal picture moves by: outlines do move."
    )
    rows: dict[str, tuple[float | str | None, ...]] = {}
    camera = zoom.camera(0.0)
    for name, changes in CALM.items():
        for words, mode in (("without", "plain"), ("with", "screen")):
            settings = base.replace(semantic__mode=mode, **changes)
            rows[f"{name}, {words} semantics"] = (
                1000 * shimmer(renderer, scene, camera, settings),
                1000 * zoom_shimmer(renderer, scene, camera, settings),
            )
    yield grid(["", "shifts", "zoom"], rows)


def _jump(renderer: Renderer, scene: Scene, zoom: Zoom, base: Settings) -> str:
    settings = base.replace(size=SMALL)
    cameras = [zoom.camera(n / (FRAMES - 1)) for n in range(FRAMES)]
    means = [
        float(np.asarray(renderer.render(scene, camera, settings))[..., :3].mean())
        for camera in cameras
    ]
    jumps = np.abs(np.diff(means)) / 255
    # what a step adds to the change before and after it
    steps = np.abs(np.diff(means, 2)) / 255
    return (
        f"Over the {FRAMES} frames of the zoom, mean luminance changes by at most "
        f"{100 * jumps.max():.2f} % of full scale from frame to frame (1 % is the bound), and by "
        f"at most {100 * steps.max():.2f} % more or less than from the frame before."
    )


def _models(options: BenchOptions) -> Iterator[tuple[str, MesoscaleModel]]:
    structures = [structure_of_molecule(load(name)) for name in SAMPLES]
    yield "generated cell", generate(structures, GenerateSettings(atoms=ATOMS))
    for name in options.inputs:
        model = load(name)
        if not isinstance(model, MesoscaleModel):
            raise SettingsError(f"{name} is no cell-scale model")
        yield label(name), model
