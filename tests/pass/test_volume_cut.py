"""Faces that planes and boxes cut into a volume are lit as faces, however light is made."""

from __future__ import annotations

import numpy as np
import pytest
from test_volume import PLAIN, draw, ramp, solid

from scuro.passes.volume.settings import VolumeSettings
from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, ClippingSettings, Plane
from scuro.scene.lights import Light, Lighting


@pytest.fixture(scope="module")
def gpu():
    return Renderer().gpu


@pytest.mark.parametrize("light", ["object", "image"])
@pytest.mark.parametrize("iso", [None, 0.5])
def test_an_oblique_cut_is_lit_evenly(gpu, light, iso):
    """An open flat face toward viewer and light: one brightness, and that of the light alone."""
    volume = solid((40, 40, 40))
    direction = np.array([0.5, 0.3, 0.8]) / np.linalg.norm([0.5, 0.3, 0.8])
    clip = Clip((Plane((20, 20, 18), tuple((-direction).tolist())),))
    eye = np.array([19.5, 19.5, 19.5]) + 200 * direction
    camera = Camera(tuple(eye.tolist()), (19.5, 19.5, 19.5), height=24.0)
    lighting = Lighting((Light(direction=(0, 0, -1), intensity=0.5),), ambient=0.25)
    settings = VolumeSettings(shading="phong", jitter=0.0, specular=0.0, light=light, iso=iso)
    image, _, _ = draw(
        gpu, volume, settings.replace(shadow__on=True), ramp(0.999), camera=camera, size=(64, 64),
        clip=clip, lighting=lighting,
    )  # fmt: skip
    face = image[8:56, 8:56, 0]
    assert face.std() < 0.004 * face.mean()
    assert face.mean() == pytest.approx(0.75, abs=0.03)


def test_a_box_cuts_on_all_sides(gpu):
    volume = solid((40, 40, 40))
    box = ClippingSettings(cube=(10.0, 16.0, 12.0), cube_turn=(0.0, 0.0, 90.0))
    clip = Clip(box.box(np.array([19.5, 19.5, 19.5])))
    camera = Camera((19.5, 19.5, 300.0), (19.5, 19.5, 19.5), height=40.0)
    image, _, _ = draw(gpu, volume, PLAIN, ramp(0.1), camera=camera, size=(80, 80), clip=clip)
    seen = image[..., 3] > 0.01
    assert np.ptp(np.nonzero(seen.any(axis=0))[0]) + 1 == pytest.approx(32, abs=1)
    assert np.ptp(np.nonzero(seen.any(axis=1))[0]) + 1 == pytest.approx(20, abs=1)
    assert image[40, 40, 3] == pytest.approx(1 - 0.9**12, abs=2e-3)
