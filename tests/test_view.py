"""Views become cameras that see what they should."""

import math

import numpy as np
import pytest

from scuro.errors import SettingsError
from scuro.scene.geometry import Body, Geometry
from scuro.scene.points import scene_points
from scuro.scene.scene import Scene
from scuro.scene.view import ViewSettings, principal_axes, view_camera


def scene_of(points: np.ndarray, **placed) -> Scene:
    scene = Scene()
    spheres = np.asarray(points, np.float32)
    colors = np.zeros((len(spheres), 4), np.uint8)
    geometry = Geometry(spheres, colors, np.arange(len(spheres), dtype=np.int32))
    scene.extra_bodies.append(Body(geometry, **placed))
    return scene


def cloud(n: int = 200) -> np.ndarray:
    rng = np.random.default_rng(5)
    centers = rng.normal(size=(n, 3)) * [20, 8, 3] + [100, -50, 30]
    return np.concatenate([centers, rng.uniform(1, 2, (n, 1))], axis=1)


def pictured(scene: Scene, view: ViewSettings, aspect: float) -> np.ndarray:
    """Extent (2, 2) of the spheres' exact silhouettes in clip coordinates."""
    camera = view_camera(scene, view, aspect)
    points = scene_points(scene)
    local = points[:, :3] @ camera.view_from_world()[:3, :3].T + camera.view_from_world()[:3, 3]
    radius, half = points[:, 3], camera.half_height()
    edges = []
    for axis, scale in ((0, half * aspect), (1, half)):
        if camera.orthographic:
            low, high = local[:, axis] - radius, local[:, axis] + radius
        else:
            distance = np.hypot(local[:, axis], local[:, 2])
            angle = np.arctan2(local[:, axis], -local[:, 2])
            spread = np.arcsin(radius / distance)
            low, high = np.tan(angle - spread), np.tan(angle + spread)
        edges.append([low.min() / scale, high.max() / scale])
    return np.array(edges).T


@pytest.mark.parametrize("aspect", [0.5, 16 / 9])
@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("view", ["front", "back", "left", "right", "top", "bottom", "principal"])
def test_a_fitted_view_fills_the_picture_and_cuts_nothing(view, orthographic, aspect):
    settings = ViewSettings(view=view, orthographic=orthographic, azimuth=20, elevation=-15, fov=40)
    low, high = pictured(scene_of(cloud()), settings, aspect)
    assert low.min() > -1 and high.max() < 1
    assert max(high.max(), -low.min()) > 0.9, "the scene is lost in the picture"
    tight = np.argmax(high - low)
    assert abs(low + high)[tight] < 0.01, "the scene is off the middle"


def test_zoom_enlarges_by_its_factor():
    scene, base = scene_of(cloud()), ViewSettings()
    for changes in ({}, {"orthographic": True}):
        near = pictured(scene, base.replace(zoom=3.0, **changes), 1.0)
        assert near == pytest.approx(3 * pictured(scene, base.replace(**changes), 1.0), rel=1e-6)


def test_azimuth_and_elevation_walk_around_the_target():
    scene = scene_of(np.array([[0, 0, 0, 1.0]]))
    right = view_camera(scene, ViewSettings(azimuth=90), 1.0)
    assert np.asarray(right.position) / right.distance == pytest.approx([1, 0, 0], abs=1e-6)
    top = view_camera(scene, ViewSettings(elevation=90), 1.0)
    assert np.asarray(top.position) / top.distance == pytest.approx([0, 1, 0], abs=1e-6)


def test_roll_turns_the_picture_clockwise():
    camera = view_camera(scene_of(np.array([[0, 0, 0, 1.0]])), ViewSettings(roll=90), 1.0)
    world_up = camera.view_from_world()[:3, :3] @ [0, 1, 0]
    assert world_up == pytest.approx([1, 0, 0], abs=1e-6), "up shows to the right"


def test_principal_axes_lie_along_the_extents_and_are_right_handed():
    rng = np.random.default_rng(1)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    axes = principal_axes(rng.gamma(1.0, size=(5000, 3)) * [9, 3, 1] @ turn.T)
    assert np.abs(np.sum(axes * turn.T, axis=1)) == pytest.approx([1, 1, 1], abs=0.02)
    assert np.linalg.det(axes) == pytest.approx(1)


def test_an_explicit_position_is_used_as_it_is():
    view = ViewSettings(position=(0, 0, 50), target=(0, 0, 1), up=(1, 0, 0), orthographic=True)
    camera = view_camera(scene_of(cloud()), view, 1.0)
    assert camera.position == (0, 0, 50) and camera.target == (0, 0, 1)
    assert camera.height == pytest.approx(2 * 49 * math.tan(math.radians(15)))


def test_instances_count_where_they_stand():
    points = scene_points(
        scene_of(
            np.array([[1, 0, 0, 0.5]]),
            rotations=np.array([[0, 0, 0, 1], [0, 0, math.sqrt(0.5), math.sqrt(0.5)]], np.float32),
            positions=np.array([[0, 0, 0], [10, 0, 0.0]]),
        )
    )
    assert points == pytest.approx(np.array([[1, 0, 0, 0.5], [10, 1, 0, 0.5]]), abs=1e-6)


def test_a_focus_without_molecules_is_said():
    with pytest.raises(SettingsError, match="selects no atoms"):
        view_camera(scene_of(cloud()), ViewSettings(focus="organic"), 1.0)
