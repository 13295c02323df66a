"""Buffers of a rendered sphere against the closed form, in world coordinates."""

import numpy as np
import OpenEXR
import pytest

import scuro
from scuro.errors import SettingsError
from scuro.export.png import read_settings
from scuro.export.scene_file import read_scene_file
from scuro.scene.camera import Camera
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene

CENTER, RADIUS = np.array([1000.0, -2000.0, 500.0]), 3.0


def sphere_scene() -> Scene:
    scene = Scene()
    geometry = Geometry(
        np.array([[0, 0, 0, RADIUS]], np.float32),
        np.array([[255, 0, 0, 255]], np.uint8),
        np.array([7], np.int32),
    )
    scene.extra_bodies.append(Body(geometry, positions=CENTER[None]))
    return scene


@pytest.fixture(scope="module")
def renderer() -> scuro.Renderer:
    return scuro.Renderer()


@pytest.mark.parametrize("height", [None, 8.0])
def test_buffers_of_a_sphere(renderer, height):
    eye = np.add(CENTER, [0, 6, 8])
    camera = Camera(tuple(eye), tuple(CENTER), (0, 1, 0), 40, height)
    settings = scuro.Settings(size=(96, 64))
    buffers = renderer.render(sphere_scene(), camera, settings).buffers()
    hit = buffers["atom"] == 7
    assert 500 < hit.sum() < 4000
    assert set(np.unique(buffers["atom"])) == {-1, 7}
    assert set(np.unique(buffers["instance"])) == {-1, 0}
    outward = (buffers["position"][hit] - CENTER) / RADIUS
    assert np.abs(np.linalg.norm(outward, axis=-1) - 1).max() < 2e-4
    assert np.abs(outward - buffers["normal"][hit]).max() < 2e-4
    assert np.isinf(buffers["depth"][~hit]).all() and np.isnan(buffers["position"][~hit]).all()
    assert buffers["color"][hit] == pytest.approx(np.tile([1.0, 0, 0], (hit.sum(), 1)), abs=1e-3)
    # the matrices take the position back to its pixel and depth
    view = buffers["position"][hit] @ buffers["view_from_world"][:3, :3].T
    view += buffers["view_from_world"][:3, 3]
    assert -view[:, 2] == pytest.approx(buffers["depth"][hit], abs=1e-3)
    clip = np.c_[view, np.ones(len(view))] @ buffers["clip_from_view"].T
    clip = clip[:, :3] / clip[:, 3:]
    rows, columns = np.nonzero(hit)
    assert np.abs((clip[:, 0] + 1) / 2 * 96 - 0.5 - columns).max() < 0.01
    assert np.abs((1 - clip[:, 1]) / 2 * 64 - 0.5 - rows).max() < 0.01
    assert clip[:, 2].min() > 0 and clip[:, 2].max() < 1
    assert clip[np.argmin(buffers["depth"][hit]), 2] == clip[:, 2].max(), "1 is near"


def test_a_picture_saves_with_its_buffers_and_settings(renderer, tmp_path):
    settings = scuro.Settings(size=(64, 48), background="transparent").replace(
        antialias__method="none"
    )
    image = renderer.render(sphere_scene(), settings=settings)
    image.save(tmp_path / "a.exr")
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as read:
        channels = {name: channel.pixels for name, channel in read.channels().items()}
    assert set(np.unique(channels["ids.atom"])) == {0, 8}
    assert set(np.unique(channels["A"])) <= {0, 1} and channels["R"][channels["A"] == 0].max() == 0
    image.save(tmp_path / "a.png")
    assert read_settings(tmp_path / "a.png")["settings"]["size"] == [64, 48]
    with pytest.raises(SettingsError, match="names no input"):
        read_scene_file(tmp_path / "a.png").scene()
    assert np.asarray(image.pil).shape == (48, 64, 4)


def test_stale_and_unknown_buffers_are_said(renderer):
    settings = scuro.Settings(size=(16, 16))
    first = renderer.render(sphere_scene(), settings=settings)
    with pytest.raises(SettingsError, match="did you mean 'depth'"):
        first.buffer("dept")
    renderer.render(sphere_scene(), settings=settings)
    with pytest.raises(SettingsError, match="another frame"):
        first.buffer("depth")
