"""Any texture of a frame's passes, raw and as a picture."""

import numpy as np
import pytest
from PIL import Image

import scuro
from scuro.app.cli import run
from scuro.errors import SettingsError
from scuro.export.inspect import buffer_picture
from scuro.export.png import is_png
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene


@pytest.fixture(scope="module")
def image():
    scene = Scene()
    ball = Geometry(
        np.array([[0, 0, 0, 3]], np.float32),
        np.array([[255, 0, 0, 255]], np.uint8),
        np.array([7], np.int32),
    )
    paths = ("root", "A", "a"), ("root", "B", "b"), ("root", "B", "c")
    for place, path in zip(((0, 0, 0), (4, 0, 0), (2, 4, 0)), paths, strict=True):
        scene.extra_bodies.append(Body(ball, positions=np.array([place]), path=path, name=path[-1]))
    # between two thresholds, where the passes of far and near views all run
    settings = scuro.Settings(size=(64, 48)).replace(
        semantic__mode="screen", semantic__thresholds=(100.0, 5.0), antialias__method="none"
    )
    return scuro.Renderer().render(scene, settings=settings)


def test_every_pass_of_the_semantic_pipeline_can_be_read(image):
    held = image.buffers()
    passes = ("regions", "diffuse", "gathered", "bounce", "lit", "gathered_blurred",
              "bounce_blurred", "calm_surface", "ids", "surface")  # fmt: skip
    for name in passes:
        assert held[name].shape[:2] == (48, 64), name
        np.testing.assert_array_equal(held[name], image.buffer(name))
    regions = image.buffer("regions")
    assert len(np.unique(regions[..., 0])) == 3, "nothing, A and B"
    np.testing.assert_array_equal(image.buffer("regions.y"), regions[..., 1])
    light = held["albedo"][..., :3] * (
        held["gathered_blurred"][..., :3] * held["bounce_blurred"][..., 3:].astype(float)
        + held["bounce_blurred"][..., :3]
    )
    # bounce and shadow are found in one pixel of four
    there = (held["ids"][..., 2] < 3)[::2, ::2]
    shown = image.buffer("linear")[::2, ::2, :3]
    np.testing.assert_allclose(shown[there], light[::2, ::2][there], atol=3e-3)


def test_unknown_names_and_channels_are_said(image):
    with pytest.raises(SettingsError, match="did you mean 'regions'"):
        image.buffer("region")
    with pytest.raises(SettingsError, match="channels x, y, z, w, not 'q'"):
        image.buffer("regions.q")


def test_pictures_of_buffers():
    ids = np.array([[0, 1, 2, 0xFFFFFFFF]], np.uint32)
    shown = buffer_picture("ids", ids)[0, :, :3]
    assert len({tuple(c) for c in shown.tolist()}) == 4 and not shown[3].any()
    depth = np.array([[1.0, 2.0, 3.0, np.inf]], np.float32)
    assert buffer_picture("depth", depth)[0, :, 0].tolist() == [0, 128, 255, 255]
    share = np.array([[0.25, 0.5]], np.float32)
    assert buffer_picture("visibility", share)[0, :, 0].tolist() == [64, 128]
    normal = np.array([[[0, 0, 1.0], [0, 0, 0]]], np.float32)
    assert buffer_picture("normal", normal)[0, :, :3].tolist() == [[128, 128, 255], [0, 0, 0]]
    light = np.array([[[1.0, 0.2140, 0, 1]]], np.float32)
    assert buffer_picture("gathered", light)[0, 0].tolist() == [255, 127, 0, 255]


def test_the_command_writes_a_buffer_in_place_of_the_picture(tmp_path, capfd):
    out = tmp_path / "regions.png"
    arguments = ["render", "sample:1hpv", "-o", str(out), "--size", "80x60", "--semantic", "screen"]
    assert run([*arguments, "--inspect", "regions.y"]) == 0
    assert is_png(out) and len(np.unique(np.asarray(Image.open(out)).reshape(-1, 3), axis=0)) >= 2
    assert run([*arguments, "--inspect", "nonsense"]) == 1 + 1
    assert "gathered_blurred" in capfd.readouterr().err
