"""Screen-space occlusion: what must hold although it only knows the picture."""

import numpy as np
import pytest
from scenes import draw, scene_of, spheres

from scuro.scene.camera import Camera

KINDS = ("ssao", "hbao", "gtao")
PAIR = [(-0.9, 0, 0, 1), (0.9, 0, 0, 1)]


def visibility(scene, technique, camera, **changes):
    values = {f"occlusion__{key}": value for key, value in changes.items()}
    image = draw(scene, camera, occlusion__technique=technique, **values)
    return image.buffer("visibility"), image.buffer("object") >= 0


@pytest.mark.parametrize("technique", KINDS)
@pytest.mark.parametrize("height", [None, 6.0])
def test_a_lone_sphere_is_open_and_the_background_untouched(technique, height):
    camera = Camera((0, 0, 12), (0, 0, 0), height=height)
    open_, seen = visibility(scene_of(spheres((0, 0, 0, 2))), technique, camera)
    assert open_[seen].mean() > 0.97
    assert (open_[~seen] == 1).all()


@pytest.mark.parametrize("technique", KINDS)
def test_a_crease_is_darker_than_the_open_side(technique):
    open_, seen = visibility(scene_of(spheres(*PAIR)), technique, Camera((0, 0, 12), (0, 0, 0)))
    columns = np.nonzero(seen.any(axis=0))[0]
    middle = open_[:, columns[len(columns) // 2]][seen[:, columns[len(columns) // 2]]]
    rim = open_[:, columns[3:9]][seen[:, columns[3:9]]]
    assert middle.min() < rim.mean() - 0.1


@pytest.mark.parametrize("technique", KINDS)
def test_nothing_changes_with_the_size_of_the_scene(technique):
    small, seen = visibility(scene_of(spheres(*PAIR)), technique, Camera((0, 0, 12), (0, 0, 0)))
    rows = (10 * np.array(PAIR)).tolist()
    large, _ = visibility(scene_of(spheres(*rows)), technique, Camera((0, 0, 120), (0, 0, 0)))
    assert np.abs(small - large)[seen].mean() < 2e-3


def test_half_resolution_is_close_to_full():
    scene, camera = scene_of(spheres(*PAIR)), Camera((0, 0, 12), (0, 0, 0))
    full, seen = visibility(scene, "gtao", camera)
    half, _ = visibility(scene, "gtao", camera, resolution="half")
    assert np.abs(full - half)[seen].mean() < 0.04
