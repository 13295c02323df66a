"""Ambient occlusion: one technique by name fills ``visibility``, cosine-weighted, 1 = open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module

from scuro.passes.frame import Frame
from scuro.passes.occlusion.analytic import AnalyticSettings
from scuro.passes.occlusion.baked import BakedSettings
from scuro.passes.occlusion.hybrid import HybridSettings
from scuro.passes.occlusion.screen import ScreenSettings
from scuro.settings import SettingsGroup, setting

TECHNIQUES = {
    "ray": "scuro.passes.occlusion.ray:draw",
    "analytic": "scuro.passes.occlusion.analytic:draw",
    "hybrid": "scuro.passes.occlusion.hybrid:draw",
    "baked": "scuro.passes.occlusion.baked:draw",
    "ssao": "scuro.passes.occlusion.screen:draw_ssao",
    "hbao": "scuro.passes.occlusion.screen:draw_hbao",
    "gtao": "scuro.passes.occlusion.screen:draw_gtao",
}
"""Technique by name -> function of a frame that fills the ``visibility`` target."""


class OcclusionSettings(SettingsGroup):
    """Ambient occlusion: how much of the surroundings each point sees."""

    technique: str = setting(
        "auto",
        "ambient occlusion technique; auto follows the lighting",
        choices=("auto", "none", *TECHNIQUES),
        main=True,
    )
    samples: int | None = setting(
        None, "samples a pixel, where the technique samples; its own default otherwise", low=1,
        high=4096,
    )  # fmt: skip
    distance: float | None = setting(
        None, "only occluders nearer than this count; unlimited otherwise", low=0, unit="Å"
    )
    resolution: str = setting("full", "resolution of the samples", choices=("full", "half"))
    filter: str = setting(
        "auto", "smoothing of the result; auto filters few samples",
        choices=("auto", "none", "bilateral", "atrous"),
    )  # fmt: skip
    strength: float = setting(1.0, "exponent on visibility: above 1 darkens creases", low=0, high=8)
    analytic: AnalyticSettings = AnalyticSettings()
    hybrid: HybridSettings = HybridSettings()
    baked: BakedSettings = BakedSettings()
    screen: ScreenSettings = ScreenSettings()


def draw_occlusion(frame: Frame) -> None:
    """Fill ``visibility`` by the technique of the settings."""
    settings = frame.settings.occlusion
    if settings.technique == "none":
        return
    _function(TECHNIQUES[settings.technique])(frame)
    if settings.strength != 1:
        source = frame.resources["visibility"]
        frame.compute_tiles(
            "passes/occlusion/strength.wgsl",
            {
                "strength": {"exponent": settings.strength},
                "visibility": source,
                "result": frame.target("visibility_bent", "r32float", clear=(1, 1, 1, 1)),
            },
        )
        frame.resources["visibility"] = frame.resources["visibility_bent"]


def prepare_occlusion(frame: Frame) -> Iterator[float]:
    """Build in slices what the technique builds before its first picture; yields shares done."""
    place = TECHNIQUES.get(frame.settings.occlusion.technique, "")
    if place:
        prepare = getattr(import_module(place.split(":")[0]), "prepare", None)
        if prepare is not None:
            yield from prepare(frame)


def _function(place: str) -> Callable[[Frame], None]:
    module, name = place.split(":")
    found: Callable[[Frame], None] = getattr(import_module(module), name)
    return found
