"""Pictures as files: what is written is what is read back by other libraries."""

import json
import struct
import zlib

import numpy as np
import OpenEXR
import pytest
import tifffile
from PIL import Image

from scuro.errors import LoadError, SaveError, SettingsError
from scuro.export.files import replacing
from scuro.export.formats import display, encoded_srgb
from scuro.export.image import Picture, save_buffers, save_picture
from scuro.export.png import PngWriter, quantised, read_settings

SETTINGS = {"style": "cartoon", "nested": {"samples": 16, "name": "Ångström"}}


def save(path, linear: np.ndarray, *, buffers=None, **about) -> None:
    pixels = quantised(display(linear), 8)
    arrays = {"linear": linear, **(buffers or {})}
    save_picture(path, Picture(pixels, arrays.__getitem__, tuple(buffers or ()), **about))


def picture(h: int = 13, w: int = 17, *, opaque: bool = True) -> np.ndarray:
    """Premultiplied linear light."""
    rng = np.random.default_rng(7)
    alpha = np.ones((h, w, 1)) if opaque else rng.random((h, w, 1))
    return np.concatenate([rng.random((h, w, 3)) * alpha, alpha], axis=-1).astype(np.float32)


def test_srgb_at_its_known_points():
    assert encoded_srgb(np.array([0.0, 1.0, 0.0031308])) == pytest.approx([0, 1, 0.04045], abs=1e-5)
    assert encoded_srgb(np.array([0.5])) == pytest.approx([0.735357], abs=1e-5)


def test_a_half_covered_edge_keeps_its_colour():
    red = np.array([[[0.5, 0.0, 0.0, 0.5]]], np.float32)
    assert display(red)[0, 0] == pytest.approx([1, 0, 0, 0.5]), "a dark fringe"


@pytest.mark.parametrize("opaque", [True, False])
def test_png_8_bit_as_pillow_reads_it(tmp_path, opaque):
    linear = picture(opaque=opaque)
    save(tmp_path / "a.png", linear, settings=SETTINGS, dpi=300)
    with Image.open(tmp_path / "a.png") as read:
        read.load()
        assert read.mode == ("RGB" if opaque else "RGBA")
        assert read.info["dpi"] == pytest.approx((300, 300), abs=0.02)
        assert read.info["srgb"] == 0
        assert json.loads(read.text["scuro"]) == SETTINGS
        expected = display(linear)[..., : 3 if opaque else 4] * 255
        assert np.abs(np.asarray(read) - expected).max() <= 0.5 + 1e-4


def test_png_16_bit_keeps_what_8_bits_lose(tmp_path):
    linear = picture()
    save(tmp_path / "a.png", linear, bits=16)
    with Image.open(tmp_path / "a.png") as read:  # Pillow reads 16-bit colour as 8
        assert np.abs(np.asarray(read) / 255 - display(linear)[..., :3]).max() < 1 / 255
    stream = zlib.decompress(image_data((tmp_path / "a.png").read_bytes()))
    first = np.frombuffer(stream[1 : 1 + 17 * 6], ">u2").reshape(17, 3)
    assert np.abs(first / 65535 - display(linear)[0, :, :3]).max() < 1 / 65535


def image_data(png: bytes) -> bytes:
    """The contents of all IDAT chunks."""
    found, at = b"", 8
    while at < len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        if kind == b"IDAT":
            found += png[at + 8 : at + 8 + length]
        at += 12 + length
    return found


def test_png_in_pieces_is_the_png_in_one(tmp_path):
    pixels = display(picture(20, 9))[..., :3]
    for name, cuts in (("one", [20]), ("many", [1, 7, 12])):
        with open(tmp_path / name, "wb") as file:
            writer = PngWriter(file, (9, 20), 3)
            for rows in np.split(pixels, np.cumsum(cuts)[:-1]):
                writer.write_rows(rows)
            writer.finish()
    with Image.open(tmp_path / "one") as one, Image.open(tmp_path / "many") as many:
        assert np.array_equal(np.asarray(one), np.asarray(many))


def test_settings_come_back_and_their_absence_is_said(tmp_path):
    save(tmp_path / "a.png", picture(), settings=SETTINGS)
    assert read_settings(tmp_path / "a.png") == SETTINGS
    Image.new("RGB", (4, 4)).save(tmp_path / "other.png")
    with pytest.raises(LoadError, match="carries no scuro settings"):
        read_settings(tmp_path / "other.png")
    (tmp_path / "text.png").write_text("hello")
    with pytest.raises(LoadError, match="is not a PNG"):
        read_settings(tmp_path / "text.png")
    whole = (tmp_path / "a.png").read_bytes()
    (tmp_path / "cut.png").write_bytes(whole[:90])
    with pytest.raises(LoadError, match="damaged"):
        read_settings(tmp_path / "cut.png")
    with pytest.raises(LoadError, match="cannot be read"):
        read_settings(tmp_path / "none.png")


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("opaque", [True, False])
def test_tiff(tmp_path, bits, opaque):
    linear = picture(opaque=opaque)
    save(tmp_path / "a.tif", linear, settings=SETTINGS, bits=bits, dpi=600)
    with tifffile.TiffFile(tmp_path / "a.tif") as read:
        page = read.pages[0]
        assert json.loads(page.description) == SETTINGS
        assert page.tags["XResolution"].value[0] / page.tags["XResolution"].value[1] == 600
        values = page.asarray() / (2**bits - 1)
    expected = display(linear)[..., : 3 if opaque else 4]
    assert np.abs(values - expected).max() <= 0.51 / (2**bits - 1)


def test_openexr_layers_and_premultiplied_light(tmp_path):
    linear = picture(opaque=False)
    ids = np.full(linear.shape[:2], -1, np.int32)
    ids[3, 4] = 41
    normal = np.random.default_rng(0).random((*linear.shape[:2], 3)).astype(np.float32)
    buffers = {"depth": normal[..., 0], "normal": normal, "atom": ids, "visibility": normal[..., 1]}
    save(tmp_path / "a.exr", linear, buffers=buffers, settings=SETTINGS)
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as read:
        channels = {name: channel.pixels for name, channel in read.channels().items()}
        assert json.loads(read.header()["scuro"]) == SETTINGS
    assert {"R", "A", "depth.Z", "normal.Y", "ids.atom", "occlusion.visibility"} <= set(channels)
    for number, name in enumerate("RGBA"):
        assert np.abs(channels[name] - linear[..., number]).max() < 1e-3
    assert np.array_equal(channels["normal.Y"], normal[..., 1])
    assert channels["ids.atom"][3, 4] == 42 and channels["ids.atom"][0, 0] == 0


def test_jpeg_lies_on_white_paper(tmp_path):
    save(tmp_path / "a.jpg", np.zeros((16, 16, 4), np.float32), dpi=150)
    with Image.open(tmp_path / "a.jpg") as read:
        assert np.asarray(read).min() == 255
        assert read.info["dpi"] == (150, 150)


def test_buffers_round_trip(tmp_path):
    save_buffers(tmp_path / "b.npz", {"depth": np.eye(3), "view_from_world": np.eye(4)})
    with np.load(tmp_path / "b.npz") as read:
        assert np.array_equal(read["depth"], np.eye(3))
    with pytest.raises(SettingsError, match=r"\.npz"):
        save_buffers(tmp_path / "b.txt", {})


@pytest.mark.parametrize(
    ("name", "kind", "words"),
    [
        ("a.bmp", SettingsError, "no picture format '.bmp'"),
        ("picture", SettingsError, "without ending"),
        ("missing/a.png", SaveError, "folder does not exist"),
        ("folder.png", SaveError, "is a folder"),
    ],
)
def test_what_cannot_be_written_is_said_and_leaves_nothing(tmp_path, name, kind, words):
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(kind, match=words):
        save(tmp_path / name, picture())
    assert [p.name for p in tmp_path.iterdir()] == ["folder.png"]


def test_a_full_disk_is_said():
    with pytest.raises(SaveError, match="No space left"), replacing("/dev/full") as file:
        file.write(b"x" * 100_000)


def test_an_interrupted_write_keeps_the_old_file(tmp_path):
    target = tmp_path / "a.png"
    target.write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt), replacing(target) as file:
        file.write(b"half of the n")
        raise KeyboardInterrupt
    assert target.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]
