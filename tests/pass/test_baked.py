"""Analytic, hybrid and baked occlusion against rays and closed forms."""

import numpy as np
import pytest
from scenes import draw, renderer, scene_of, spheres

from scuro.passes.occlusion import baked
from scuro.passes.occlusion.baked import bake, bake_in_steps
from scuro.render_settings import Settings
from scuro.scene.camera import Camera

FRONT = Camera((0, 0, 16), (0, 0, 0))
CLUSTER = [(x, y, 0.6 * ((x + y) % 2), 1.0) for x in (-1.5, 0, 1.5) for y in (-1.5, 0, 1.5)]


def visibility(scene, technique, camera=FRONT, **changes):
    values = {f"occlusion__{key}": value for key, value in changes.items()}
    image = draw(scene, camera, occlusion__technique=technique, **values)
    return image.buffer("visibility"), image.buffer("object") >= 0


@pytest.mark.parametrize("technique", ["analytic", "hybrid", "baked"])
def test_a_lone_sphere_is_open(technique):
    open_, seen = visibility(scene_of(spheres((0, 0, 0, 2))), technique)
    assert open_[seen] == pytest.approx(1, abs=2e-3)
    assert (open_[~seen] == 1).all()


@pytest.mark.parametrize(
    ("technique", "bound"), [("analytic", 0.09), ("hybrid", 0.06), ("baked", 0.04)]
)
def test_a_cluster_looks_as_rays_see_it(technique, bound):
    scene = scene_of(spheres(*CLUSTER))
    truth, seen = visibility(scene, "ray", samples=512, filter="none")
    found, _ = visibility(scene, technique)
    error = (found - truth)[seen]
    assert np.sqrt(np.mean(error**2)) < bound
    if technique != "analytic":
        assert abs(error.mean()) < 0.015


def test_few_texels_an_atom_keep_the_creases():
    scene = scene_of(spheres(*CLUSTER))
    truth, seen = visibility(scene, "ray", samples=512, filter="none")
    found, _ = visibility(scene, "baked", baked__edge=8, baked__directions=512)
    dark = seen & (truth < np.quantile(truth[seen], 0.15))
    error = found - truth
    assert np.sqrt(np.mean(error[seen] ** 2)) < 0.06
    assert np.sqrt(np.mean(error[dark] ** 2)) < 0.08 and abs(error[dark].mean()) < 0.03


def test_one_small_sphere_blocks_by_the_squared_ratio():
    # cosine weighted, straight above: (r / d)²; the point faces the eye, the blocker is beside it
    scene = scene_of(spheres((0, 0, 0, 1), (0, 0, 3, 0.5)))
    camera = Camera((0, 8, 0.999), (0, 0, 0.999), (0, 0, 1), height=0.02)
    found, seen = visibility(scene, "analytic", camera)
    top = found[seen].min()
    assert top == pytest.approx(1 - (0.5 / 2) ** 2, abs=4e-3)


def test_clipping_removes_occluders_from_the_closed_form():
    from scuro.scene.clip import Clip, Plane

    scene = scene_of(spheres((0, 0, 0, 1), (1.5, 0, 1.0, 1)))
    dark, seen = visibility(scene, "analytic")
    scene.clip = Clip((Plane((0.2, 0, 0), (-1, 0, 0)),))
    for technique in ("analytic", "baked", "hybrid"):
        light, kept = visibility(scene, technique)
        left = kept & seen & (np.arange(kept.shape[1]) < kept.shape[1] // 2 - 2)
        assert light[left].mean() > dark[left].mean()
        assert light[left].mean() > 0.97


def test_baking_in_steps_tells_its_share_and_ends_alike():
    scene = scene_of(spheres(*CLUSTER))
    settings = Settings(size=(64, 48)).replace(occlusion__technique="none")
    frame = renderer().frame(scene, FRONT, settings)
    shares = list(bake_in_steps(frame, slice_rays=3000))
    assert shares == sorted(shares) and shares[-1] == 1
    atlas = bake(frame)
    assert atlas.patches == len(CLUSTER) and 0 < atlas.bytes < 64 * 2**20


def test_an_atlas_of_120_000_patches_stays_within_64_megabytes():
    settings = Settings().occlusion.baked
    wide = baked._edge(120_000, settings.megabytes) + 2
    assert wide > 4 and 4 * wide * wide * 120_000 <= 64e6


def test_with_very_many_atoms_each_has_the_average_of_its_surface(monkeypatch):
    scene = scene_of(spheres(*CLUSTER))
    fine, seen = visibility(scene, "baked", baked__directions=512)
    monkeypatch.setattr(baked, "MOST_PATCHES", 3)
    scene = scene_of(spheres(*CLUSTER))
    whole, _ = visibility(scene, "baked", baked__directions=512)
    atoms = renderer().render(scene, FRONT, Settings(size=whole.shape[::-1])).buffer("atom")
    values = [whole[atoms == atom] for atom in range(len(CLUSTER)) if (atoms == atom).any()]
    assert all(np.ptp(v) < 1e-6 for v in values), "one value an atom"
    assert abs((whole - fine)[seen].mean()) < 0.15 and np.ptp(whole[seen]) > 0.01
