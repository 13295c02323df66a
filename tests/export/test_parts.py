"""Pictures printed in parts, and looks."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from PIL import Image

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


@pytest.fixture
def small_parts(monkeypatch):
    """As if the GPU could draw 352 × 352 samples at once."""
    monkeypatch.setattr(part, "fits", lambda *rest: False)
    edge = {"edge": 352}
    split = part.split
    monkeypatch.setattr(
        sys.modules["scuro.render"], "split", lambda size, **options: split(size, **options | edge)
    )


@pytest.mark.parametrize("bits", [8, 16])
def test_a_printed_picture_is_the_rendered_one(tmp_path, small_parts, bits):
    scene = SceneFile((Input(path="sample:1hpv"),)).scene()
    settings = Settings(size=(500, 300)).replace(borders__width=2.0, background="transparent")
    camera = view_camera(scene, ViewSettings(), 500 / 300)
    renderer = Renderer()
    assert len(renderer.parts(settings)) > 2
    path = tmp_path / "print.png"
    save_in_parts(path, renderer, scene, camera, settings, bits=bits, dpi=300, note={"a": 1})
    whole = renderer.render(scene, camera, settings).pixels
    with Image.open(path) as image:
        assert image.info["dpi"][0] == pytest.approx(300, abs=0.1)
        printed = np.asarray(image.convert("RGBA")).astype(int)
    assert np.abs(printed - whole).max() <= 1
    assert read_settings(path) == {"a": 1}


def test_only_png_is_printed_in_parts(tmp_path, small_parts):
    scene = SceneFile((Input(path="sample:1hpv"),)).scene()
    with pytest.raises(SettingsError, match="only PNG"):
        save_in_parts(tmp_path / "a.tif", Renderer(), scene, view_camera(scene, ViewSettings(), 1),
                      Settings())  # fmt: skip


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
