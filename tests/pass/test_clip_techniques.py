"""What is clipped away neither occludes nor casts shadows, in any technique, at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import draw, scene_of, spheres

from scuro import Camera, Clip, Plane
from scuro.passes.occlusion import occlusion
from scuro.passes.semantic.settings import SemanticSettings
from scuro.passes.shadow import shadow
from scuro.settings import parameters

CAMERA = Camera((6, 4, 40), (0, 0, 0), height=13.0)
SEMANTIC = next(p for p in parameters(SemanticSettings) if p.name == "mode").choices
WAYS = {
    **{f"occlusion {name}": {"occlusion__technique": name} for name in occlusion.TECHNIQUES},
    **{f"shadows {name}": {"shadows__technique": name} for name in shadow.TECHNIQUES},
    **{f"semantic {name}": {"semantic__mode": name} for name in SEMANTIC if name != "off"},
    "path": {"renderer": "path", "path__samples": 8},
    "halos": {"halos__width": 9.0},
    "borders": {"borders__width": 3.0},
}
PLANE = Plane((0, 0, 3.4), (0.05, 0, -1))
"""Between the floor and the roof, through the empty space there."""


def scene(roof: bool):
    """A bumpy floor, with or without a roof that hangs over a part of it and outside of the view.

    A few atoms far away, which nothing clips, hold the bounds.
    """
    rng = np.random.default_rng(3)
    place = np.mgrid[-5:6, -4:5].reshape(2, -1).T.astype(float)
    floor = np.c_[place, rng.uniform(-0.6, 0.6, len(place)), rng.uniform(0.8, 1.3, len(place))]
    above = np.mgrid[-4:2, -3:4].reshape(2, -1).T.astype(float)
    above = np.c_[above, np.full(len(above), 5.0), np.full(len(above), 1.1)]
    far = [(x, y, z, 0.1) for x in (-20, 20) for y in (-20, 20) for z in (-9, 9)]
    rows = [*map(tuple, floor), *(map(tuple, above) if roof else ())]
    return scene_of(spheres(*rows, color=(210, 160, 120, 255)),
                    replace(spheres(*far), clipped=False))  # fmt: skip


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("name", WAYS)
def test_what_is_clipped_away_leaves_no_trace(name, whole):
    changes = {"lighting__preset": "full", "occlusion__technique": "none",
               "shadows__technique": "none", **WAYS[name]}  # fmt: skip
    cut = scene(roof=True)
    with_roof = draw(cut, CAMERA, **changes).pixels.astype(int)
    cut.clip = Clip((PLANE,), whole)
    # the same scene was first drawn with its roof: nothing of it may be left over
    found = draw(cut, CAMERA, **changes).pixels.astype(int)
    expected = draw(scene(roof=False), CAMERA, **changes).pixels.astype(int)
    off = np.abs(found - expected).max(axis=-1)
    assert off.mean() < 0.25 and (off > 12).mean() < 0.002, (off.mean(), off.max())
    assert np.abs(with_roof - expected).mean() > 2


def test_the_closed_form_forgets_what_is_cut():
    """A ball over another, wholly cut away: it is a near neighbour still, and blocks nothing."""
    made = scene_of(spheres((0, 0, 0, 1), (0, 0, 2.2, 1)))
    camera = Camera((40, 0, 0), (0, 0, 0), height=2.4)

    def darkest() -> float:
        return float(draw(made, camera, occlusion__technique="analytic").buffer("visibility").min())

    assert darkest() < 0.9
    made.clip = Clip((Plane((0, 0, 1.15), (0, 0, -1)),))
    assert darkest() == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("name", [n for n in occlusion.TECHNIQUES if n != "none"])
@pytest.mark.parametrize("planes", [1, 2])
def test_caps_are_open_in_every_technique(name, planes):
    """The kept region is convex, so nothing that is cut lies before a cap."""
    rng = np.random.default_rng(5)
    rows = np.c_[rng.normal(size=(160, 3)) * 2, rng.uniform(0.8, 1.5, 160)]
    made = scene_of(spheres(*map(tuple, rows), color=(210, 160, 120, 255)))
    cuts = (Plane((0, 0, 0), (0.1, 0.2, -1)), Plane((0, 0, 0), (-1, 0, -0.4)))[:planes]
    made.clip = Clip(cuts)
    image = draw(made, Camera((6, 4, 40), (0, 0, 0), height=8.0), occlusion__technique=name)
    normal, visibility = image.buffer("normal"), image.buffer("visibility")
    for cut in cuts:
        cap = normal @ -cut.equation()[:3] > 0.99999
        assert cap.sum() > 400
        # filters reach over a cap's edge, screen-space techniques see what is before it
        assert np.mean(visibility[cap]) > 0.99 and np.mean(visibility[cap] < 0.95) < 0.03
