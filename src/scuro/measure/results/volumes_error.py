"""Volumes: errors against Monte Carlo, beside Table C.1 of Campagnolo's thesis (2021).

Also the two limits that the thesis admits (section 3.5.1) and the options of ours against them:
opaque oblique regions come out too dark, semi-transparent ones too light.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from scuro.measure.bench import BenchOptions
from scuro.measure.compare import draw
from scuro.measure.fit import LEAST_OPACITY, Fitter, rgb
from scuro.measure.metrics import delta_e, psnr, ssim
from scuro.measure.results.page import grid
from scuro.measure.results.volumes import (
    HALF,
    IMAGE,
    OBJECT,
    PLAIN,
    SEVEN,
    SHADOW,
    SLICES,
    camera_of,
    showings,
)
from scuro.measure.variant import Variant
from scuro.render import Renderer
from scuro.render_settings import Settings

TITLE = "Volumes: errors against Monte Carlo"

TRUTH = {"volume__light": "monte-carlo", "volume__samples": 64}
EXACT = {"volume__constant_exact": True, "volume__occlusion__gap": 2.0}
ROWS = {"volume__occlusion__correlation": 1.0}
OCCLUSION: dict[str, dict[str, Any]] = {
    "ours, image space, 7 cones": IMAGE | SEVEN,
    "ours, image space, 3 cones": IMAGE,
    "ours, object space, full": OBJECT | SEVEN,
    "ours, object space, half": HALF | SEVEN,
    "ours, object space, third": HALF | SEVEN | {"volume__light_resolution": 0.34},
    "+ constant-exact, gap 2": IMAGE | SEVEN | EXACT,
    "+ constant-exact, gap 2, correlation 1": IMAGE | SEVEN | EXACT | ROWS,
    "slices": SLICES,
    "local sphere": HALF | {"volume__light": "local-sphere"},
}
SHADOWS: dict[str, dict[str, Any]] = {
    "ours, image space": SHADOW | {"volume__light": "image"},
    "ours, object space, half": SHADOW,
    "voxel cones": SHADOW | {"volume__light": "voxel-cones"},
    "summed areas": SHADOW | {"volume__light": "summed-area"},
}
THESIS: dict[str, tuple[float | str | None, ...]] = {
    "Backpack, 15°": (218, 20, 50), "Bonsai, 20°": (438, 113, 75), "Bonsai, 10°": (456, 123, 54),
    "CT-Knee, 10°": (730, 42, 100), "CT-Knee, 15°": (629, 264, 135), "Foot, 20°": (530, 114, 294),
    "Foot, 25°": (478, 44, 83), "Hazelnut, 10°": (229, 60, 39), "Hazelnut, 15°": (211, 41, 48),
    "Flower, 15°": (48, 20, 16), "Flower, 25°": (48, 36, 19),
}  # fmt: skip
"""Frames a second: EA, occlusion in image space, then in object space."""


def section(options: BenchOptions) -> Iterator[str]:
    """The section's paragraphs, measured as they are asked for."""
    renderer = Renderer(options.device)
    width, height = options.size
    yield (
        f"Pictures of {width} × {height} pixels on {renderer.gpu.info}, half-angles 20° and 0.5°, "
        "against 64 rays a cone. ΔE2000 (mean, over the volume's pixels) as the factor α = 1 gives "
        "it, and with the α that fits best, found by search; slices' angle is fitted as well. (T) "
        "are semi-transparent showings. Milliseconds were taken while other work ran: only their "
        "ratios tell anything."
    )
    for kind, variants in (("occlusion", OCCLUSION), ("shadows", SHADOWS)):
        yield f"### Directional {kind} against Monte Carlo (Table C.1)"
        for name, scene in showings(options):
            options.say(f"{kind}, {name}")
            yield f"#### {name}"
            yield _table(options, renderer, scene, kind, variants)
        if kind == "occlusion":
            heads = ["EA", "AO, image", "AO, object"]
            yield grid(["Campagnolo 2021, fps, 768 × 768", *heads], THESIS)


def _table(
    options: BenchOptions, renderer: Renderer, scene: Any, kind: str, variants: dict[str, dict]
) -> str:
    part = {"occlusion": "occlusion", "shadows": "shadow"}[kind]
    factor = f"volume__{part}__attenuation"
    base = Settings(size=options.size)
    camera = camera_of(scene, options.size)
    truth = Variant("Monte Carlo", PLAIN | {f"volume__{part}__on": True} | TRUTH)
    start = time.perf_counter()
    image = renderer.render(scene, camera, base.replace(**truth.changes))
    milliseconds = 1e3 * (time.perf_counter() - start)
    wanted, mask = rgb(image.pixels), image.buffer("volume_opacity") > LEAST_OPACITY
    fitter = Fitter(renderer, scene, camera, base, truth)
    rows: dict[str, tuple[float | str | None, ...]] = {truth.name: (milliseconds, 1.0, *[None] * 5)}
    for name, changes in variants.items():
        plain = Variant(name, changes | {factor: 1.0})
        drawn = draw(renderer, scene, camera, base, plain, 1)
        best = fitter.fitted(plain)
        pixels = rgb(renderer.render(scene, camera, base.replace(**best.changes)).pixels)
        rows[name] = (
            drawn.milliseconds,
            milliseconds / drawn.milliseconds,
            delta_e(rgb(drawn.pixels), wanted, mask),
            delta_e(pixels, wanted, mask),
            best.changes[factor],
            ssim(pixels, wanted, mask),
            psnr(pixels, wanted, mask),
        )
    heads = ["ms", "times faster", "ΔE2000, α = 1", "ΔE2000 fitted", "α", "SSIM", "PSNR [dB]"]
    return grid(["method", *heads], rows)
