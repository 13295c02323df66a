"""Shadows: a technique by name fills ``shadow``, a layer a light, 1 = lit (Easdon 2013, ch. 5)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

from scuro.passes.frame import Frame
from scuro.settings import SettingsGroup, setting

TECHNIQUES = {
    "hard": "scuro.passes.shadow.ray:draw_hard",
    "soft": "scuro.passes.shadow.soft:draw",
    "area": "scuro.passes.shadow.ray:draw_area",
    "mapped": "scuro.passes.shadow.mapped:draw",
}
"""Technique by name -> function ``(frame, light index)`` that fills the target ``shadow_light``."""


class ShadowSettings(SettingsGroup):
    """Shadows of the lights that cast them (``shadow`` of each light)."""

    technique: str = setting(
        "auto",
        "shadow technique; auto follows the lighting",
        choices=("auto", "none", *TECHNIQUES),
        main=True,
    )
    light_size: float = setting(
        3.0,
        "angular radius of lights that have no size of their own (soft, area)",
        low=0,
        high=45,
        unit="deg",
    )
    penumbra: float = setting(0.6, "widest penumbra, in median atom radii (soft)", low=0, high=10)
    ratio: float | None = setting(
        None,
        "outer over inner radius, as Parker has it, instead of penumbras that widen (soft)",
        low=1.001,
        high=4,
    )
    samples: int | None = setting(None, "rays a pixel to each light (area)", low=1, high=4096)
    filter: bool = setting(True, "smooth few samples (area)")
    map_size: int = setting(1024, "texels along an edge (mapped)", low=16, high=8192, unit="px")
    bias: float = setting(1.0, "depth that counts as the same surface, in texels (mapped)", low=0)
    taps: int = setting(1, "texels around each that are compared (mapped)", low=0, high=16)


def prepare_shadows(frame: Frame) -> Iterator[float]:
    """Build in slices what the technique builds before its first picture; yields shares done."""
    if _casting(frame):
        place = TECHNIQUES[frame.settings.shadows.technique]
        prepare = getattr(import_module(place.split(":")[0]), "prepare", None)
        if prepare is not None:
            yield from prepare(frame)


def draw_shadows(frame: Frame) -> None:
    """Fill ``shadow`` by the technique of the settings, if any light casts one."""
    technique = frame.settings.shadows.technique
    lights = frame.resources["lights"]["list"]
    casting = _casting(frame)
    if not casting:
        return
    layers = frame.targets.get("shadow", (*frame.size, len(casting)), "r32float")
    for index in casting:
        frame.target("shadow_light", "r32float", clear=(1, 1, 1, 1))
        _function(TECHNIQUES[technique])(frame, index)
        frame.recorder.copy_texture(
            frame.resources["shadow_light"], layers, layer=lights[index]["shadow"]
        )
    frame.resources["shadow"] = layers


def _casting(frame: Frame) -> list[int]:
    """Numbers of the lights that cast shadows."""
    if frame.settings.shadows.technique == "none":
        return []
    lights = frame.resources["lights"]["list"]
    return [i for i, light in enumerate(lights) if light["shadow"] >= 0]


def _function(place: str) -> Callable[[Frame, int], Any]:
    module, name = place.split(":")
    found: Callable[[Frame, int], Any] = getattr(import_module(module), name)
    return found
