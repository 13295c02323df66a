"""Molecules: occlusion, shadows and path tracing beside the tables of Easdon's thesis (2013).

Without inputs it measures droplets of 300 to 1,000,000 atoms, which are made anywhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from scuro.measure.bench import BenchOptions
from scuro.measure.bench.visibility import scenes
from scuro.measure.compare import Variant, compare, draw
from scuro.measure.results.page import grid
from scuro.render import Renderer
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
)
"""Techniques of the figure that are settings of one; all others follow with their defaults."""

_REFERENCE = Variant("ray, 1024 samples", {_AO: "ray", "occlusion__samples": 1024})


def occlusion_variants() -> list[Variant]:
    """The figure's techniques, and every other one that there is."""
    from scuro.passes.occlusion.occlusion import TECHNIQUES

    return [*FIGURE_4_9, *(Variant(name, {_AO: name}) for name in TECHNIQUES if name != "ray")]


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs, measured as they are asked for."""
    renderer = Renderer(options.device)
    width, height = options.size
    named = list(scenes(options))
    yield (
        "Beside each table stand the numbers that Easdon (2013) printed for an ATI Mobility Radeon "
        "HD 5650."
    )
    settings = options.plain().replace(lighting__preset="simple")
    for table in TABLES:
        rows = {}
        for name, scene in named:
            options.say(f"table {table.number}, {name}")
            camera = view_camera(scene, ViewSettings(), width / height)
            plain = draw(renderer, scene, camera, settings, Variant("none", {}), options.frames)
            own = table.unit == "s"  # a path-traced frame has no other in it
            rows[name] = tuple(
                table.scale
                * (
                    draw(
                        renderer, scene, camera, settings, Variant(column, changes), options.frames
                    ).milliseconds
                    - (0.0 if own else plain.milliseconds)
                )
                for column, changes in table.columns.items()
            )
        yield f"### {table.title} (Table {table.number})"
        heads = [f"{column} [{table.unit}]" for column in table.columns]
        yield grid(["here", *heads], rows)
        yield grid(["Easdon 2013", *heads], THESIS[table.number])
    yield "### Techniques of ambient occlusion against 1024 rays (Figure 4.9)"
    yield (
        "Milliseconds are whole frames. RMSE is of the visibility itself; SSIM and mean CIE ΔE2000 "
        "are of the picture over the molecule's pixels."
    )
    for name, scene in named:
        options.say(f"figure 4.9, {name}")
        camera = view_camera(scene, ViewSettings(), width / height)
        found = compare(
            renderer, scene, camera, settings, occlusion_variants(), _REFERENCE,
            frames=options.frames,
        )  # fmt: skip
        yield f"#### {name}"
        yield grid(
            ["technique", "ms", "RMSE", "SSIM", "ΔE2000"],
            {
                row.technique: (
                    row.milliseconds,
                    row.notes.get("visibility_rmse"),
                    row.object.ssim if row.object else None,
                    row.object.delta_e if row.object else None,
                )
                for row in found
            },
        )
