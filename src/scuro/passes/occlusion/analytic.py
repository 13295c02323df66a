"""``analytic``: blocking factors of each atom's nearest spheres (Easdon 2013, section 4.4).

The lists of neighbours are found once a geometry. Spheres of other instances and rods, ribbons and
triangles do not occlude: ``hybrid`` adds them by rays.
"""

from __future__ import annotations

from collections.abc import Iterator

from scuro.passes.frame import Frame
from scuro.passes.occlusion.neighbours import neighbours_in_steps, neighbours_of
from scuro.settings import SettingsGroup, setting


class AnalyticSettings(SettingsGroup):
    """Analytic occlusion."""

    neighbours: int = setting(
        16, "nearest spheres that occlude each atom, in fours", low=4, high=128
    )
    form: str = setting(
        "clipped",
        "blocking factor of a sphere: exact with the horizon, or Easdon's equation 4.4 without",
        choices=("clipped", "easdon"),
    )


def draw(frame: Frame) -> None:
    """Fill ``visibility``."""
    block_analytically(frame, "visibility", frame.settings.occlusion.analytic.neighbours)


def prepare(frame: Frame) -> Iterator[float]:
    """Find neighbours in slices; yields the share that is done."""
    yield from neighbours_in_steps(frame, frame.settings.occlusion.analytic.neighbours)


def block_analytically(frame: Frame, name: str, neighbours: int) -> None:
    """Fill the texture ``name`` with the product over near spheres of what each leaves open.

    Args:
        frame: With ``surface`` and ``ids`` filled.
        name: Target.
        neighbours: Spheres an atom; rounded up to fours.
    """
    found = neighbours_of(frame, neighbours)
    resources = found.resources | {
        "analytic": {
            "texels": found.texels,
            "range": frame.settings.occlusion.distance or 3e38,
            "form": int(frame.settings.occlusion.analytic.form == "easdon"),
        },
        "result": frame.target(name, "r32float", clear=(1, 1, 1, 1)),
    }
    frame.compute_tiles("passes/occlusion/analytic.wgsl", resources, label="occlusion")
