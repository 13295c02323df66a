"""Flags made from settings."""

import click
import pytest
from click.testing import CliRunner

from scuro.app.document import parse_light, parse_show
from scuro.app.options import SettingsCommand, take_changes, with_settings
from scuro.app.render import command as render
from scuro.errors import SettingsError
from scuro.export.scene_file import Show
from scuro.scene.lights import Light
from scuro.settings import SettingsGroup, setting
from scuro.style.options import Representation


class Inner(SettingsGroup):
    bias: float = setting(0.5, "angle bias", low=0, high=90, unit="deg")


class Group(SettingsGroup):
    technique: str = setting("ray", "how", choices=("ray", "none"), main=True)
    samples: int = setting(16, "rays a pixel", low=1)
    radius: float | None = setting(None, "reach", low=0, unit="Å")
    half_size: bool = setting(False, "at half resolution")
    tint: tuple[float, float, float] = setting((1, 1, 1), "colour", low=0, high=1)
    inner: Inner = Inner()


class Tree(SettingsGroup):
    size: tuple[int, int] = setting((1280, 720), "width and height", low=1, unit="px")
    group: Group = Group()


def changes_of(*arguments: str) -> dict:
    found: dict = {}

    @with_settings(Tree, title="Picture")
    @click.command(cls=SettingsCommand)
    def command(**values):
        found.update(take_changes(Tree, values))
        assert not values

    result = CliRunner().invoke(command, arguments, standalone_mode=False)
    if result.exception:
        raise result.exception
    found["help"] = CliRunner().invoke(command, ["--help"]).output
    return found


def test_every_setting_has_its_flag():
    found = changes_of(
        *["--size", "640x360", "--group", "none", "--group-samples", "4", "--group-half-size"],
        *["--group-radius", "2.5", "--group-tint", "1,0.5,0", "--group-inner-bias", "10"],
    )
    found.pop("help")
    made = Tree().replace(**found)
    assert made.as_dict() == {
        "size": [640, 360],
        "group": {
            "technique": "none",
            "samples": 4,
            "radius": 2.5,
            "half_size": True,
            "tint": [1.0, 0.5, 0.0],
            "inner": {"bias": 10.0},
        },
    }


def test_what_is_not_given_is_not_changed():
    found = changes_of("--no-group-half-size")
    assert set(found) == {"help", "group__half_size"} and found["group__half_size"] is False


def test_auto_is_none():
    assert changes_of("--group-radius", "auto")["group__radius"] is None


def test_help_says_range_unit_default_and_group():
    text = " ".join(changes_of()["help"].split())
    assert "--group-samples N rays a pixel. [at least 1; default 16]" in text
    assert "--group-inner-bias X angle bias. [0 to 90 deg; default 0.5]" in text
    assert "--group-radius X|auto reach. [at least 0 Å; default auto]" in text
    assert "--size WxH width and height. [at least 1 px; default 1280x720]" in text
    assert "Group: --group ray|none" in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--group-samples", "0"], "samples must be at least 1, not 0"),
        (["--group-samples", "2.5"], "whole number"),
        (["--group-samples", "many"], "needs a number, not 'many'"),
        (["--group-inner-bias", "nan"], "finite"),
        (["--group", "rya"], "did you mean 'ray'"),
        (["--size", "640"], "needs 2 values"),
    ],
)
def test_wrong_values_are_said_with_their_flag(arguments, words):
    with pytest.raises(click.UsageError, match=words) as caught:
        changes_of(*arguments)
    assert arguments[0] in caught.value.format_message()


def test_no_two_options_of_render_share_a_flag_or_a_name():
    flags = [f for p in render.params for f in (*p.opts, *p.secondary_opts)]
    assert len(flags) == len(set(flags)), sorted(f for f in flags if flags.count(f) > 1)
    names = [p.name for p in render.params]
    assert len(names) == len(set(names))


def test_show_lines():
    assert parse_show("cartoon") == Show("cartoon")
    assert parse_show("licorice, color=#ff8800, select=name CA,CB and chain A, opacity=0.5") == (
        Show("licorice", "#ff8800", "name CA,CB and chain A", 0.5)
    )
    line = parse_show("cartoon,tube-radius=0.5,bond_orders=off,segments=4")
    assert line.sizes == Representation(tube_radius=0.5, bond_orders=False, segments=4)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("cartoon,colr=red", "did you mean 'color'"),
        ("color=red", "must begin with the style"),
        ("cartoon,opacity=2", "at most 1"),
        ("cartoon,opacity=much", "needs a number"),
        ("cartoon,bond_orders=perhaps", "on or off"),
    ],
)
def test_wrong_show_lines_are_said(text, words):
    with pytest.raises(SettingsError, match=words):
        parse_show(text)


def test_light_lines():
    assert parse_light("point,position=0,20.5,-5,intensity=2,shadow=off") == Light(
        "point", position=(0, 20.5, -5), intensity=2, shadow=False
    )
    assert parse_light("spot, direction=0,-1,0, relative-to=world").relative_to == "world"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("laser", "unknown kind 'laser'"),
        ("spot,direction=0,0,0", "has no direction"),
        ("point,position=1,2", "needs 3 values"),
        ("point,intensity=-1", "at least 0"),
        ("point,intensity=nan", "finite"),
        ("point,attenuation=0,0,0", "attenuation"),
        ("point,brightness=2", "unknown key 'brightness'"),
    ],
)
def test_wrong_light_lines_are_said(text, words):
    with pytest.raises(SettingsError, match=words):
        parse_light(text)
