"""Reservoirs: the tables of chapter 4 of Campagnolo's thesis (2021) with models of this program.

Without inputs it measures a faulted dome of about 40,000 active cells, which is made anywhere.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from scuro.load import load
from scuro.measure.bench import BenchOptions, label
from scuro.measure.bench.reservoir import unlit
from scuro.measure.compare import draw
from scuro.measure.results.page import grid
from scuro.measure.turns import centered, compare_turned, means
from scuro.measure.variant import Variant
from scuro.passes.reservoir.light import ReservoirLight, light_settings
from scuro.passes.reservoir.resample import cubic_size
from scuro.render import Renderer
from scuro.scene.cornerpoint_synthetic import faulted_dome
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera
from scuro.style.reservoir import item_transfer

TITLE = "Reservoirs: volumes in corner-point cells"

R1, R2, R3, R4, R5 = "R1", "R2", "R3", "R4", "R5"
THESIS: dict[str, dict[str, tuple[float | str | None, ...]]] = {
    "4.1": {
        R1: ("60×20×10", "12,000", 6.25, 1.1), R2: ("76×43×23", "28,952", 4.96, 2.3),
        R3: ("46×69×30", "42,353", 3.99, 4.4), R4: ("102×72×40", "286,840", 9.38, 17.7),
        R5: ("346×352×100", "6,245,219", 3.20, 211.5),
    },
    "4.2": {R1: (17, 450), R2: (15, "1,935"), R3: (11, 967), R4: (6, 484), R5: (4, "5,947")},
    "4.3": {
        R1: (13.02, "128×128×128", "64×64×64", 0.5, 20, 3),
        R2: (20.77, "256×256×256", "128×128×128", 4.0, 15, 3),
        R3: (17.40, "256×256×256", "128×128×128", 4.0, 15, 3),
        R4: (23.70, "256×256×768", "128×128×256", 8.0, 25, 7),
        R5: (35.39, "768×768×768", "400×400×400", 122.1, 20, 7),
    },
    "4.4": {
        R1: (426, 334), R2: (91, 70), R3: (105, 80), R4: (85, 54), R5: (17, 7),
    },
    "4.5": {
        "R3, 64³": (69.62, 12, 1.1), "R3, 128³": (34.82, 38, 8.6), "R3, 256³": (17.40, 190, 68.6),
        "R3, 512³": (8.71, "1,164", 548.6), "R5, 384³": (70.77, "2,097", 231.5),
        "R5, 512³": (53.08, "2,704", 548.6), "R5, 768³": (35.39, "15,802", "1,860.5"),
        "R5, 1024³": (26.54, "17,157", "4,388.6"),
    },
}  # fmt: skip
"""Printed in the thesis, on an NVIDIA GeForce RTX 2080 Ti with a viewport of 1000²."""

VIEWS = 3
"""About each axis: 0, 90 and 180 degrees, as in Figure 4.9."""

RESOLUTIONS = (64, 128, 256)
"""Of volumes of coefficients, along the longest side."""

_STRATEGIES = (
    Variant("SRG", {"strategy__technique": "srg"}),
    Variant("LIBC, samples", {"strategy__technique": "libc", "strategy__fast": False}),
    Variant("LIBC, tables", {"strategy__technique": "libc", "strategy__fast": True}),
)
_PLTS = Variant("PLTS", {"strategy__technique": "plts"})


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs, measured as they are asked for."""
    renderer = Renderer(options.device)
    grids = [(label(name), load(name)) for name in options.inputs]
    scenes = {
        name: Scene().add(model) for name, model in grids or [("dome", faulted_dome(64, 64, 13))]
    }
    width, height = options.size
    yield (
        f"Measured on {renderer.gpu.info} with a viewport of {width}×{height}; beside each table "
        "stand the figures that Campagnolo (2021) printed for other models, an NVIDIA GeForce RTX "
        "2080 Ti and 1000×1000. Emission and absorption alone but where occlusion is named."
    )
    yield from _models(renderer, scenes, options)
    yield from _strategies(renderer, scenes, options)
    yield from _light(renderer, scenes, options)


def _settings(options: BenchOptions) -> Any:
    return unlit(options, reservoir__wells=False)


def _drawn(renderer: Renderer, scene: Scene, options: BenchOptions, changes: dict[str, Any]) -> Any:
    """A variant drawn from where it fits whatever way it turns."""
    width, height = options.size
    scene.show_reservoirs(_settings(options).reservoir)
    camera = view_camera(scene, ViewSettings(), width / height)
    camera = centered(camera, scene.bounds(), width / height)
    variant = Variant("", changes)
    return draw(renderer, scene, camera, _settings(options), variant, options.frames)


def _models(renderer: Renderer, scenes: dict[str, Scene], options: BenchOptions) -> Iterator[str]:
    """Tables 4.1 and 4.2: what models and their resampled grids take."""
    models, resampled = {}, {}
    for name, scene in scenes.items():
        options.say(f"tables 4.1 and 4.2, {name}")
        settings = _settings(options)
        libc = _drawn(renderer, scene, options, {"strategy__technique": "libc"}).megabytes
        model = renderer.reservoirs.model(scene.reservoirs[0])
        shape = "×".join(map(str, model.grid.dimensions))
        step = model.unit * settings.strategy.step
        models[name] = (shape, f"{model.grid.active_count:,}", step, libc)
        srg = _drawn(renderer, scene, options, {"strategy__technique": "srg"}).megabytes
        resampled[name] = (settings.strategy.resample, srg - libc)
    yield "### Models and their memory (Table 4.1)"
    yield (
        "The step h is an eighth of a cell's least mean extent, heights exaggerated as the picture "
        "shows them. Values at vertices are counted here, too."
    )
    heads = ["cells", "active", "h", "MB"]
    yield grid(["here", *heads], models)
    yield grid(["Campagnolo 2021", *heads], THESIS["4.1"])
    yield "### Memory of the resampled grid beside it (Table 4.2)"
    yield grid(["here", "r′", "MB"], resampled)
    yield grid(["Campagnolo 2021", "r′", "MB"], THESIS["4.2"])


def _strategies(
    renderer: Renderer, scenes: dict[str, Scene], options: BenchOptions
) -> Iterator[str]:
    """Figure 4.10: strategies against PLTS over turned views."""
    yield "### Strategies against PLTS over turned views (Figure 4.10)"
    yield (
        f"Means over {3 * VIEWS} views: {VIEWS} of a half turn about each of X, Y and Z. PSNR, "
        "SSIM and mean CIE ΔE2000 are of the model's pixels. The figure has curves, no numbers to "
        "stand beside. LIBC with samples takes those of PLTS; with tables it integrates each "
        "cell at once."
    )
    for name, scene in scenes.items():
        options.say(f"figure 4.10, {name}")
        width, height = options.size
        settings = _settings(options)
        scene.show_reservoirs(settings.reservoir)
        camera = view_camera(scene, ViewSettings(), width / height)
        found = compare_turned(
            renderer, scene, camera, settings, _STRATEGIES, _PLTS, VIEWS, frames=options.frames
        )
        rows = {
            row.technique: (
                row.milliseconds,
                *((row.object.psnr, row.object.ssim, row.object.delta_e) if row.object else ()),
            )
            for row in means(found)
        }
        whole = {key: (*values, *[None] * (4 - len(values))) for key, values in rows.items()}
        yield f"#### {name}"
        yield grid(["strategy", "ms", "PSNR", "SSIM", "ΔE2000"], whole)


def _light(renderer: Renderer, scenes: dict[str, Scene], options: BenchOptions) -> Iterator[str]:
    """Tables 4.3, 4.4 and 4.5: occlusion by cones."""
    parameters, rates, volumes = {}, {}, {}
    occlusion = {"strategy__occlusion": True}
    settings = _settings(options)
    for name, scene in scenes.items():
        options.say(f"tables 4.3 to 4.5, {name}")
        plain = _drawn(renderer, scene, options, {})
        lit = _drawn(renderer, scene, options, occlusion)
        rates[name] = (1e3 / plain.milliseconds, 1e3 / lit.milliseconds)
        model = renderer.reservoirs.model(scene.reservoirs[0])
        size = cubic_size(model, settings.strategy.light_resolution)
        longest = float((model.bounds[1] - model.bounds[0]).max())
        shape = "×".join(map(str, size))
        parameters[name] = (
            longest / max(size), shape, shape, 8 * size[0] * size[1] * size[2] / 1e6,
            settings.volume.occlusion.angle, settings.volume.occlusion.cones,
        )  # fmt: skip
        for resolution in RESOLUTIONS:
            light, seconds = _prepared(renderer, scene, options, resolution)
            shape = "×".join(map(str, light.picture.grid.size))
            volumes[f"{name}, {shape}"] = (
                longest / max(light.picture.grid.size), 1e3 * seconds, light.bytes / 1e6,
            )  # fmt: skip
    yield "### Occlusion: parameters (Table 4.3)"
    yield (
        "Light is worked out in the grid of the coefficients itself, only where there is matter, "
        "for occlusion and three shadows at once."
    )
    heads = ["σ₀", "coefficients", "pre-illumination", "MB of it", "θ", "cones"]
    yield grid(["here", *heads], parameters)
    yield grid(["Campagnolo 2021", *heads], THESIS["4.3"])
    yield "### Frames a second without and with pre-illuminated occlusion (Table 4.4)"
    heads = ["emission and absorption [fps]", "with occlusion [fps]"]
    yield grid(["here", *heads], rates)
    yield grid(["Campagnolo 2021", *heads], THESIS["4.4"])
    yield "### Making the volume of coefficients (Table 4.5)"
    yield "By accurate point location, with the pyramid over it."
    heads = ["σ₀", "ms", "MB"]
    yield grid(["here", *heads], volumes)
    yield grid(["Campagnolo 2021", *heads], THESIS["4.5"])


def _prepared(
    renderer: Renderer, scene: Scene, options: BenchOptions, resolution: int
) -> tuple[ReservoirLight, float]:
    """Light of a resolution, and the seconds that its coefficients take to make."""
    changes = {"strategy__occlusion": True, "strategy__light_resolution": resolution}
    _drawn(renderer, scene, options, changes)  # compiles what is needed
    model = renderer.reservoirs.model(scene.reservoirs[0])
    settings = _settings(options)
    volume = light_settings(settings.volume, settings.strategy)
    start = time.perf_counter()
    light = ReservoirLight(model, resolution)
    light.coefficients(volume, item_transfer(scene.reservoirs[0]), scene.clip.cutting, ())
    renderer.gpu.finish()
    return light, time.perf_counter() - start
