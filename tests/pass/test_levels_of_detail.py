"""Levels of detail: outlines and volumes kept, groups nested, far pictures calm."""

from __future__ import annotations

import numpy as np
import pytest

from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.lod import halve, levels_of_detail, merge, shadow_area
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure
from scuro.scene.scene import Scene


def globule(count: int = 3000, seed: int = 0) -> np.ndarray:
    """Spheres of 1.7 Å that fill an ellipsoid about as densely as atoms fill a protein."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (4 * count, 3))
    points = points[(points**2).sum(axis=1) < 1][:count] * [30, 18, 14]
    return np.concatenate([points, np.full((len(points), 1), 1.7)], axis=1).astype(np.float32)


def test_every_level_keeps_the_outline():
    levels = levels_of_detail(globule())
    area = shadow_area(levels[0].spheres)
    counts = [len(level.spheres) for level in levels]
    assert counts == sorted(counts, reverse=True) and counts[-1] <= 8
    assert [level.size for level in levels] == sorted(level.size for level in levels)
    for level in levels[1:]:
        assert shadow_area(level.spheres) == pytest.approx(area, rel=0.04)


def test_fine_levels_keep_the_filled_volume():
    levels = levels_of_detail(globule())
    solid = 4 / 3 * np.pi * 30.8 * 18.8 * 14.8  # the atoms, half a radius out
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 1, (4000, 3)) * [34, 22, 18]
    for level in levels[2:4]:
        centers, radii = level.spheres[:, :3], level.spheres[:, 3]
        inside = (np.linalg.norm(points[:, None] - centers, axis=2) < radii).any(axis=1)
        assert inside.mean() * 8 * 34 * 22 * 18 == pytest.approx(solid, rel=0.2)


def test_groups_are_nested_and_equally_large():
    points = globule()[:, :3]
    fine, coarse = halve(points, 6), halve(points, 4)
    np.testing.assert_array_equal(fine >> 2, coarse)
    sizes = np.bincount(fine)
    assert sizes.max() - sizes.min() <= 1


def test_merging_one_ball_changes_nothing_and_two_keep_the_moment():
    balls = np.array([[0, 0, 0, 2], [10, 0, 0, 2], [12, 0, 0, 2]], np.float32)
    merged = merge(balls, np.array([0, 1, 1]))
    np.testing.assert_allclose(merged[0], balls[0], atol=1e-6)
    np.testing.assert_allclose(merged[1], [11, 0, 0, np.sqrt(4 + 1 / 0.6)], atol=1e-5)


@pytest.fixture(scope="module")
def crowd() -> Scene:
    """12,000 globules in a slab that no ray passes."""
    rng = np.random.default_rng(2)
    positions = rng.uniform(-1, 1, (12000, 3)) * [800, 600, 100]
    turns = rng.normal(size=(12000, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    structure = Structure.of_spheres("globule", globule(1500))
    part = Part(structure, turns.astype(np.float32), positions)
    slab = Ingredient(("crowd", "slab", "globule"), (part,))
    # a second compartment, unseen behind the slab
    one = Part(structure, turns[:1].astype(np.float32), np.array([[0, 0, -130.0]]))
    hidden = Ingredient(("crowd", "behind", "globule"), (one,))
    return Scene().add(MesoscaleModel("crowd", (slab, hidden)))


def picture(renderer: Renderer, scene: Scene, distance: float, shift: float = 0, **changes):
    camera = Camera((shift, 0, distance), (shift, 0, 0), (0, 1, 0), 30)
    settings = Settings(size=(120, 90)).replace(**{"lighting__preset": "studio", **changes})
    return np.asarray(renderer.render(scene, camera, settings))[..., :3] / 255.0


def test_near_pictures_do_not_depend_on_detail_and_far_ones_keep_their_looks(crowd):
    renderer = Renderer()
    near = [picture(renderer, crowd, 250, detail=detail) for detail in (0.0, 1.0)]
    np.testing.assert_array_equal(near[0], near[1])
    far = [picture(renderer, crowd, 2600, detail=detail) for detail in (0.0, 1.0)]
    assert (far[0] != far[1]).any()
    assert far[0].mean() == pytest.approx(far[1].mean(), abs=0.02)
    covered = [(image < 0.999).any(axis=-1).mean() for image in far]
    assert covered[0] == pytest.approx(covered[1], abs=0.03)


def test_far_views_do_not_shimmer_under_sub_pixel_shifts(crowd):
    """Merged atoms and calmed normals together, against atoms drawn one by one."""
    renderer = Renderer()
    distance = 2600
    pixel = 2 * distance * np.tan(np.radians(15)) / 90

    def shimmer(**changes) -> float:
        shots = [
            picture(renderer, crowd, distance, shift=k * pixel / 4, **changes)[20:70, 40:80]
            for k in range(4)
        ]
        return float(np.var(shots, axis=0).mean())

    plain = shimmer(detail=0.0)
    semantic = {"mode": "screen", "bounce": 0.0, "thresholds": (2500.0, 1000.0)}
    calm = shimmer(detail=1.0, **{f"semantic__{k}": v for k, v in semantic.items()})
    assert calm < 0.05 * plain
    # what calmed normals and picture add to merged atoms
    merged = {**semantic, "calm": 0.0}
    assert calm < 0.4 * shimmer(detail=1.0, **{f"semantic__{k}": v for k, v in merged.items()})


def test_pictures_of_atoms_stay_sharp(crowd):
    renderer = Renderer()
    semantic = {"semantic__mode": "screen", "semantic__thresholds": (2500.0, 1000.0)}
    near = [picture(renderer, crowd, 150, **semantic, semantic__calm=c) for c in (0.0, 1.0)]
    # smoothed edges are rounded to halves before a pass that follows
    np.testing.assert_allclose(near[0], near[1], atol=1.01 / 255)
    # nor is anything spread where no smoothing of edges is asked for
    hard = picture(renderer, crowd, 2600, **semantic, antialias__method="none")
    background = (hard == 1.0).all(axis=-1)
    assert hard[~background].max() < 0.97


def test_a_palette_reaches_the_path_tracer(crowd):
    renderer = Renderer()
    camera = Camera((0, 0, 2600), (0, 0, 0), (0, 1, 0), 30)
    settings = Settings(size=(60, 45)).replace(renderer="path", path__samples=2)
    palette = settings.replace(semantic__palette="red,blue")
    own, red = (
        np.asarray(renderer.render(crowd, camera, s))[15:30, 25:35].mean(axis=(0, 1))
        for s in (settings, palette)
    )
    assert red[0] > 5 * red[1]
    assert own[0] < 2 * own[1]


def test_calmed_far_views_come_closer_to_sixteen_samples_a_pixel(crowd):
    """Calm must not be bought by blur or by other light: error and brightness, edges included."""
    renderer = Renderer()
    distance = 2600
    semantic = {"semantic__mode": "screen", "semantic__thresholds": (2500.0, 1000.0)}
    # the same pixels as four times larger, unsmoothed ones averaged in linear light
    settings = {"detail": 0.0, "semantic__calm": 0.0, "antialias__method": "none"}
    blurs = {"semantic__blur_occlusion": 12, "semantic__blur_shadow": 20}
    fine = picture(renderer, crowd, distance, size=(480, 360), **semantic, **settings, **blurs)
    ideal = (fine.reshape(90, 4, 120, 4, 3) ** 2.2).mean(axis=(1, 3)) ** (1 / 2.2)

    def error(**changes) -> float:
        found = picture(renderer, crowd, distance, detail=0.0, **semantic, **changes)
        assert found.mean() == pytest.approx(ideal.mean(), abs=0.002)
        return float(np.sqrt(np.mean((found - ideal) ** 2)))

    assert error() < 0.7 * error(semantic__calm=0.0)
