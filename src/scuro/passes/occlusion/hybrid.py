"""``hybrid``: the closed form's detail times a traced, smoothed factor (Easdon 2013, section 4.5).

Easdon multiplies an analytic near field by a ray-traced far field and darkens near occluders twice.
Here the rays see everything; what is smoothed is the *ratio* between traced visibility and the
closed form over a neighbourhood,

    visibility = closed_form · mean(traced) / mean(closed_form),

so that whatever both count is divided out, and the mean over a neighbourhood is that of the rays.
The closed form keeps creases sharp that smoothing would blur.
"""

from __future__ import annotations

from collections.abc import Iterator

from scuro.passes.filter.temporal import settle
from scuro.passes.frame import Frame
from scuro.passes.occlusion.analytic import block_analytically
from scuro.passes.occlusion.neighbours import neighbours_in_steps
from scuro.passes.occlusion.ray import UNFILTERED, occlusion_key, trace_visibility
from scuro.settings import SettingsGroup, setting

DEFAULT_SAMPLES = 2


class HybridSettings(SettingsGroup):
    """Hybrid occlusion."""

    neighbours: int = setting(24, "nearest spheres in closed form, in fours", low=4, high=128)
    reach: int = setting(
        6, "radius of the smoothing of the traced factor", low=1, high=32, unit="px"
    )


def prepare(frame: Frame) -> Iterator[float]:
    """Find neighbours in slices; yields the share that is done."""
    yield from neighbours_in_steps(frame, frame.settings.occlusion.hybrid.neighbours)


def draw(frame: Frame) -> None:
    """Fill ``visibility``."""
    settings = frame.settings.occlusion
    samples = settings.samples or DEFAULT_SAMPLES
    block_analytically(frame, "near_field", settings.hybrid.neighbours)
    trace_visibility(frame, "visibility", samples, settings.distance, interleaved=True)
    settle(
        frame, "visibility", occlusion_key(frame), samples, kind=settings.filter,
        enough=UNFILTERED, radius=settings.hybrid.reach, guide=frame.resources["near_field"],
    )  # fmt: skip
