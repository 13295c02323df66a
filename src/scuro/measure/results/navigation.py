"""Navigation cube: drawing and shadows of 327 atoms cut out of larger molecules (Easdon 2013)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.bench.visibility import droplets
from scuro.measure.results.page import grid
from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, ClippingSettings
from scuro.scene.scene import Scene

TITLE = "Molecules: the navigation cube"

_ATOMS = 327
THESIS = {
    "1CRN, 327": (0.32, 0.0, 12.68, 0.0),
    "1BKS, 5,231": (0.36, 0.04, 18.77, 6.09),
    "3ETS, 9,152": (0.36, 0.04, 18.53, 5.85),
    "1JB0, 24,198": (0.36, 0.04, 19.21, 6.53),
    "1AON, 58,870": (0.37, 0.05, 18.84, 6.16),
    "3IYN, 99,595": (0.38, 0.06, 19.23, 6.55),
}
"""Printed in the thesis, on an ATI Mobility Radeon HD 5650, milliseconds."""
_SIZES = (_ATOMS, 5_231, 9_152, 24_198, 58_870, 99_595, 1_000_000)


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs, measured as they are asked for."""
    renderer = Renderer(options.device)
    rows: dict[str, tuple[float, ...]] = {}
    for count in _SIZES:
        options.say(f"{count:,} atoms")
        frame, shadow = _milliseconds(renderer, droplets(count, 1), options)
        first = next(iter(rows.values()), (frame, 0.0, shadow, 0.0))
        rows[f"droplet, {count:,}"] = (frame, frame - first[0], shadow, shadow - first[2])
    yield (
        f"A cube in the middle holds {_ATOMS} atoms and fills the picture's height; the smallest "
        f"molecule is not cut. Milliseconds on {renderer.gpu.info}, "
        f"{options.size[0]} × {options.size[1]}; a cut shows flat caps where an uncut molecule is "
        "round, and fills the picture's corners, so that some of the overhead is more pixels. "
        "Beside it, Easdon's for an ATI Mobility Radeon HD 5650."
    )
    heads = ["frame", "overhead", "shadow", "overhead of shadow"]
    yield "### Frame (Table 3.1) and hard shadow (Table 5.1) by atoms of the whole molecule"
    yield grid(["here, ms", *heads], rows)
    yield grid(["Easdon 2013, ms", *heads], THESIS)


def _milliseconds(renderer: Renderer, scene: Scene, options: BenchOptions) -> tuple[float, float]:
    """Of a frame without shadows, and what hard shadows add."""
    centers = np.concatenate([b.geometry.spheres[:, :3] + b.positions[0] for b in scene.bodies()])
    middle = centers.mean(axis=0)
    # a cube holds what lies nearer than half its edge along every axis
    edge = 2 * float(np.sort(np.abs(centers - middle).max(axis=1))[_ATOMS - 1]) + 1e-3
    if len(centers) > _ATOMS:
        scene.clip = Clip(ClippingSettings(cube=(edge, edge, edge)).box(middle))
    corners = middle + edge / 2 * np.array([[-1.0] * 3, [1.0] * 3])
    camera = Camera.fitted(corners, aspect=options.size[0] / options.size[1])
    times = []
    for technique in ("none", "hard"):
        settings = options.plain().replace(shadows__technique=technique)

        def draw() -> None:
            renderer.frame(scene, camera, settings).recorder.submit()  # noqa: B023
            renderer.gpu.finish()

        times.append(1e3 * median_seconds(draw, options.frames))
    return times[0], times[1] - times[0]
