"""Lighting words: what they bring along, and that nothing is brighter than white."""

import numpy as np
import pytest
from scenes import draw, scene_of, spheres

from scuro.passes.compose.lighting import PRESETS, with_implied
from scuro.render_settings import Settings
from scuro.scene.camera import Camera

FRONT = Camera((0, 0, 8), (0, 0, 0))


@pytest.mark.parametrize("preset", PRESETS)
def test_white_atoms_are_bright_and_not_clipped(preset):
    image = draw(scene_of(spheres((0, 0, 0, 2))), FRONT, lighting__preset=preset)
    brightest = image.pixels[image.buffer("object") >= 0][:, :3].max()
    assert 235 <= brightest <= 250


def test_full_brings_occlusion_and_shadows_that_settings_can_refuse():
    full = Settings().replace(lighting__preset="full")
    assert with_implied(full).occlusion.technique == "hybrid"
    assert with_implied(full).shadows.technique != "none"
    refused = with_implied(full.replace(occlusion__technique="none", shadows__technique="none"))
    assert refused.occlusion.technique == refused.shadows.technique == "none"
    studio = with_implied(Settings().replace(lighting__preset="studio"))
    assert studio.occlusion.technique == studio.shadows.technique == "none"


def test_occlusion_leaves_the_directly_lit_part_alone():
    scene = scene_of(spheres((0, 0, 0, 2), (3, 0, 0, 2)))
    ambient_off = {"lighting__preset": "simple", "lighting__ambient": 0.0}
    plain = draw(scene, FRONT, **ambient_off).pixels.astype(int)
    occluded = draw(scene, FRONT, occlusion__technique="ray", **ambient_off).pixels
    assert np.abs(plain - occluded).max() == 0


def test_flat_light_draws_silhouettes_unless_told_otherwise():
    scene = scene_of(spheres((0, 0, 0, 1)))
    outside = draw(scene, FRONT, lighting__preset="flat").pixels[..., 0] < 128
    bare = draw(scene, FRONT, lighting__preset="flat", borders__width=0.0).pixels[..., 0] < 128
    assert outside.any() and not bare.any()
