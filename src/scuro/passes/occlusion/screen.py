"""``ssao``, ``hbao`` and ``gtao``: occlusion from the depth buffer (Easdon 2013, section 4.3).

Cost does not depend on the scene. Nothing is known behind what the picture shows, nor beyond its
edge unless a guard band is asked for, for which a wider G-buffer is drawn: both count as open.
Nothing is looked for beyond a share of the picture's height, which is also the margin of the parts
of a large picture (:func:`scuro.passes.part.screen_reach`).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from scuro.passes.filter.temporal import settle
from scuro.passes.frame import Frame
from scuro.passes.geometry.visibility import draw_visibility
from scuro.passes.occlusion.ray import PATTERN, direction_table, occlusion_key
from scuro.passes.targets import TargetPool
from scuro.settings import SettingsGroup, setting

_ALIGN = 16
"""Guard bands are so many samples wide, or twice …: patterns and tiles then stay in place."""
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
    guard: int = setting(
        0, "how far beyond the picture's edges occluders are looked for", low=0, high=1024,
        unit="px",
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
    samples = settings.samples or default_samples
    guard = -(-settings.screen.guard * frame.scale // _ALIGN) * _ALIGN
    # transparent layers have a G-buffer of their own, which nothing can widen
    if guard and not frame.constants["HAS_OPACITY"]:
        wide = _widened(frame, guard)
        _look(wide, kind, samples)
        source = wide.resources["visibility"]
        block = wide.size[0] // source.size[0]
        size = tuple(-(-s // block) for s in frame.size)
        cropped = frame.target("visibility", "r32float", size=size, clear=(1, 1, 1, 1))
        origin = (guard // block, guard // block)
        frame.recorder.copy_region(source, cropped, origin, (0, 0), size)
    else:
        _look(frame, kind, samples)
    settle(
        frame, "visibility", occlusion_key(frame), samples, kind=settings.filter,
        enough=_UNFILTERED, radius=PATTERN,
    )  # fmt: skip


def _widened(frame: Frame, guard: int) -> Frame:
    """The frame with a G-buffer that reaches ``guard`` samples beyond its edges."""
    view = dict(frame.resources["view"])
    view["origin"] = tuple(np.asarray(view["origin"]) - guard)
    wide = replace(
        frame,
        targets=frame.targets.table("wide", guard, lambda: TargetPool(frame.gpu)),
        size=(frame.size[0] + 2 * guard, frame.size[1] + 2 * guard),
        resources=frame.resources | {"view": view},
        history=None,
    )
    frame.targets.frame = frame
    draw_visibility(wide)
    return wide


def _look(frame: Frame, kind: str, samples: int) -> None:
    """Fill ``visibility``, not yet smoothed."""
    settings = frame.settings.occlusion
    screen = settings.screen
    half = settings.resolution == "half"
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
                "limit": frame.screen_reach,
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
