"""Smoothing of noisy values."""

from __future__ import annotations

import numpy as np

from scuro.load import load
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, view_camera


def test_many_rays_are_not_smoothed_across_creases():
    """What is known well is averaged with its like: creases of 64 rays stay dark."""
    renderer, scene = Renderer(), Scene().add(load("sample:1hpv"))
    camera = view_camera(scene, ViewSettings(), 4 / 3)
    settings = Settings(size=(160, 120)).replace(
        lighting__preset="studio", antialias__method="none", occlusion__technique="ray"
    )

    def visibility(samples: int, kind: str) -> np.ndarray:
        now = settings.replace(occlusion__samples=samples, occlusion__filter=kind)
        image = renderer.render(scene, camera, now)
        return image.buffer("visibility")[image.buffer("object") >= 0]

    truth = visibility(1024, "none")
    off = visibility(64, "bilateral") - truth
    assert np.sqrt((off**2).mean()) < 0.025  # 0.020; 0.030 by planes and normals alone
    assert off[truth < 0.25].mean() < 0.008  # 0.003 and 0.017
    raw = visibility(64, "none") - truth
    assert np.sqrt((off**2).mean()) < 1.05 * np.sqrt((raw**2).mean())
