"""Depth cues on a volume's dense part."""

from __future__ import annotations

import numpy as np
import pytest

import scuro
from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume

SIZE = (96, 96)
RADIUS, VOXELS = 10.0, 32


@pytest.fixture(scope="module")
def ball() -> Scene:
    z, y, x = np.indices((VOXELS,) * 3) - (VOXELS - 1) / 2
    away = np.sqrt(x * x + y * y + z * z)
    values = np.clip((RADIUS - away) / 4 + 0.5, 0, 1).astype(np.float32)
    return Scene().add(Volume(values, name="ball"))


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def drawn(renderer: Renderer, scene: Scene, **changes):
    """The frame's textures by name, and its camera."""
    settings = scuro.Settings(size=SIZE).replace(
        lighting__preset="studio", antialias__method="none", volume__occlusion__on=False,
        volume__opacity="0.49:0 0.51:0.999", **changes,
    )  # fmt: skip
    camera = Camera.fitted(scene.bounds(), direction=(0, 0, 1), up=(0, 1, 0), aspect=1.0)
    frame = renderer.frame(scene, camera, settings)
    frame.recorder.submit()

    def read(name: str) -> np.ndarray:
        return renderer.gpu.read_texture(frame.resources[name]).astype(float)

    return read, camera


def test_fog_is_that_of_the_depth_of_half_the_opacity(renderer, ball):
    read, camera = drawn(renderer, ball, fog__strength=1.0, fog__color="#ff0000", fog__start=0.0)
    before, after = read("combined"), read("color")
    depth = read("volume_depth")
    dense = before[..., 3] >= 0.5
    row = camera.view_from_world()[2]
    ends = -(ball.volumes[0].outline @ row[:3] + row[3])
    amount = (depth - ends.min()) / (ends.max() - ends.min())
    fog = np.array([1.0, 0, 0, 1]) * before[..., 3:]
    expected = before + (fog - before) * amount[..., None]
    assert dense.sum() > 500 and np.ptp(amount[dense]) > 0.2
    np.testing.assert_allclose(after[dense], expected[dense], atol=2e-3)
    np.testing.assert_array_equal(after[~dense], before[~dense])


def test_a_ball_has_its_own_depth_and_normals(renderer, ball):
    read, camera = drawn(renderer, ball, borders__width=1.0)
    front = read("front")
    seen = front[..., 3] > 0
    j, i = np.nonzero(seen)
    eye, half = np.asarray(camera.position), camera.half_height()
    depth = front[seen][:, 3]
    x = ((i + 0.5) / SIZE[0] * 2 - 1) * half * depth
    y = (1 - (j + 0.5) / SIZE[1] * 2) * half * depth
    points = np.stack([x + eye[0], y + eye[1], eye[2] - depth], 1) - (VOXELS - 1) / 2
    away = np.linalg.norm(points, axis=1)
    inner = np.hypot(points[:, 0], points[:, 1]) < 0.8 * RADIUS
    assert np.abs(away - RADIUS)[inner].max() < 0.3
    turned = (front[seen][:, :3] * points).sum(axis=1) / away
    assert np.median(turned[inner]) > 0.97 and turned[inner].min() > 0.85


def test_lines_lie_around_a_ball(renderer, ball):
    plain, _ = drawn(renderer, ball)
    lined, _ = drawn(renderer, ball, borders__width=2.0)
    opacity = plain("color")[..., 3]
    change = lined("color") - plain("color")
    assert np.abs(change[opacity > 0.99]).max() < 1e-3, "nothing in the ball stands out"
    assert (change[..., 3] > 0.5).sum() > 100, "lines lie on the background"
    assert np.abs(change[0]).max() == 0


def test_passes_after_the_cues_have_the_surfaces_again(renderer, ball):
    read, _ = drawn(renderer, ball, halos__width=6.0)
    assert (read("surface")[..., 3] == 0).all() and (read("front")[..., 3] > 0).any()
