"""Cell-scale models: load, build and frame time, growth with size, cost of each part, clutter.

Inputs are cell-scale models; without any, scenes of 10⁶ to 1.5·10¹⁰ atoms are generated from a
sample protein.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from scuro.load import load
from scuro.load.mesoscale_structures import structure_of_molecule
from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.clutter import edge_density, subband_entropy
from scuro.measure.memory import peak_memory_mb
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.generate import GenerateSettings, generate
from scuro.scene.model import MesoscaleModel
from scuro.scene.scene import Scene

SIZES = (1e6, 1e7, 1e8, 1e9, 1.5e10)
SAMPLE = "sample:1tii"

PARTS = {
    "primary": {"semantic__mode": "off"},
    "screen": {},
    "plain": {"semantic__mode": "plain"},
    "traced": {"semantic__mode": "traced"},
    "without bounce": {"semantic__bounce": 0.0},
    "without shadow": {"semantic__shadow": 0.0},
    "blur 1": {"semantic__blur_occlusion": 1},
    "blur 10": {"semantic__blur_occlusion": 10},
    "64 samples": {"semantic__samples": 64},
}
"""Rows for each scene: Table 4.1 of the thesis, and what there is besides."""


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every scene; see the module."""
    rows = []
    adapter = ""
    for name, model, seconds in _models(options):
        renderer = Renderer(options.device)
        adapter = str(renderer.gpu.info)
        scene = Scene().add(model)
        start = time.perf_counter()
        accelerator = renderer.accelerator(scene)
        renderer.gpu.finish()
        built = time.perf_counter() - start
        camera = renderer.fitted(scene, options.plain())
        for part, changes in PARTS.items():
            options.say(f"{name}, {part}")
            base = options.plain().replace(semantic__mode="screen")
            settings = base.replace(**changes)

            def draw(settings: Settings = settings, renderer: Renderer = renderer) -> Any:
                return renderer.render(scene, camera, settings)  # noqa: B023

            picture = np.asarray(draw())
            rows.append(
                {
                    "scene": name,
                    "part": part,
                    "atoms": model.atoms,
                    "instances": model.instances,
                    "load_s": round(seconds, 3),
                    "build_s": round(built, 3),
                    "frame_s": round(median_seconds(draw, options.frames), 4),
                    "gpu_mb": round(accelerator.bytes / 1e6, 1),
                    "edge_density": round(edge_density(picture), 4),
                    "subband_entropy": round(subband_entropy(picture), 3),
                }
            )
    return {
        "adapter": adapter,
        "size": list(options.size),
        "frames": options.frames,
        "peak_memory_mb": peak_memory_mb(),
        "rows": rows,
    }


def _models(options: BenchOptions) -> Iterator[tuple[str, MesoscaleModel, float]]:
    """Name, model and seconds to load or to generate it."""
    if options.inputs:
        for name in options.inputs:
            start = time.perf_counter()
            yield name, load(name), time.perf_counter() - start
        return
    structure = structure_of_molecule(load(SAMPLE))
    for atoms in SIZES:
        start = time.perf_counter()
        model = generate([structure], GenerateSettings(atoms=atoms))
        yield f"generated {atoms:.3g}", model, time.perf_counter() - start
