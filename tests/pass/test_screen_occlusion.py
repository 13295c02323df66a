"""Screen-space occlusion: what must hold although it only knows the picture."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import draw, scene_of, spheres

from scuro.scene.camera import Camera

KINDS = ("ssao", "hbao", "gtao")
PAIR = [(-0.9, 0, 0, 1), (0.9, 0, 0, 1)]


def visibility(scene, technique, camera, size=(96, 72), **changes):
    values = {f"occlusion__{key}": value for key, value in changes.items()}
    image = draw(scene, camera, size, occlusion__technique=technique, **values)
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


@pytest.mark.parametrize("technique", KINDS)
@pytest.mark.parametrize("resolution", ["full", "half"])
def test_a_guard_band_sees_what_the_pictures_edge_cuts_off(technique, resolution):
    # the same view, once alone and once as the middle of a picture twice as large
    scene = scene_of(spheres(*[(x, y, 0.4 * ((x + y) % 2), 1) for x in range(9) for y in range(7)]))
    small = Camera((4, 3, 30), (4, 3, 0), height=4)
    changes = {"filter": "none", "resolution": resolution}
    size = (96, 80)  # half of a multiple of the pattern of directions
    whole, _ = visibility(scene, technique, replace(small, height=8), (192, 160), **changes)
    whole = whole[40:-40, 48:-48]
    bare, _ = visibility(scene, technique, small, size, **changes)
    guarded, _ = visibility(scene, technique, small, size, screen__guard=64, **changes)
    edge = np.ones_like(bare, bool)
    edge[12:-12, 12:-12] = False
    assert np.abs(guarded - whole)[edge].mean() < 0.25 * np.abs(bare - whole)[edge].mean()
    assert bare[edge].mean() > guarded[edge].mean() + 0.01, "beyond the edge counts as open"


@pytest.mark.parametrize("technique", KINDS)
def test_biases_are_shares_of_the_atoms_not_lengths(technique):
    """Everything a hundred times smaller, in the file's units, looks the same."""
    small, seen = visibility(scene_of(spheres(*PAIR)), technique, Camera((0, 0, 12), (0, 0, 0)))
    rows = (0.01 * np.array(PAIR)).tolist()
    tiny, _ = visibility(scene_of(spheres(*rows)), technique, Camera((0, 0, 0.12), (0, 0, 0)))
    assert np.abs(small - tiny)[seen].mean() < 2e-3


@pytest.mark.parametrize("technique", KINDS)
def test_what_lies_far_off_changes_nothing_here(technique):
    """No near plane and no size of the scene is in it: something small beyond, something huge."""
    camera = Camera((0, 0, 12), (0, 0, 0))
    alone, seen = visibility(scene_of(spheres(*PAIR)), technique, camera)
    crowd = spheres(*PAIR, (0, 0, 11.5, 1e-3), (0, 600, -2000, 300))
    among, _ = visibility(scene_of(crowd), technique, camera)
    assert np.abs(alone - among)[seen].mean() < 5e-3


@pytest.mark.parametrize("technique", ("ray", "analytic", "hybrid", "baked", *KINDS))
def test_an_occluder_never_brightens(technique):
    """Of two pictures the one with another sphere beside is nowhere brighter, but for noise."""
    camera = Camera((0, 0, 12), (0, 0, 0))
    changes = {"samples": 64} if technique == "ray" else {}
    open_, seen = visibility(scene_of(spheres((0, 0, 0, 2))), technique, camera, **changes)
    scene = scene_of(spheres((0, 0, 0, 2), (3.2, 0, 1.5, 1.5)))
    beside = draw(scene, camera, occlusion__technique=technique,
                  **{f"occlusion__{k}": v for k, v in changes.items()})  # fmt: skip
    occluded, first = beside.buffer("visibility"), beside.buffer("atom") == 0
    both = seen & first
    assert occluded[both].mean() < open_[both].mean() - 0.005
    assert (occluded - open_)[both].max() < 0.05
