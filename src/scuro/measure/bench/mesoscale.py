"""Cell-scale models: load, build and frame time, growth with size, cost of each part.

Inputs are cell-scale models; without any, scenes of 10⁶ to 1.5·10¹⁰ atoms are generated from a
sample protein. Each scene has a process of its own. Frames are of the whole scene; ``costs`` are
the rows of Table 4.1 of Koch (2018) as growth of the frame in per cent, at the views that the
thesis names: the median over pairs of frames without and with, of processor time where a processor
draws. ``calm`` is what moves in the view of the whole scene under sub-pixel shifts and while
zooming (:mod:`scuro.measure.calm`), in thousandths of white, with and without levels of detail and
what else calms.
"""

from __future__ import annotations

import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from scuro.errors import SettingsError
from scuro.export.zoom import zoom_of, zoom_settings
from scuro.load import load
from scuro.load.mesoscale_structures import structure_of_molecule
from scuro.measure.bench import BenchOptions, label, median_seconds
from scuro.measure.calm import shimmer, zoom_shimmer
from scuro.measure.memory import peak_memory_mb
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.generate import GenerateSettings, generate
from scuro.scene.model import MesoscaleModel
from scuro.scene.scene import Scene

SIZES = (1e6, 1e7, 1e8, 1e9, 1.5e10)
SAMPLE = "sample:1tii"
COSTS_AT = 1e9
"""The generated scene whose costs are measured."""

PARTS: dict[str, dict[str, Any]] = {
    "primary": {"lighting__preset": "studio", "antialias__method": "none"},
    "screen": {"semantic__mode": "screen"},
    "traced": {"semantic__mode": "traced"},
}
COSTS: dict[str, tuple[float, dict[str, Any], dict[str, Any]]] = {
    "light bounce": (1.0, {"semantic__bounce": 0.0}, {}),
    "shadows": (1 / 3, {"semantic__shadow": 0.0}, {}),
    # without calm, whose rays go where a blur leaves edges: the less it blurs, the more
    "blur 1 to 10": (
        1 / 3,
        {"semantic__calm": 0.0, "semantic__blur_occlusion": 1},
        {"semantic__calm": 0.0, "semantic__blur_occlusion": 10},
    ),
    "samples 16 to 64": (1 / 3, {}, {"semantic__samples": 64}),
}
"""Rows of Table 4.1: where on the zoom of Figure 5.2 (a is 0, d is 1), without, with."""

PAIRS = 12
"""Pairs of frames behind each of these at least: on a busy machine the figure then comes out within
two points or so of itself (five pairs: four; elapsed time: ten)."""

CALM: dict[str, dict[str, Any]] = {
    "atoms as they are": {"detail": 0.0, "semantic__calm": 0.0},
    "calmed": {},
}


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every scene; see the module."""
    rows: list[dict[str, Any]] = []
    costs: dict[str, dict[str, float]] = {}
    calm: dict[str, dict[str, dict[str, float]]] = {}
    adapter = ""
    for scene in options.inputs or SIZES:
        options.say(str(scene) if options.inputs else f"generated {scene:.3g}")
        in_depth = bool(options.inputs) or scene == COSTS_AT
        found = _apart(scene, replace(options, say=_nothing), in_depth)
        adapter, name = found["adapter"], found["row"]["scene"]
        rows.append(found["row"])
        if in_depth:
            costs[name], calm[name] = found["costs"], found["calm"]
    return {
        "adapter": adapter,
        "size": list(options.size),
        "frames": options.frames,
        "growth": round(rows[-1]["screen_s"] / rows[0]["screen_s"], 2),
        "costs": costs,
        "calm": calm,
        "rows": rows,
    }


def _nothing(text: str) -> None:
    """Processes of scenes say nothing."""


def _apart(scene: str | float, options: BenchOptions, in_depth: bool) -> dict[str, Any]:
    """:func:`measure` in a process of its own: its peak of memory is what a user sees."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, context) as pool:
        return pool.submit(measure, scene, options, in_depth).result()


def measure(name: str | float, options: BenchOptions, in_depth: bool) -> dict[str, Any]:
    """One scene: adapter and row, and costs and calm if it is looked at in depth.

    The peak of memory is the process's after the frames, before what is measured in depth.
    """
    name, model, seconds = _model(name)
    renderer = Renderer(options.device)
    scene = Scene().add(model)
    start = time.perf_counter()
    accelerator = renderer.accelerator(scene)
    renderer.gpu.finish()
    row: dict[str, Any] = {
        "scene": name,
        "atoms": model.atoms,
        "instances": model.instances,
        "load_s": round(seconds, 3),
        "build_s": round(time.perf_counter() - start, 3),
    }
    base = Settings(size=options.size)
    camera = renderer.fitted(scene, base)
    for part, changes in PARTS.items():
        action = partial(draw, renderer, scene, camera, base.replace(**changes))
        row[f"{part}_s"] = round(median_seconds(action, options.frames), 4)
    row["gpu_mb"] = round(accelerator.bytes / 1e6, 1)
    row["peak_mb"] = peak_memory_mb()
    found: dict[str, Any] = {"adapter": str(renderer.gpu.info), "row": row}
    if in_depth:
        # a renderer that has drawn nothing else: what is left of traced pictures adds to the bounce
        costs = table_4_1(renderer.sibling(), scene, options)
        found["costs"] = {cost: round(percent, 1) for cost, percent in costs.items()}
        screen = base.replace(**PARTS["screen"])
        found["calm"] = {
            words: _moving(renderer, scene, camera, screen.replace(**changes))
            for words, changes in CALM.items()
        }
    return found


def draw(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings) -> None:
    """A frame, until the GPU is done; the picture stays there."""
    for _ in renderer.frames(scene, camera, settings):
        pass
    renderer.gpu.finish()


def _moving(
    renderer: Renderer, scene: Scene, camera: Camera, settings: Settings
) -> dict[str, float]:
    return {
        "shifts": round(1000 * shimmer(renderer, scene, camera, settings), 1),
        "zoom": round(1000 * zoom_shimmer(renderer, scene, camera, settings), 1),
    }


def table_4_1(renderer: Renderer, scene: Scene, options: BenchOptions) -> dict[str, float]:
    """Growth of the frame by each row of the thesis's table, per cent; both sides in turns."""
    base = zoom_settings(scene, Settings(size=options.size))
    zoom = zoom_of(scene, renderer.fitted(scene, base), None)
    # elapsed time tells more of what else runs than of a pass
    clock = time.process_time if renderer.gpu.info.software else time.perf_counter
    found = {}
    for cost, (share, *changes) in COSTS.items():
        options.say(cost)
        camera = zoom.camera(share)
        times = np.zeros((max(options.frames, PAIRS) + 1, 2))
        for pair, row in enumerate(times):
            for side in (pair % 2, 1 - pair % 2):  # whatever drifts favours neither
                start = clock()
                draw(renderer, scene, camera, base.replace(**changes[side]))
                row[side] = clock() - start
        # the first of each compiles and warms up; neighbours are disturbed alike
        without, with_ = times[1:].T
        found[cost] = 100 * float(np.median(with_ / without) - 1)
    return found


def _model(name: str | float) -> tuple[str, MesoscaleModel, float]:
    """Name, model and seconds to load it, or to generate one of so many atoms."""
    start = time.perf_counter()
    if isinstance(name, str):
        model = load(name)
        if not isinstance(model, MesoscaleModel):
            raise SettingsError(f"{name} is no cell-scale model: this benchmark needs them")
        return label(name), model, time.perf_counter() - start
    structure = structure_of_molecule(load(SAMPLE))
    start = time.perf_counter()
    generated = generate([structure], GenerateSettings(atoms=name))
    return f"generated {name:.3g}", generated, time.perf_counter() - start
