"""Pictures printed in parts, and looks."""

from __future__ import annotations

import numpy as np
import OpenEXR
import pytest
import tifffile
from PIL import Image

from scuro import render_parts
from scuro.app.cli import run
from scuro.errors import SettingsError
from scuro.export import looks
from scuro.export.parts import save_in_parts
from scuro.export.png import read_settings
from scuro.export.scene_file import Input, SceneFile
from scuro.passes import part
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.view import ViewSettings, view_camera


def small_parts(monkeypatch):
    """As if the GPU could draw 352 × 352 samples at once."""
    monkeypatch.setattr(part, "fits", lambda *rest: False)
    edge = {"edge": 352}
    split = part.split
    monkeypatch.setattr(
        render_parts, "split", lambda size, **options: split(size, **options | edge)
    )


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


@pytest.mark.parametrize(
    ("name", "bits"), [("a.png", 8), ("a.png", 16), ("a.tif", 8), ("a.tif", 16), ("a.jpg", 8)]
)
def test_a_printed_picture_is_the_rendered_one(tmp_path, renderer, monkeypatch, name, bits):
    scene, camera, settings = printed(background="transparent")
    whole = renderer.render(scene, camera, settings)
    whole.save(tmp_path / f"whole-{name}", bits=bits)
    small_parts(monkeypatch)
    assert len(renderer.parts(settings)) > 2
    path = tmp_path / name
    save_in_parts(path, renderer, scene, camera, settings, bits=bits, note={"a": 1})
    pictures = [read(path), read(tmp_path / f"whole-{name}")]
    assert pictures[0].shape == pictures[1].shape
    assert np.abs(pictures[0] - pictures[1]).max() <= (1 if bits == 8 else 257)
    with Image.open(path) as image:
        assert image.info["dpi"][0] == pytest.approx(192, abs=0.1)
    if name == "a.png":
        assert read_settings(path) == {"a": 1}


def test_a_printed_openexr_holds_the_rendered_layers(tmp_path, renderer, monkeypatch):
    scene, camera, settings = printed(occlusion__technique="ray")
    renderer.render(scene, camera, settings).save(tmp_path / "whole.exr")
    small_parts(monkeypatch)
    save_in_parts(tmp_path / "a.exr", renderer, scene, camera, settings)
    printed_layers, layers = (
        {
            name: channel.pixels
            for name, channel in OpenEXR.File(str(tmp_path / file), separate_channels=True)
            .channels()
            .items()
        }
        for file in ("a.exr", "whole.exr")
    )
    assert set(printed_layers) == set(layers) and "occlusion.visibility" in layers
    for name, plane in layers.items():
        found = printed_layers[name]
        assert found.dtype == plane.dtype
        if plane.dtype.kind == "u":
            assert (found != plane).sum() <= 2, name
        else:
            near = np.isclose(found, plane, atol=2e-3) | (found == plane)
            assert (~near).mean() < 1e-4, name


def printed(**changes):
    """A scene, camera and settings whose lines are twice as wide as on a screen."""
    scene = SceneFile((Input(path="sample:1hpv"),)).scene()
    settings = Settings(size=(500, 300)).replace(borders__width=2.0, dpi=192, **changes)
    return scene, view_camera(scene, ViewSettings(), 500 / 300), settings


def read(path) -> np.ndarray:
    if path.suffix == ".tif":
        return tifffile.imread(path).astype(int)
    with Image.open(path) as image:
        return np.asarray(image).astype(int)


def test_what_a_format_cannot_hold_is_refused_before_anything_is_drawn(tmp_path):
    scene, camera, settings = printed()
    for name, changes, bits, words in (
        ("a.webp", {"size": (16384, 8)}, 8, "at most 16383"),
        ("a.jpg", {}, 16, "8 bits"),
        ("a.bmp", {}, 8, "no picture format"),
    ):
        with pytest.raises(SettingsError, match=words):
            save_in_parts(
                tmp_path / name, None, scene, camera, settings.replace(**changes), bits=bits
            )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", sorted(looks.looks()))
def test_every_look_draws_and_says_what_it_is(tmp_path, name):
    assert len(looks.about(name)) > 20
    out = str(tmp_path / "a.png")
    arguments = ["render", "sample:1hpv", "--look", name, "--size", "48x36", "-o", out]
    assert run([*arguments, "--antialias", "none"]) == 0
    assert len(np.unique(np.asarray(Image.open(out)))) > 20


def test_a_users_own_look_is_found_and_an_unknown_one_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(looks, "user_folder", lambda: tmp_path)
    (tmp_path / "mine.toml").write_text("# My own.\nscuro = 1\n[settings.fog]\nstrength = 0.25\n")
    document = looks.with_look(SceneFile((), settings=Settings(size=(7, 5))), "mine")
    assert document.settings.fog.strength == 0.25 and document.settings.size == (7, 5)
    assert looks.about("mine") == "My own."
    assert run(["render", "sample:1hpv", "--look", "clai", "-o", str(tmp_path / "a.png")]) == 2
    assert "did you mean 'clay'" in capsys.readouterr().err
