"""``hybrid``: the closed form's detail times a traced, smoothed factor (Easdon 2013, section 4.5).

Easdon multiplies an analytic near field by a ray-traced far field and darkens near occluders twice.
Here the rays, one for each 2 × 2 block of pixels, see everything; what is smoothed is the *ratio*
between traced visibility and the closed form over a neighbourhood,

    visibility = closed_form · mean(traced) / mean(closed_form),

so that whatever both count is divided out, and the mean over a neighbourhood is that of the rays.
The closed form keeps creases sharp that smoothing would blur; the ratio is smooth and can be
filtered widely.
"""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.passes.occlusion.analytic import block_analytically
from scuro.passes.occlusion.ray import trace_visibility
from scuro.settings import SettingsGroup, setting

DEFAULT_SAMPLES = 2
_SHADER = "passes/occlusion/hybrid.wgsl"


class HybridSettings(SettingsGroup):
    """Hybrid occlusion."""

    neighbours: int = setting(32, "nearest spheres in closed form, in fours", low=4, high=128)
    reach: int = setting(
        6, "radius of the smoothing of the traced factor, at half resolution", low=1, high=16,
        unit="px",
    )  # fmt: skip
    tolerance: float = setting(
        2.0, "depth over which the traced factor is smoothed, in typical radii", low=0.01, high=10
    )


def draw(frame: Frame) -> None:
    """Fill ``visibility``."""
    settings = frame.settings.occlusion
    hybrid = settings.hybrid
    block_analytically(frame, "near_field", hybrid.neighbours)
    trace_visibility(
        frame,
        "far_field",
        settings.samples or DEFAULT_SAMPLES,
        settings.distance,
        half=True,
        interleaved=True,
    )
    width, height = frame.size
    half = ((width + 1) // 2, (height + 1) // 2)
    uniform = {
        "reach": hybrid.reach,
        "offset": int(frame.resources["view"]["frame"]) % 4,
        "tolerance": hybrid.tolerance,
        "strength": settings.strength,
    }
    a = frame.target("hybrid_a", "rg32float", size=half)
    b = frame.target("hybrid_b", "rg32float", size=half)
    unused = frame.target("hybrid_unused", "r32float", size=(1, 1))
    spare = frame.target("hybrid_spare", "rg32float", size=(1, 1))
    for entry, source, target, result in (
        ("across", b, a, unused),
        ("down", a, b, unused),
        ("combine", b, spare, frame.target("visibility", "r32float", clear=(1, 1, 1, 1))),
    ):
        frame.compute_tiles(
            _SHADER,
            {"hybrid": uniform, "pairs": source, "smoothed": target, "result": result},
            entry=entry,
            label="filter",
        )
