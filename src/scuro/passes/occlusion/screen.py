"""``ssao``, ``hbao`` and ``gtao``: occlusion from the depth buffer (Easdon 2013, section 4.3).

Cost does not depend on the scene. Nothing is known beyond the picture's edge or behind what it
shows: both count as open. Pictures drawn in parts are drawn with a guard band.
"""

from __future__ import annotations

import math

from scuro.passes.filter.temporal import settle
from scuro.passes.frame import Frame
from scuro.passes.occlusion.ray import PATTERN, direction_table, occlusion_key
from scuro.settings import SettingsGroup, setting

_UNFILTERED = 512
"""So many samples, of several frames together, need no smoothing."""
_KINDS = ("ssao", "hbao", "gtao")

_RADII = {"ssao": 6.0, "hbao": 12.0, "gtao": 16.0}
"""Reach in typical radii: a compromise, small molecules want less and large assemblies more."""


class ScreenSettings(SettingsGroup):
    """Screen-space occlusion."""

    radius: float | None = setting(
        None, "reach, in typical radii; each technique's own otherwise", low=0.1, high=100
    )
    bias: float = setting(
        0.05, "least depth by which an occluder is nearer, in typical radii", low=0, high=10
    )
    angle_bias: float = setting(
        10.0, "angle over the tangent plane from which occluders count (hbao)", low=0, high=80,
        unit="deg",
    )  # fmt: skip
    lines: int = setting(4, "lines through a pixel (hbao, gtao)", low=1, high=32)


def draw_ssao(frame: Frame) -> None:
    """Fill ``visibility`` by points in the normal's hemisphere; 16 samples by default."""
    _draw(frame, "ssao", 16)


def draw_hbao(frame: Frame) -> None:
    """Fill ``visibility`` by horizons over the tangent plane; 32 samples by default."""
    _draw(frame, "hbao", 32)


def draw_gtao(frame: Frame) -> None:
    """Fill ``visibility`` by cosine-weighted horizons; 32 samples by default."""
    _draw(frame, "gtao", 32)


def _draw(frame: Frame, kind: str, default_samples: int) -> None:
    settings = frame.settings.occlusion
    screen = settings.screen
    half = settings.resolution == "half"
    samples = settings.samples or default_samples
    width, height = frame.size
    index = int(frame.resources["view"]["frame"])
    radius = (screen.radius or _RADII[kind]) * frame.accelerator.primitive_radius
    if settings.distance:
        radius = min(radius, settings.distance)
    frame.compute_tiles(
        "passes/occlusion/screen.wgsl",
        {
            "screen": {
                "samples": samples,
                "lines": screen.lines,
                "radius": radius,
                "bias": screen.bias * frame.accelerator.primitive_radius,
                "angle_bias": math.sin(math.radians(screen.angle_bias)),
                "offset": index % 4,
            },
            "directions": direction_table(frame, samples, index),
            "result": frame.target(
                "visibility",
                "r32float",
                size=((width + 1) // 2, (height + 1) // 2) if half else None,
                clear=(1, 1, 1, 1),
            ),
        },
        entry="half" if half else "main",
        constants={"KIND": _KINDS.index(kind)},
        label="occlusion",
    )
    settle(
        frame, "visibility", occlusion_key(frame), samples, kind=settings.filter,
        enough=_UNFILTERED, radius=PATTERN,
    )  # fmt: skip
