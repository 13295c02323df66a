"""The command line as a process: exit codes, one sentence, no traceback, nothing half-written."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

from scuro.app.cli import run

SMALL = ("--size", "96x64")


def scuro(*arguments: str, **options) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "scuro", *arguments], capture_output=True, text=True, **options
    )


def assert_one_sentence(out: str, err: str, words: str) -> None:
    assert err.count("\n") == 1 and err.startswith("scuro: "), err
    assert words in err and "Traceback" not in err and not out


def test_help_is_quick_and_lists_every_command():
    start = time.perf_counter()
    result = scuro("--help")
    assert result.returncode == 0
    for name in ("render", "info", "devices", "compare", "bench", "save"):
        assert name in result.stdout
    assert time.perf_counter() - start < 2, "something heavy is imported at the top"
    code = "import sys, scuro.app.cli; print(sorted({'numpy', 'wgpu', 'rich'} & set(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert loaded.stdout.strip() == "[]"


def test_render_says_what_it_did_and_the_picture_makes_itself_again(tmp_path):
    first, again = tmp_path / "a.png", tmp_path / "again.png"
    result = scuro(
        "render", "sample:1hpv", "-o", str(first), *SMALL, "--json", "--frames", "2",
        "--buffers", str(tmp_path / "b.npz"), "--show", "cartoon,color=chain",
        "--show", "licorice,select=organic", "--azimuth", "30", "--dpi", "300",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["adapter"] and report["atoms"] > 1500 and report["instances"] == 2
    assert set(report["seconds"]) >= {"load", "build", "first_frame", "frame", "write", "total"}
    assert all(value > 0 for value in report["seconds"].values())
    assert report["peak_memory_mb"] > 10
    assert report["settings"]["settings"]["size"] == [96, 64]
    assert [show["style"] for show in report["settings"]["show"]] == ["cartoon", "licorice"]
    with np.load(tmp_path / "b.npz") as buffers:
        assert buffers["position"].shape == (64, 96, 3)
        assert set(np.unique(buffers["object"])) == {-1, 0, 1}
    assert not result.stderr
    assert scuro("render", str(first), "-o", str(again)).returncode == 0
    with Image.open(first) as a, Image.open(again) as b:
        assert np.array_equal(np.asarray(a), np.asarray(b))
        assert np.asarray(a).std() > 10, "an empty picture"


def test_a_saved_scene_renders_the_same_and_options_change_it(tmp_path):
    scene, direct, saved = tmp_path / "s.toml", tmp_path / "direct.png", tmp_path / "saved.png"
    options = ("sample:1hpv", "--style", "backbone", "--color", "sequence", "--elevation", "20")
    assert scuro("save", *options, *SMALL, "-o", str(scene)).returncode == 0
    assert scuro("render", *options, *SMALL, "-o", str(direct)).returncode == 0
    assert scuro("render", str(scene), "-o", str(saved)).returncode == 0
    with Image.open(direct) as a, Image.open(saved) as b:
        assert np.array_equal(np.asarray(a), np.asarray(b))
    assert scuro("render", str(scene), "--size", "40x30", "-o", str(saved)).returncode == 0
    with Image.open(saved) as changed:
        assert changed.size == (40, 30)


def test_info_and_devices_speak_json():
    info = json.loads(scuro("info", "sample:1hpv", "--json").stdout)
    assert info["atoms"] > 1500
    devices = json.loads(scuro("devices", "--json").stdout)
    assert devices["adapters"] and devices["adapters"][0]["name"]
    assert "protein" in scuro("info", "sample:1hpv").stdout


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["rendr"], 2, "did you mean 'render'"),
        (["render", "sample:1hpv"], 2, "--output"),
        (["render", "-o", "x.png"], 2, "IN"),
        (["render", "sample:1hpv", "-o", "x.png", "--size", "0x0"], 2, "size must be at least 1"),
        (["render", "sample:1hpv", "-o", "x.png", "--size", "100000x100000"], 2, "at most"),
        (["render", "sample:1hpv", "-o", "x.png", "--color", "nocolor"], 2, "nocolor"),
        (["render", "sample:1hpv", "-o", "x.png", "--style", "foo"], 2, "unknown style 'foo'"),
        (["render", "sample:1hpv", "-o", "x.png", "--select", "chain Z"], 2, "matches no atoms"),
        (["render", "sample:1hpv", "-o", "x.png", "--select", "chain ("], 2, "column"),
        (["render", "sample:1hpv", "-o", "x.png", "--lighting", "foo"], 2, "unknown"),
        (["render", "sample:1hpv", "-o", "x.png", "--device", "nosuch"], 2, "no adapter matches"),
        (["render", "sample:1hpv", "-o", "x.png", "--assembly", "99"], 2, "no biological assembly"),
        (["render", "sample:1hpv", "-o", "x.gif7"], 2, "no picture format"),
        (["render", "sample:1hpv", "-o", "no/x.png"], 1, "folder does not exist"),
        (["render", "sample:1hpv", "-o", "x.png", "--buffers", "no/b.npz"], 1, "does not exist"),
        (["render", "nothere.pdb", "-o", "x.png"], 1, "nothere.pdb"),
        (["render", "bad.toml", "-o", "x.png"], 1, "bad.toml, line 2"),
        (["render", "bad.toml", "sample:1hpv", "-o", "x.png"], 2, "a scene of its own"),
        (["render", "sample:1hpv", "-o", "x.png", "--show", "cartoon", "--style", "cartoon"], 2,
         "inside each --show"),
        (["render", "empty.pdb", "-o", "x.png"], 1, "empty.pdb"),
    ],
)  # fmt: skip
def test_bad_input_is_one_sentence(tmp_path, monkeypatch, capfd, arguments, code, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.toml").write_text("scuro = 1\nwrong = 2\n")
    (tmp_path / "empty.pdb").write_text("")
    before = sorted(p.name for p in tmp_path.iterdir())
    assert run(arguments) == code
    assert_one_sentence(*capfd.readouterr(), words)
    assert sorted(p.name for p in tmp_path.iterdir()) == before, "something was left behind"


def test_a_process_ends_with_the_code_and_the_sentence(tmp_path):
    result = scuro("render", "nothere.pdb", "-o", "x.png", cwd=tmp_path)
    assert result.returncode == 1
    assert_one_sentence(result.stdout, result.stderr, "nothere.pdb")


def test_no_adapter_is_said_with_the_way_out(tmp_path):
    environment = {**os.environ, "SCURO_BACKENDS": "DX12" if os.name != "nt" else "Metal"}
    result = scuro("render", "sample:1hpv", "-o", "x.png", cwd=tmp_path, env=environment)
    assert result.returncode == 1 and not list(tmp_path.iterdir())
    assert_one_sentence(result.stdout, result.stderr, "mesa-vulkan-drivers")


def test_a_structure_from_standard_input(tmp_path):
    from scuro.load import open_source

    with subprocess.Popen(
        [sys.executable, "-m", "scuro", "info", "-", "--json"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    ) as process:  # fmt: skip
        out, _ = process.communicate(open_source("sample:1hpv").data)
    assert json.loads(out)["atoms"] == 1631


def test_an_unexpected_error_is_one_sentence_and_debug_shows_where(monkeypatch):
    from scuro.app import cli

    def broken(*_, **__):
        raise RuntimeError("two\nlines")

    monkeypatch.setattr(cli.cli, "main", broken)
    assert cli.run(["info"]) == 1
    monkeypatch.setenv("SCURO_DEBUG", "1")
    with pytest.raises(RuntimeError):
        cli.run(["info"])


def test_a_reader_that_leaves_is_no_error():
    command = f"{sys.executable} -m scuro render --help | head -c 1"
    result = subprocess.run(command, shell=True, capture_output=True, text=True)
    assert result.stderr == ""


@pytest.mark.skipif(os.name == "nt", reason="signals differ on Windows")
def test_ctrl_c_is_quiet(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "scuro", "render", "-", "-o", str(tmp_path / "x.png")],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    time.sleep(1.5)  # it waits for standard input
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 130 and (out + err).strip() == b""
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_is_quiet_where_an_import_makes_another_error_of_it(tmp_path):
    (tmp_path / "imported.py").write_text(
        "import os, signal\n"
        "try:\n    os.kill(os.getpid(), signal.SIGINT)\n    while True: pass\n"
        "except KeyboardInterrupt:\n    raise ImportError('half loaded') from None\n"
    )
    words = (
        "from scuro.app import cli; cli.import_module = lambda name: __import__('imported'); "
        "cli.main(['render'])"
    )
    done = subprocess.run([sys.executable, "-c", words], cwd=tmp_path, capture_output=True)
    assert done.returncode == 130 and (done.stdout + done.stderr).strip() == b""


@pytest.mark.parametrize("technique, style, told", [
    ("baked", "cartoon", True), ("baked", "spacefill", False), ("hybrid", "cartoon", False),
])  # fmt: skip
def test_what_a_technique_leaves_open_is_told(tmp_path, capfd, technique, style, told):
    arguments = ["render", "sample:1hpv", "-o", str(tmp_path / "a.png"), "--size", "32x24"]
    assert run([*arguments, "--style", style, "--occlusion", technique]) == 0
    said = f"'{technique}' occlusion does not darken cartoons and surfaces"
    assert (said in capfd.readouterr().err) == told


@pytest.mark.parametrize("others", [(), ("sample:1hpv",)])
@pytest.mark.parametrize(
    ("command", "suffix", "more"), [("render", ".png", ()), ("movie", ".gif", ("--length", "2"))]
)
def test_cues_that_volumes_do_not_show_are_told(tmp_path, capfd, command, suffix, more, others):
    np.save(tmp_path / "ball.npy", np.arange(64, dtype=np.uint8).reshape(4, 4, 4))
    call = [command, str(tmp_path / "ball.npy"), *others, "--size", "32x24", *more]
    for cues in ("--borders", "1", "--fog", "0.5"), ("--toon", "3"):
        assert run([*call, *cues, "-o", str(tmp_path / f"a{suffix}")]) == 0
        said = "toon does nothing here" in capfd.readouterr().err
        assert said == bool("--toon" in cues and not others)
