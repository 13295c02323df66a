"""Transfer functions: interpolation, files of four formats, windows, the automatic one."""

from __future__ import annotations

import json

import numpy as np
import pytest

from scuro.errors import LoadError, SettingsError
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction, from_window
from scuro.style.transfer_auto import automatic, otsu
from scuro.style.transfer_choose import choose_transfer, opacity_points
from scuro.style.transfer_files import read_transfer

BYTES = Volume(np.arange(27, dtype=np.uint8).reshape(3, 3, 3) * 9)


def test_points_are_joined_by_lines_and_tables_are_linear_light():
    transfer = TransferFunction(((0, 0, 0, 0), (10, 1, 0.5, 0)), ((0, 0), (10, 0.5)))
    table = transfer.table(0, 10, 3)
    np.testing.assert_allclose(table[1], [0.21404, 0.05088, 0, 0.25], atol=1e-4)


def test_steps_hold_to_the_middle():
    transfer = TransferFunction(((0, 1, 0, 0), (1, 0, 1, 0)), ((0, 0), (1, 1)), stepped=True)
    np.testing.assert_allclose(transfer.color(np.array([0.4, 0.6])), [[1, 0, 0], [0, 1, 0]])


def test_published_files(shared):
    folder = shared / "volumes" / "transfer_functions"
    assert len(list(folder.glob("*.tf1d"))) == 14
    for path in folder.glob("*.tf1d"):
        read_transfer(path, BYTES)
    bonsai = read_transfer(folder / "bonsai_01.tf1d", BYTES)
    assert bonsai.opacities == ((0, 0), (35, 0), (40, 0.5), (255, 0.8))
    assert bonsai.colors[0] == (0, 0, 0.9, 0)
    # values above one are extinction coefficients there
    male = read_transfer(folder / "occ_VisMale.tf1d", BYTES)
    np.testing.assert_allclose(male.opacities[-1][1], 1 - np.exp(-5))
    other = read_transfer(folder / "bonsai_01.tf1d", Volume(np.array([[[0, 510]]], np.int16)))
    assert other.opacities[2] == (80, 0.5)


def test_paraview_and_slicer(tmp_path):
    maps = [
        {"Name": "a", "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1]},
        {"Name": "b", "ColorSpace": "Lab", "RGBPoints": [0, 0, 0, 1, 1, 1, 0, 0],
         "Points": [0, 0, 0.5, 0, 1, 0.8, 0.5, 0]},
    ]  # fmt: skip
    (tmp_path / "maps.json").write_text(json.dumps(maps))
    b = read_transfer(tmp_path / "maps.json", BYTES, "b")
    np.testing.assert_allclose(b.colors[0], (0, 0, 0, 1), atol=1e-9)
    np.testing.assert_allclose(b.colors[-1], (234, 1, 0, 0), atol=1e-9)
    assert b.opacities == ((0, 0), (234, 0.8))
    color = pytest.importorskip("skimage.color")
    ends = color.rgb2lab(np.array([[[0, 0, 1.0], [1.0, 0, 0]]]))
    middle = color.lab2rgb(ends.mean(axis=1, keepdims=True)).ravel()
    np.testing.assert_allclose(b.color(np.array(117.0)), middle, atol=5e-3)
    with pytest.raises(LoadError, match="no preset 'c'; it has: a, b"):
        read_transfer(tmp_path / "maps.json", BYTES, "c")
    (tmp_path / "presets.xml").write_text(
        '<Scene><VolumeProperty name="CT-Bone" gradientOpacity="4 0 1 255 1" '
        'scalarOpacity="4 -100 0 1000 0.7" colorTransfer="8 -100 0 0 0 1000 1 1 1" /></Scene>'
    )
    bone = read_transfer(tmp_path / "presets.xml", BYTES, "CT-Bone")
    assert bone.opacities == ((-100, 0), (1000, 0.7))


def test_toml(tmp_path):
    (tmp_path / "t.toml").write_text(
        'relative = true\ncolors = [[0, "red"], [1, [0, 0, 1]]]\nopacity = [[0.5, 0], [1, 1]]\n'
    )
    made = read_transfer(tmp_path / "t.toml", BYTES)
    assert made.colors == ((0, 1, 0, 0), (234, 0, 0, 1)) and made.opacities[0] == (117, 0)


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.tf1d", "cubic 0"), ("b.tf1d", "linear\n0\n9\n1 2"), ("c.json", "{"), ("d.xml", "<a"),
     ("e.toml", "colors = 3"), ("f.toml", 'colors=[[0,"#nocolor"]]\nopacity=[[0,0]]')],
)  # fmt: skip
def test_damaged_files_give_one_sentence(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    with pytest.raises(LoadError) as caught:
        read_transfer(tmp_path / name, BYTES)
    assert name in str(caught.value) and "\n" not in str(caught.value)


def test_window_and_words():
    ct = from_window(400, 40)
    assert ct.opacity(np.array(-161.0)) == 0 and ct.opacity(np.array(240.0)) == 0.5
    assert opacity_points("40:0 90:0.8") == [(40, 0), (90, 0.8)]
    with pytest.raises(SettingsError, match="value:opacity"):
        opacity_points("40")
    with pytest.raises(SettingsError, match="no colormap 'virdis'"):
        choose_transfer(BYTES, "virdis")
    assert choose_transfer(BYTES, "viridis", "0:0 9:1").opacities == ((0, 0), (9, 1))


def test_otsu_finds_the_valley():
    rng = np.random.default_rng(3)
    values = np.concatenate([rng.normal(20, 4, 9000), rng.normal(120, 9, 3000)])
    histogram = np.histogram(values, 256, (0, 160))[0]
    assert 30 < otsu(histogram, 0, 160) < 95


def test_automatic_shows_the_object_and_not_the_background(shared):
    from scuro.load import load

    for name, least, most in (
        ("mni152_t1.nii.gz", 0.1, 0.35), ("bonsai.nii.gz", 0.02, 0.2), ("engine.nii.gz", 0.05, 0.3),
        ("betaGal.mrc.gz", 0.005, 0.05), ("channels.vti", 0.1, 0.3), ("fuel.nii.gz", 0.01, 0.2),
    ):  # fmt: skip
        volume = load(shared / "volumes" / name)
        share = (automatic(volume).opacity(volume.values) > 0.05).mean()
        assert least < share < most, (name, share)


def test_constant_volume_is_clear():
    assert automatic(Volume(np.ones((2, 2, 2), np.float32))).opacities == ((1.0, 0.0),)


def test_automatic_shows_matter_that_is_darker_than_its_surroundings():
    """A tomogram: dark shells in noise, of which the brightest voxels tell nothing."""
    rng = np.random.default_rng(4)
    z, y, x = np.indices((48, 48, 48)) - 23.5
    shell = np.abs(np.hypot(np.hypot(x, y), z) - 15) < 1.5
    values = (rng.normal(5, 6, shell.shape) - 25 * shell).astype(np.float32)
    shown = automatic(Volume(values, value_name="density")).opacity(values) > 0.05
    assert shown[shell].mean() > 0.3 > 20 * shown[~shell].mean()
    # bright matter in the same noise is shown as before
    shown = automatic(Volume(-values, value_name="density")).opacity(-values) > 0.05
    assert shown[shell].mean() > 0.3 > 20 * shown[~shell].mean()
