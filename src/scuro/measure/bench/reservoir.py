"""Reservoirs: time and memory of each strategy, of light, time steps and a six-million-cell model.

Without inputs the models are faulted domes: one of about 40,000 active cells, whose strategies are
held against PLTS, one of about 100,000 for changes of the time step, and one of 6 million, which is
written as an EGRID file and read back. Inputs are models to measure like the first.
"""

from __future__ import annotations

import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.load import load
from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.metrics import psnr, ssim
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.cornerpoint import CornerPointGrid
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_FORTY_THOUSAND, _HUNDRED_THOUSAND, _SIX_MILLION = (64, 64, 13), (90, 90, 17), (310, 280, 95)
_WAYS: dict[str, dict[str, Any]] = {
    "plts": {"technique": "plts"},
    "libc": {"technique": "libc", "fast": False},
    "libc, fast": {"technique": "libc", "fast": True},
    "libc, fast, occlusion": {"technique": "libc", "fast": True, "occlusion": True},
    "srg": {"technique": "srg"},
}
"""Settings of ``strategy``; without occlusion but where it is named, and without shadows."""


def unlit(options: BenchOptions, **changes: Any) -> Settings:
    """Emission and absorption of the volume alone: what the strategies themselves take."""
    return (
        options.plain()
        .replace(reservoir__show="volume", strategy__occlusion=False)
        .replace(**changes)
    )


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure; see the module."""
    renderer = Renderer(options.device)
    rows = []
    models = [(name, load(name)) for name in options.inputs]
    for name, grid in models or [("dome 40,000", faulted_dome(*_FORTY_THOUSAND))]:
        rows += _strategies(renderer, name, grid, options)
    if not options.inputs:
        rows.append(_time_step(renderer, options))
        rows += _large(renderer, options)
    return {
        "adapter": str(renderer.gpu.info),
        "size": list(options.size),
        "frames": options.frames,
        "rows": rows,
    }


def _strategies(
    renderer: Renderer, name: str, grid: CornerPointGrid, options: BenchOptions
) -> list[dict[str, Any]]:
    """Each strategy's time, and its likeness to PLTS."""
    scene = Scene().add(grid)
    rows, reference = [], None
    for way, changes in _WAYS.items():
        options.say(f"{name}, {way}")
        settings = unlit(options, **{f"strategy__{k}": v for k, v in changes.items()})
        camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
        draw = partial(_draw, renderer, scene, camera, settings)
        seconds = median_seconds(draw, options.frames)
        pixels = draw()[..., :3] / 255
        if reference is None:
            reference = pixels
        rows.append(
            {
                "model": name,
                "what": way,
                "seconds": round(seconds, 4),
                "PSNR": round(min(float(psnr(pixels, reference)), 99.0), 2),
                "SSIM": round(float(ssim(pixels, reference)), 4),
                **_memory(renderer, scene, settings),
            }
        )
    return rows


def _draw(
    renderer: Renderer, scene: Scene, camera: Camera, settings: Settings
) -> NDArray[np.uint8]:
    return np.asarray(renderer.render(scene, camera, settings))


def _memory(renderer: Renderer, scene: Scene, settings: Settings) -> dict[str, Any]:
    (item,) = scene.reservoirs
    total = renderer.reservoirs.bytes(item, settings.strategy)
    return {
        "active cells": item.grid.active_count,
        "GPU MB": round(total / 1e6, 2),
        "bytes a cell": round(total / item.grid.active_count, 1),
    }


def _time_step(renderer: Renderer, options: BenchOptions) -> dict[str, Any]:
    """From one time step's values to those of the next, on the GPU."""
    options.say("time step")
    scene = Scene().add(faulted_dome(*_HUNDRED_THOUSAND))
    settings = unlit(options, reservoir__property="SWAT").replace(size=(64, 64))
    renderer.render(scene, None, settings)
    step = 0

    def change() -> None:
        nonlocal step
        step = (step + 1) % 4
        renderer.render(scene, None, settings.replace(reservoir__time=step))
        renderer.gpu.finish()

    seconds = median_seconds(change, options.frames)
    return _row(renderer, scene, settings, "dome 100,000", "next time step, 64 x 64", seconds)


def _large(renderer: Renderer, options: BenchOptions) -> list[dict[str, Any]]:
    """Six million cells: reading, the first picture, further ones."""
    options.say("six million cells")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "DOME.EGRID"
        write_egrid(path, faulted_dome(*_SIX_MILLION))
        start = time.perf_counter()
        grid = load(path)
        reading = time.perf_counter() - start
    scene = Scene().add(grid)
    settings = unlit(options, reservoir__property="DEPTH")
    scene.show_reservoirs(settings.reservoir)
    start = time.perf_counter()
    camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
    _draw(renderer, scene, camera, settings)
    first = time.perf_counter() - start
    again = median_seconds(partial(_draw, renderer, scene, camera, settings), options.frames)
    for what, seconds in (("read", reading), ("first picture", first), ("libc, fast", again)):
        rows.append(_row(renderer, scene, settings, "dome 6,000,000", what, seconds))
    return rows


def _row(
    renderer: Renderer, scene: Scene, settings: Settings, model: str, what: str, seconds: float
) -> dict[str, Any]:
    return {
        "model": model,
        "what": what,
        "seconds": round(seconds, 4),
        "PSNR": None,
        "SSIM": None,
        **_memory(renderer, scene, settings),
    }


def write_egrid(path: Path, grid: CornerPointGrid) -> None:
    """Write a grid's geometry as an EGRID file in metres."""
    import resfo

    head = np.zeros(100, np.int32)
    head[0], head[1:4] = 1, grid.dimensions
    resfo.write(
        path,
        [
            ("FILEHEAD", np.zeros(100, np.int32)),
            ("GRIDUNIT", [b"METRES  ", b"        "]),
            ("GRIDHEAD", head),
            ("COORD   ", grid.coord.astype(np.float32).ravel()),
            ("ZCORN   ", grid.zcorn.ravel()),
            ("ACTNUM  ", grid.active.astype(np.int32).ravel()),
        ],
    )
