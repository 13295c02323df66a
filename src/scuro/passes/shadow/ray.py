"""``hard`` and ``area``: one ray, or several, from each pixel to a light (Easdon 2013, 5.2)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from scuro.passes.filter.temporal import settle
from scuro.passes.frame import Frame

PATTERN = 4
"""Edge of the square of interleaved pixel classes; the filter averages over it."""

DEFAULT_SAMPLES = 4
UNFILTERED = 64
"""So many samples need no smoothing."""


def draw_hard(frame: Frame, light: int) -> None:
    """One ray a pixel to the light's middle."""
    _trace(frame, light, samples=1, spread=0.0, interleaved=False)


def draw_area(frame: Frame, light: int) -> None:
    """Several rays a pixel to points of the light's disc: the truth that ``soft`` is held to."""
    settings = frame.settings.shadows
    samples = settings.samples or DEFAULT_SAMPLES
    filtered = settings.filter and samples < UNFILTERED
    _trace(frame, light, samples, default_spread(frame), interleaved=filtered)
    settle(
        frame, "shadow_light", _key(frame, light), samples,
        kind="auto" if filtered else "none", enough=UNFILTERED, radius=PATTERN,
        signal=f"shadow {light}",
    )  # fmt: skip


def _key(frame: Frame, light: int) -> Any:
    """Everything but the camera that a light's shadow depends on."""
    planes = np.asarray(frame.resources["scene"]["planes"]).tobytes()
    values = frame.resources["lights"]["list"][light].items()
    lamp = tuple((name, tuple(np.atleast_1d(value).tolist())) for name, value in values)
    return (frame.accelerator, planes, frame.settings.shadows, frame.settings.seed, lamp)


def default_spread(frame: Frame) -> float:
    """Tangent of the angular radius of lights without a size of their own."""
    return math.tan(math.radians(frame.settings.shadows.light_size))


def _trace(frame: Frame, light: int, samples: int, spread: float, *, interleaved: bool) -> None:
    frame.compute_tiles(
        "passes/shadow/ray.wgsl",
        {
            "rays": {
                "light": light,
                "samples": samples,
                "spread": spread,
                "pattern": PATTERN if interleaved else 0,
            },
            "result": frame.resources["shadow_light"],
        },
        constants={"AREA": spread > 0},
        label="shadow",
    )
