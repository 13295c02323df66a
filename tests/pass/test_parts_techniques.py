"""A picture in parts is the one drawn at once, for techniques that look beyond a part."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import draw, scene_of, spheres

from scuro import Camera, render_parts
from scuro.passes import part

WAYS = {
    "ray and mapped shadows": {"occlusion__technique": "ray", "shadows__technique": "mapped"},
    "hybrid and area shadows": {"occlusion__technique": "hybrid", "shadows__technique": "area"},
    "baked and soft shadows": {"occlusion__technique": "baked", "shadows__technique": "soft"},
    "analytic": {"occlusion__technique": "analytic", "shadows__technique": "hard"},
    "few rays, smoothed": {
        "occlusion__technique": "ray", "occlusion__samples": 2, "occlusion__resolution": "half",
    },
    "lines, halos, toon, fog": {
        "borders__width": 3.0, "halos__width": 14.0, "toon__steps": 3, "fog__strength": 0.6,
        "dpi": 144,
    },
    "lines, smoothed": {
        "borders__width": 3.0, "toon__steps": 3, "fog__strength": 0.6,
        "antialias__method": "fxaa", "dpi": 144,
    },
    # FXAA decides by thresholds: it shows where halos differ in their last bits
    "halos, smoothed": {"halos__width": 21.0, "antialias__method": "fxaa"},
    "narrow halos, smoothed": {"halos__width": 5.0, "antialias__method": "fxaa"},
    "wide halos and fog, smoothed": {
        "halos__width": 18.0, "fog__strength": 0.5, "antialias__method": "fxaa", "dpi": 144,
    },
    "lines and halos, smoothed": {
        "borders__width": 1.6, "halos__width": 14.0, "antialias__method": "fxaa",
    },
    "halos before nothing, smoothed": {
        "halos__width": 30.0, "background": "transparent", "antialias__method": "fxaa",
    },
    "light halos before nothing, smoothed": {
        "halos__width": 30.0, "halos__color": "white", "background": "transparent",
        "antialias__method": "fxaa",
    },
    "depth of field": {"depth_of_field__blur": 5.0, "borders__width": 1.5},
}  # fmt: skip


SCREEN = {
    **{name: {"occlusion__technique": name} for name in ("ssao", "hbao", "gtao")},
    "ssao at half resolution": {"occlusion__technique": "ssao", "occlusion__resolution": "half"},
    **{f"semantic {mode}": {"semantic__mode": mode} for mode in ("screen", "plain")},
}
"""Techniques whose reach is many atoms of a close-up."""


@pytest.mark.parametrize("name", SCREEN)
@pytest.mark.parametrize("height", [None, 4.0], ids=["perspective", "orthographic"])
def test_parts_of_a_close_up_are_the_whole(name, height, monkeypatch):
    camera = Camera((0, 0, 8), (0, 0, 0), height=height)
    # so wide that no part with its margins, which are as wide as the reach, is the whole
    difference = _difference(camera, SCREEN[name], monkeypatch, size=(901, 181), spread=12)
    assert difference <= 1


@pytest.mark.parametrize("name", WAYS)
def test_parts_are_the_whole(name, monkeypatch):
    assert _difference(Camera((0, 0, 30), (0, 0, 0)), WAYS[name], monkeypatch) <= 1


def _difference(camera, changes, monkeypatch, size=(557, 211), spread=6):
    """The largest one between the picture drawn at once and in parts, of 255."""
    rng = np.random.default_rng(4)
    count = 22 * spread
    rows = np.c_[rng.normal(size=(count, 3)) * [spread, 3, 3], rng.uniform(0.6, 1.2, count)]
    scene = scene_of(spheres(*map(tuple, rows), color=(200, 120, 90, 255)))
    # neither side is a multiple of what parts are aligned to
    changes = {"size": size, "lighting__preset": "full", **changes}
    whole = draw(scene, camera, **changes).pixels.astype(int)
    parts = []

    def split(*given, **options):
        parts.extend(part.split(*given, **{**options, "edge": 240}))
        return parts

    monkeypatch.setattr(part, "fits", lambda *rest: False)
    monkeypatch.setattr(render_parts, "split", split)
    joined = draw(scene, camera, **changes).pixels.astype(int)
    assert len(parts) > 1 and all(p.size[0] < size[0] for p in parts)
    return np.abs(whole - joined).max()
