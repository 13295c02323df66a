"""Depth of field: what lies off the focal plane is blurred, as by a lens."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from scuro.passes.frame import Frame
from scuro.passes.geometry.tiles import TILE
from scuro.passes.post.depth import depth_range, fill_depths
from scuro.scene.points import focus_points
from scuro.scene.scene import Scene
from scuro.settings import SettingsGroup, setting


class FocusSettings(SettingsGroup):
    """Depth of field."""

    blur: float = setting(
        0.0,
        "radius of the blur at the scene's back when its front is in focus; 0 keeps all sharp",
        low=0,
        high=64,
        unit="px",
        main=True,
    )
    on: str = setting("", "selection in focus, in PyMOL's words (default: the camera's target)")
    distance: float | None = setting(
        None, "distance in focus, from the eye along the line of sight", low=0
    )
    taps: int = setting(64, "most pixels gathered for each", low=1, high=256)


def focus_reach(settings: FocusSettings, px: float) -> float:
    """Distance in pixels from which one is influenced; ``px`` of them are 1 px."""
    return settings.blur * px * _MOST + 2 * TILE + 1 if settings.blur else 0.0


_MOST = 2.0
"""A blur is cut at so many times its size at the scene's back."""

_CALM = 8.0
"""Largest circle in pixels beyond which the taps are too few: as in focus_calm.wgsl."""


def draw_focus(frame: Frame, scene: Scene) -> None:
    """Blur ``color`` by each pixel's distance from the focal plane."""
    settings = frame.settings.depth_of_field
    if not settings.blur:
        return
    fill_depths(frame)
    front, back = depth_range(frame)
    focus = _focal_depth(frame, scene)
    # the circle of confusion of a thin lens goes with |z - focus| / z; a parallel projection, which
    # has no lens, takes it as from far away
    perspective = not frame.camera.orthographic
    unit = (back - front) / (back if perspective else 1.0)
    most = settings.blur * frame.px * _MOST
    uniform = {
        "depth": focus,
        "aperture": settings.blur * frame.px / max(unit, 1e-6),
        "most": most,
        "perspective": int(perspective),
        "taps": settings.taps,
        "reach": math.ceil(most / TILE),
    }
    resources = {"focus": uniform, "around": _largest_around(frame, uniform)}
    frame.replace_color("passes/post/focus.wgsl", resources)
    if most > _CALM:
        frame.replace_color("passes/post/focus_calm.wgsl", resources)


def _largest_around(frame: Frame, uniform: dict[str, Any]) -> Any:
    """The largest circle of confusion that may reach into each tile."""
    source = frame.resources["depths"]
    small = tuple(-(-s // TILE) for s in frame.size)
    for entry in ("largest", "across", "down"):
        result = frame.target(f"focus_{entry}", "r32float", size=small)
        resources = {"focus": uniform, "source": source, "result": result}
        frame.compute(
            "passes/post/focus_reach.wgsl", resources, entry=entry, threads=small, label="focus"
        )
        source = result
    return source


def _focal_depth(frame: Frame, scene: Scene) -> float:
    settings = frame.settings.depth_of_field
    if settings.distance is not None:
        return settings.distance
    point = np.asarray(frame.camera.target, np.float64)
    if settings.on:
        point = focus_points(scene, settings.on, "--depth-of-field-on")[:, :3].mean(axis=0)
    row = frame.camera.view_from_world()[2]
    return float(-(row[:3] @ point + row[3]))
