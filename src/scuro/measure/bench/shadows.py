"""Shadows: frame time of each technique by number of atoms, and its error against area lights.

One key light from the upper left on space-filling molecules, whole molecule in view; inputs as for
``visibility``. ``shadow_s`` is what the technique adds to the frame without shadows, ``times_hard``
its ratio to hard shadows (Easdon 2013, Table 5.2: soft takes 1.20 to 1.27 times hard), ``rmse`` the
error of the shadow itself against 64 unfiltered rays to the light's disc.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from scuro.measure.bench import BenchOptions, median_seconds
from scuro.measure.bench.visibility import scenes
from scuro.measure.metrics import rmse
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.lights import Light, Lighting
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera

_TECHNIQUES = ("none", "hard", "soft", "area", "mapped")
_KEY = Lighting((Light(direction=(1, -1, -1)),), ambient=0.4)
_TRUTH = {"shadows__technique": "area", "shadows__samples": 64, "shadows__filter": False}


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure every technique on every scene; see the module."""
    renderer = Renderer(options.device)
    rows = []
    for name, scene in scenes(options):
        scene.lighting = _KEY
        rows += _measure(renderer, name, scene, options)
    return {
        "adapter": str(renderer.gpu.info),
        "size": list(options.size),
        "frames": options.frames,
        "rows": rows,
    }


def _measure(
    renderer: Renderer, name: str, scene: Scene, options: BenchOptions
) -> list[dict[str, Any]]:
    plain = options.plain()
    camera = view_camera(scene, ViewSettings(), options.size[0] / options.size[1])
    options.say(f"{name}, truth")
    image = renderer.render(scene, camera, plain.replace(**_TRUTH))
    truth, seen = image.buffer("shadow"), image.buffer("object") >= 0
    spheres = renderer.accelerator(scene).spheres
    rows: list[dict[str, Any]] = []
    seconds: dict[str, float] = {}
    for technique in _TECHNIQUES:
        options.say(f"{name}, {technique}")
        settings = plain.replace(shadows__technique=technique)

        def frame(settings: Settings = settings) -> None:
            renderer.frame(scene, camera, settings).recorder.submit()
            renderer.gpu.finish()

        seconds[technique] = median_seconds(frame, options.frames)
        added = seconds[technique] - seconds["none"]
        lit = np.ones_like(truth)
        if technique != "none":
            lit = renderer.render(scene, camera, settings).buffer("shadow")
        hard = seconds.get("hard", np.nan) - seconds["none"]
        rows.append(
            {
                "scene": name,
                "spheres": spheres,
                "shadows": technique,
                "frame_s": round(seconds[technique], 4),
                "shadow_s": round(added, 4),
                "times_hard": round(added / hard, 3) if hard > 0 else None,
                "rmse": round(rmse(lit, truth, seen), 4),
            }
        )
    return rows
