"""What cannot be cut, filmed or written is refused in one sentence, and nothing is lost."""

from __future__ import annotations

import pytest
from PIL import Image

from scuro.app.cli import FAILURE, USAGE, run

SMALL = ("sample:1hpv", "--size", "24x18")
KEY = "[[key]]\nat = 0\n[[key]]\n"


def said(capsys, *arguments: str, code: int) -> str:
    """The one line on standard error of a command that fails."""
    assert run(arguments) == code
    out, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if "atoms of water" not in line]
    assert out == "" and len(lines) == 1 and lines[0].startswith("scuro: ")
    return lines[0]


@pytest.mark.parametrize("command", ["render", "movie", "save"])
@pytest.mark.parametrize(
    ("flags", "why"),
    [
        (("--cube", "0,1,1"), "cube must be at least 0.01 Å, not 0"),
        (("--cube", "-1,2,3"), "not -1"),
        (("--cube", "nan,1,1"), "finite"),
        (("--cube", "1,2"), "3 values, not 2"),
        (("--cube", "9,9,9", "--cube-center", "inf,0,0"), "finite"),
        (("--cube", "9,9,9", "--cube-rest", "ribbon"), "known: backbone, cartoon, none"),
        (("--clip", "0,0,0"), "normal that is not zero"),
        (("--clip", "1,0"), "3 values, not 2"),
        (("--clip", "1,0,0,offset=nan"), "finite"),
        (("--clip", "1,0,0,ofset=2"), "did you mean 'offset'"),
        (("--look", "goodsel"), "did you mean 'goodsell'"),
        (("--halos-color", "blakc"), "unknown color 'blakc'"),
        (("--background", "whit"), "unknown color 'whit'"),
        (("--up", "0,0,0"), "not zero"),
        (("--dpi", "0"), "at least 1"),
    ],
)
def test_bad_values_are_refused(tmp_path, capsys, command, flags, why):
    ending = {"render": "png", "movie": "gif", "save": "toml"}[command]
    target = tmp_path / f"a.{ending}"
    assert why in said(capsys, command, *SMALL, *flags, "-o", str(target), code=USAGE)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("flags", "why", "code"),
    [
        (("--clip", "1,0,0,offset=1e300"), "farther than", USAGE),
        (("--cube", "9,9,9", "--cube-center", "1e30,0,0"), "farther than", USAGE),
        (("--clip", "0,0,-1") * 33, "at most 32 clipping planes", USAGE),
        (("--clip", "0,0,-1", "--spare", "chain Q"), "selects no atoms", USAGE),
        (("--inspect", ""), "unknown buffer ''", USAGE),
        (("--trajectory", "no.xtc"), "no such file", FAILURE),
    ],
)
def test_bad_pictures_are_refused(tmp_path, capsys, flags, why, code):
    target = tmp_path / "a.png"
    assert why in said(capsys, "render", *SMALL, *flags, "-o", str(target), code=code)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (KEY + "at = -1\n", "line 3: a [[key]] needs 'at'"),
        (KEY + "at = 0.0\n", "line 3: two [[key]] tables are at second 0"),
        (KEY + "at = 1\nzoom = 'much'\n", "line 5: key.zoom: zoom needs a number"),
        (KEY + "at = 1\nfocus = 'chain Q'\n", "line 3: --focus 'chain Q' selects no atoms"),
        (KEY + "at = 1\nzom = 2\n", "line 5: unknown key 'key.zom': did you mean 'key.zoom'"),
        ("key = 3\n", "write [[key]]"),
        ("kye = 3\n", "line 1: unknown key 'kye'"),
        ("", "has no [[key]] tables"),
        (KEY + "at = 1e9\n", "100,000 at most"),
        (None, "there is no such file"),
    ],
)
def test_bad_key_frames_are_named_with_their_line(tmp_path, capsys, text, why):
    keys = tmp_path / "keys.toml"
    if text is not None:
        keys.write_text(text)
    arguments = ("movie", *SMALL, "--keys", str(keys), "-o", str(tmp_path / "a.gif"))
    line = said(capsys, *arguments, code=USAGE if "100,000" in why else FAILURE)
    assert "keys.toml" in line and why in line
    assert not (tmp_path / "a.gif").exists()


def test_places_that_cannot_be_written_are_named(tmp_path, capsys):
    there = tmp_path / "there"
    there.write_text("mine")
    for name, why, code in (
        ("", "no name for a film", USAGE),
        (str(there), "is a file", FAILURE),
        (str(tmp_path / "no" / "a.gif"), "folder does not exist", FAILURE),
    ):
        assert why in said(capsys, "movie", *SMALL, "--length", "2", "-o", name, code=code)
    assert there.read_text() == "mine"


@pytest.mark.parametrize(
    ("flags", "why"),
    [
        (("--clip", "0,0,-1,offset=500"), "clipping removes everything"),
        (("--cube", "5,5,5", "--cube-center", "500,0,0"), "nothing lies inside the cube"),
        (("--cube", "5,5,5", "--cube-center", "500,0,0", "--cube-rest", "none"), "everything"),
        (("--clip", "0,0,-1", "--opacity", "0.5"), None),
        (("--clip", "0,0,-1,offset=500", "--spare", "organic"), None),
        (("--cube", "9,9,9"), None),
        (("--cube", "9,9,9", "--style", "cartoon"), None),
    ],
)
def test_a_cut_that_leaves_nothing_is_said(tmp_path, capsys, flags, why):
    target = tmp_path / "a.png"
    assert run(["render", *SMALL, *flags, "-o", str(target)]) == 0
    lines = [x for x in capsys.readouterr().err.splitlines() if "atoms of water" not in x]
    assert len(lines) == (why is not None) and all(why in line for line in lines)
    with Image.open(target) as picture:
        assert picture.size == (24, 18)


def test_long_and_short_normals_cut_alike(tmp_path):
    pictures = []
    for normal in ("0,0.6,-0.8", "0,6e299,-8e299", "0,6e-301,-8e-301"):
        target = tmp_path / "a.png"
        assert run(["render", *SMALL, "--clip", normal, "-o", str(target)]) == 0
        with Image.open(target) as picture:
            pictures.append(picture.tobytes())
    assert pictures[0] == pictures[1] == pictures[2]
