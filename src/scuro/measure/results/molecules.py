"""Molecules: occlusion, shadows and path tracing beside the tables of Easdon's thesis (2013).

Without inputs it measures droplets of 300 to 1,000,000 atoms, which are made anywhere.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from scuro.export.files import replacing
from scuro.load import load
from scuro.measure.bench import BenchOptions, label
from scuro.measure.bench.visibility import scenes
from scuro.measure.compare import compare, draw
from scuro.measure.results.page import grid
from scuro.measure.variant import Variant
from scuro.render import Renderer
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

TITLE = "Molecules: occlusion and shadows"

THESIS: dict[str, dict[str, tuple[float, ...]]] = {
    "4.1": {
        "1CRN, 327": (21.67, 7.04), "1BKS, 5,231": (47.28, 15.51), "3ETS, 9,152": (56.89, 17.30),
        "1JB0, 24,198": (58.33, 16.68), "1AON, 58,870": (64.07, 20.50),
        "3IYN, 99,595": (71.90, 23.64),
    },
    "4.3": {
        "1CRN, 327": (2.41, 4.19, 6.66), "1BKS, 5,231": (2.44, 4.31, 7.02),
        "3ETS, 9,152": (2.72, 4.83, 7.61), "1JB0, 24,198": (2.74, 4.90, 7.97),
        "1AON, 58,870": (2.48, 4.41, 7.68), "3IYN, 99,595": (2.39, 4.36, 6.58),
    },
    "5.2": {
        "1CRN, 327": (12.72, 15.54), "1BKS, 5,231": (26.68, 33.77), "3ETS, 9,152": (33.53, 43.69),
        "1JB0, 24,198": (38.29, 49.33), "1AON, 58,870": (38.04, 50.14),
        "3IYN, 99,595": (35.93, 47.14),
    },
    "5.3": {
        "1CRN, 327": (8.33,), "1BKS, 5,231": (19.62,), "3ETS, 9,152": (24.77,),
        "1JB0, 24,198": (26.85,), "1AON, 58,870": (31.89,),
    },
}  # fmt: skip
"""Printed in the thesis, on an ATI Mobility Radeon HD 5650: milliseconds; seconds in 5.3."""


@dataclass(frozen=True)
class Timed:
    """A table of times: a column for each variant, less the time of the frame without it."""

    number: str
    title: str
    columns: dict[str, dict[str, Any]]
    unit: str = "ms"
    scale: float = 1.0
    """From milliseconds measured to the unit and the count that the thesis states."""


_AO = "occlusion__technique"
_RAY_1 = {_AO: "ray", "occlusion__samples": 1}
_PATH_SAMPLES = 4
TABLES = (
    Timed("4.1", "Ray-traced ambient occlusion, 1 sample, with its filter", {
        "full resolution": _RAY_1,
        "half resolution": _RAY_1 | {"occlusion__resolution": "half"},
    }),
    Timed("4.3", "Analytical ambient occlusion by occluders an atom", {
        f"{k} atoms": {_AO: "analytic", "occlusion__analytic__neighbours": k} for k in (8, 16, 32)
    }),
    Timed("5.2", "Shadows of one light", {
        "hard": {"shadows__technique": "hard"}, "soft": {"shadows__technique": "soft"},
    }),
    Timed("5.3", f"Path tracing, 100 samples, 3 bounces (measured: {_PATH_SAMPLES} samples)", {
        "path": {"renderer": "path", "path__samples": _PATH_SAMPLES, "path__bounces": 3},
    }, "s", 1e-3 * 100 / _PATH_SAMPLES),
)  # fmt: skip

FIGURE_4_9 = (
    Variant("none", {_AO: "none"}),
    Variant("ray, 100 samples", {_AO: "ray", "occlusion__samples": 100}),
    Variant("ray, 1 sample, half", _RAY_1 | {"occlusion__resolution": "half"}),
    Variant("ray, 4 samples", {_AO: "ray"}),
    Variant(
        "ray, 16 samples, unfiltered",
        {_AO: "ray", "occlusion__samples": 16, "occlusion__filter": "none"},
    ),
    Variant("hybrid, 4 samples", {_AO: "hybrid", "occlusion__samples": 4}),
)
"""Techniques of the figure that are settings of one; all others follow with their defaults."""

_REFERENCE = Variant("ray, 1024 samples", {_AO: "ray", "occlusion__samples": 1024})


def occlusion_variants() -> list[Variant]:
    """The figure's techniques, and every other one that there is."""
    from scuro.passes.occlusion.occlusion import TECHNIQUES

    return [*FIGURE_4_9, *(Variant(name, {_AO: name}) for name in TECHNIQUES if name != "ray")]


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs.

    Inputs are files, with ``#N`` for biological assembly N. Numbers of other inputs that
    ``options.measured`` holds stand beside; those of this run are added to it.
    """
    measured: dict[str, Any] = {}
    if options.measured and options.measured.exists():
        measured = json.loads(options.measured.read_text("utf-8"))
    renderer = Renderer(options.device)
    for name, scene in _scenes(options):
        measured[name] = _measure(renderer, name, scene, options)
        if options.measured:
            with replacing(options.measured) as file:
                file.write(json.dumps(measured, indent=1).encode())
    named = dict(sorted(measured.items(), key=lambda pair: pair[1]["atoms"]))
    yield (
        "Beside each table stand the numbers that Easdon (2013) printed for an ATI Mobility Radeon "
        f"HD 5650. Here: {renderer.gpu.info}, {options.size[0]} × {options.size[1]}."
    )
    for table in TABLES:
        yield f"### {table.title} (Table {table.number})"
        heads = [f"{column} [{table.unit}]" for column in table.columns]
        rows = {
            _titled(name, found): tuple(map(_told, found[table.number]))
            for name, found in named.items()
        }
        yield grid(["here", *heads], rows)
        yield grid(["Easdon 2013", *heads], THESIS[table.number])
    yield "### Techniques of ambient occlusion against 1024 rays (Figure 4.9)"
    yield (
        "Milliseconds are what the technique adds to the frame without occlusion. Over the "
        "molecule's pixels: RMSE of the visibility itself; mean and local contrast of the picture "
        "over those of the reference; SSIM and mean CIE ΔE2000 of the picture. Plain sampling is "
        "'ray, 16 samples, unfiltered'."
    )
    for name, found in named.items():
        yield f"#### {_titled(name, found)}"
        rows = {name: (_told(row[0]), *row[1:]) for name, row in found["4.9"].items()}
        yield grid(["technique", "ms", "RMSE", "mean", "contrast", "SSIM", "ΔE2000"], rows)


def _told(time: float) -> float | str:
    """What a technique adds to a frame, where the difference of two medians tells anything."""
    return time if time > 0 else "below noise"


def _titled(name: str, found: dict[str, Any]) -> str:
    return f"{name}, {found['atoms']:,}"


def _scenes(options: BenchOptions) -> Iterator[tuple[str, Scene]]:
    if not options.inputs and not options.measured:
        yield from scenes(options)
    for given in options.inputs:
        path, _, assembly = given.partition("#")
        scene = Scene().add(load(path)).show("spacefill")
        if assembly:
            scene.molecules[0].assembly = assembly
        yield label(path) + given[len(path) :], scene


def _measure(renderer: Renderer, name: str, scene: Scene, options: BenchOptions) -> dict[str, Any]:
    """Rows of all tables for one scene."""
    width, height = options.size
    settings = options.plain().replace(
        lighting__preset="simple", occlusion__technique="none", shadows__technique="none"
    )
    camera = view_camera(scene, ViewSettings(), width / height)

    def timed(changes: dict[str, Any]) -> float:
        variant = Variant("", changes)
        return draw(renderer, scene, camera, settings, variant, options.frames).milliseconds

    plain = timed({})
    found: dict[str, Any] = {"atoms": renderer.accelerator(scene).spheres}
    for table in TABLES:
        options.say(f"table {table.number}, {name}")
        bare = 0.0 if table.unit == "s" else plain  # a path-traced frame has no other in it
        found[table.number] = [
            table.scale * (timed(changes) - bare) for changes in table.columns.values()
        ]
    options.say(f"figure 4.9, {name}")
    rows = compare(
        renderer, scene, camera, settings, occlusion_variants(), _REFERENCE, frames=options.frames
    )
    found["4.9"] = {
        row.technique: [
            row.milliseconds - plain,
            row.notes.get("visibility_rmse"),
            row.object.mean_luminance / row.object.mean_luminance_reference,
            row.object.local_contrast / row.object.local_contrast_reference,
            row.object.ssim,
            row.object.delta_e,
        ]
        for row in rows
        if row.object
    }
    return found
