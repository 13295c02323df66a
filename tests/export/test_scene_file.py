"""Scene files: what is written comes back, and what is wrong is said with its line."""

import pytest

from scuro.errors import LoadError, SaveError, SettingsError
from scuro.export.scene_file import Input, SceneFile, Show, read_scene_file, write_scene_file
from scuro.export.toml import Lines
from scuro.load import LoadOptions
from scuro.render_settings import Settings
from scuro.scene.lights import Light
from scuro.scene.view import ViewSettings
from scuro.settings import walk
from scuro.style.options import Representation


def document(**changes) -> SceneFile:
    values = dict(
        input=(Input(path="sample:1tii", assembly="1"), Input(path="1aon", format="cif")),
        show=(
            Show(style="cartoon", color="chain", select='name "C\\A"'),
            Show(style="licorice", sizes=Representation(licorice_radius=0.31)),
        ),
        light=(Light("spot", position=(1, 2, 3), reach=9.0, name="lamp"), Light("point")),
        load=LoadOptions(waters=False, model="all"),
        view=ViewSettings(azimuth=12.5, position=(1e-5, -2.0, 3.0), orthographic=True),
        settings=Settings(size=(640, 360), background="transparent"),
    )
    return SceneFile(**{**values, **changes})


def test_a_scene_file_comes_back_as_it_was(tmp_path):
    write_scene_file(tmp_path / "a.toml", document())
    assert read_scene_file(tmp_path / "a.toml") == document()


def test_it_names_every_setting_with_its_help(tmp_path):
    write_scene_file(tmp_path / "a.toml", document())
    text = (tmp_path / "a.toml").read_text()
    for path, parameter in walk(Settings):
        assert f"{path[-1]} = " in text and parameter.help in text


def test_paths_are_relative_to_the_file(tmp_path, monkeypatch):
    (tmp_path / "data").mkdir()
    (tmp_path / "scenes").mkdir()
    (tmp_path / "data" / "x.pdb").write_text("")
    monkeypatch.chdir(tmp_path)
    write_scene_file("scenes/a.toml", document(input=(Input(path="data/x.pdb"),)))
    text = (tmp_path / "scenes" / "a.toml").read_text()
    assert 'path = "../data/x.pdb"' in text and str(tmp_path) not in text
    (tmp_path / "moved").mkdir()
    (tmp_path / "scenes").rename(tmp_path / "moved" / "scenes")
    (tmp_path / "data").rename(tmp_path / "moved" / "data")
    monkeypatch.chdir("/")
    found = read_scene_file(tmp_path / "moved" / "scenes" / "a.toml").input[0].path
    assert found.startswith(str(tmp_path / "moved")) and found.endswith("data/x.pdb")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "lacks the line 'scuro = 1'"),
        ("scuro = 99\n", "line 1: was written by a newer scuro"),
        ("scuro = 1\n[view]\nazimuth = \n", "line 3: is not TOML"),
        ("scuro = 1\n\n[veiw]\n", "line 3: unknown key 'veiw': did you mean 'view'"),
        (
            "scuro = 1\n[settings]\nsize = [4, 4]\nsede = 1\n",
            "line 4: .*did you mean 'settings.seed",
        ),
        ("scuro = 1\n[settings.lighting]\nkey = -1\n", "line 3: settings.lighting.key: .*at least"),
        ("scuro = 1\n[settings]\nlighting.key = -1\n", "line 3: settings.lighting.key"),
        ("scuro = 1\n[settings]\nlighting = 3\n", "line 3: settings.lighting is a table"),
        ("scuro = 1\n[[show]]\n[[show]]\nopacity = 'x'\n", "line 4: show.opacity: .*a number"),
        ("scuro = 1\n[[show]]\n[show.sizes]\ntube_radius=99\n", "line 4: show.sizes.tube_radius"),
        ("scuro = 1\n[input]\npath = 'x'\n", r"line 2: input is an array of tables"),
        ("scuro = 1\n[view]\nazimuth = nan\n", "line 3: view.azimuth: .*finite"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path, text, words):
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(LoadError, match=words) as caught:
        read_scene_file(path)
    assert "bad.toml" in str(caught.value) and "\n" not in str(caught.value)


def test_what_cannot_be_read_or_saved_is_said(tmp_path):
    with pytest.raises(LoadError, match="no such file"):
        read_scene_file(tmp_path / "none.toml")
    (tmp_path / "latin.toml").write_bytes(b"scuro = 1 # \xe9")
    with pytest.raises(LoadError, match="UTF-8"):
        read_scene_file(tmp_path / "latin.toml")
    with pytest.raises(SaveError, match="standard input"):
        write_scene_file(tmp_path / "a.toml", document(input=(Input(path="-"),)))
    assert not (tmp_path / "a.toml").exists()


def test_the_document_becomes_its_scene():
    made = document(
        input=(Input(path="sample:1hpv"),),
        show=(Show("cartoon", "chain"), Show("licorice", select="organic")),
    )
    scene = made.scene()
    assert [s.style for s in scene.molecules[0].shown] == ["cartoon", "licorice"]
    assert not (scene.molecules[0].molecule.residue_name == "HOH").any(), "water was not dropped"
    assert [light.name for light in scene.lighting.lights] == ["lamp", ""]
    with pytest.raises(SettingsError, match="matches no atoms"):
        document(input=(Input(path="sample:1hpv"),), show=(Show(select="chain Z"),)).scene()


def test_lines_of_keys():
    lines = Lines('a = 1\n[t]\n"b" = 2\n[[s]]\nc.d = 3\n[s.u]\ne = 4\n[[s]]\nc = 5\n')
    assert [
        lines.find(key)
        for key in [("a",), ("t", "b"), ("s", 0, "c", "d"), ("s", 0, "u", "e"), ("s", 1, "c")]
    ] == [1, 3, 5, 7, 9]
    assert lines.find(("s", 1, "unknown")) == 8
