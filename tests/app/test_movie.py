"""``scuro movie``: what comes out, and what is left when it is broken off."""

from __future__ import annotations

import itertools
import json
import signal
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from scuro.app.cli import INTERRUPTED, run
from scuro.errors import SaveError, SettingsError
from scuro.export import files
from scuro.export.encoders import GIF_COLORS, write_gif
from scuro.export.film_names import FADE, FilmNames
from scuro.export.keys import between
from scuro.export.looks import with_look
from scuro.export.motion import Motion, MovieSettings, blended, mixed, steady
from scuro.export.movie import Film
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render import Renderer
from scuro.render_names import name_text
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.projection import project
from scuro.style.labels import overlapping

SMALL = ("--size", "48x36", "--style", "spacefill")


def pages(path) -> list[np.ndarray]:
    with Image.open(path) as gif:
        found = []
        for number in range(gif.n_frames):
            gif.seek(number)
            found.append(np.asarray(gif.convert("RGB")))
        return found


def test_a_gif_turns_loops_and_leaves_no_frames_behind(tmp_path):
    film = tmp_path / "turn.gif"
    assert run(["movie", "sample:1hpv", *SMALL, "--length", "4", "-o", str(film)]) == 0
    found = pages(film)
    assert len(found) == 4 and all((a != found[0]).any() for a in found[1:])
    with Image.open(film) as gif:
        assert gif.info["loop"] == 0
    assert [p.name for p in tmp_path.iterdir()] == ["turn.gif"]


@pytest.mark.parametrize("ending", ["mp4", "webm"])
def test_videos_have_their_frames_and_size(tmp_path, ending):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    film = tmp_path / f"turn.{ending}"
    assert run(["movie", "sample:1hpv", "--size", "49x37", "--length", "3", "-o", str(film)]) == 0
    reader = ffmpeg.read_frames(str(film))
    assert next(reader)["size"] == (50, 38)  # padded to even
    assert len(list(reader)) == 3


@pytest.mark.parametrize("ending", ["mp4", "webm"])
def test_videos_say_how_their_colors_are_to_be_read(tmp_path, ending):
    """Read as HD video, which the file says it is, colours are those of the frames."""
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    film = tmp_path / f"red.{ending}"
    background = ("--background", "#c83214", "--lighting", "flat", "--color", "#c83214")
    assert run(["movie", "sample:1hpv", "--size", "63x47", "--length", "2", *background,
                "-o", str(film)]) == 0  # fmt: skip
    said = subprocess.run([ffmpeg.get_ffmpeg_exe(), "-i", str(film)], capture_output=True).stderr
    assert b"bt709/bt709/iec61966-2-1" in said
    as_hd = ["-vf", "scale=in_color_matrix=bt709:in_range=tv"]
    reader = ffmpeg.read_frames(str(film), output_params=as_hd)
    size = next(reader)["size"]
    frame = np.frombuffer(next(reader), np.uint8).reshape(*size[::-1], 3)
    # to the very edge, where an odd size is made even
    for corner in (frame[:3, :3], frame[-2:, -2:]):
        assert np.abs(corner.astype(int) - (0xC8, 0x32, 0x14)).max() <= 4


def test_films_take_more_rays_unless_told(tmp_path):
    scene = SceneFile((Input(path="sample:1hpv"),), settings=Settings(size=(32, 24)))
    assert Motion(scene, MovieSettings(length=2)).at(0).settings.occlusion.samples == 16
    for changes in ({"occlusion__samples": 3}, {"occlusion__technique": "gtao"}):
        told = scene.settings.replace(**changes)
        kept = Motion(SceneFile(scene.input, settings=told), MovieSettings(length=2)).at(0).settings
        assert kept.occlusion == told.occlusion


def test_a_broken_off_film_goes_on_and_comes_out_the_same(tmp_path, monkeypatch, capsys):
    arguments = ["movie", "sample:1hpv", *SMALL, "--length", "4", "-o"]
    whole, broken = tmp_path / "whole.gif", tmp_path / "broken.gif"
    assert run([*arguments, str(whole)]) == 0
    draw, drawn = Renderer.render, []

    def interrupted(self, *rest):
        if len(drawn) == 2:
            raise KeyboardInterrupt
        drawn.append(1)
        return draw(self, *rest)

    monkeypatch.setattr(Renderer, "render", interrupted)
    assert run([*arguments, str(broken)]) == INTERRUPTED
    assert "2 of 4 frames" in capsys.readouterr().err and not broken.exists()
    monkeypatch.setattr(Renderer, "render", draw)
    assert run([*arguments, str(broken), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["drawn"] == 2
    assert broken.read_bytes() == whole.read_bytes()


def named(**changes) -> Motion:
    document = SceneFile(
        input=(Input(path="sample:1hpv"),),
        show=(Show(style="spacefill"),),
        settings=Settings(size=(320, 240)).replace(labels__show="residues", labels__most=8),
    )
    return Motion(document, MovieSettings().replace(**{"length": 60, "swing": 12.0} | changes))


def test_names_stay_on_their_points_fade_and_never_overlap():
    renderer, motion = Renderer(), named(motion="rock")
    names = FilmNames(renderer, motion)
    fade = round(FADE * motion.movie.fps)
    opacities: list[dict] = []
    for frame in range(motion.length):
        found = names.at(frame)
        assert 0 < len(found) <= 8
        camera = motion.camera(frame)
        boxes = []
        for label, x, y in found:
            place = project(camera, [label.anchor], (320, 240))[0]
            assert (x, y) == pytest.approx(tuple(place[:2]))
            boxes.append(name_text(label, x, y, motion.settings).box)
        for n, box in enumerate(boxes):
            assert not overlapping(np.array(boxes[n + 1 :]).reshape(-1, 4), np.array(box)).any()
        opacities.append({(label.key, label.anchor): label.opacity for label, _, _ in found})
    changes = [
        abs(b.get(key, 0) - a.get(key, 0))
        for a, b in itertools.pairwise(opacities)
        for key in a.keys() | b.keys()
    ]
    assert max(changes) <= 1 / (fade + 1) + 0.03, "nothing pops"
    lives = {key for frame in opacities for key in frame}
    assert len(lives) < 40, "names stay"
    # what a frame shows follows from the film alone
    again = FilmNames(Renderer(), named(motion="rock"))
    assert again.at(37) == names.at(37)


def test_a_film_with_names_goes_on_the_same_after_a_break(tmp_path):
    renderer, motion = Renderer(), named(motion="rock", length=8)
    films = [Film(tmp_path / name, motion, {}) for name in ("whole", "broken")]
    assert len(list(films[0].draw(renderer))) == 8
    drawing = films[1].draw(renderer)
    assert [next(drawing) for _ in range(3)] == [0, 1, 2]
    drawing.close()
    assert list(Film(tmp_path / "broken", motion, {}).draw(Renderer())) == [3, 4, 5, 6, 7]
    for number in range(8):
        a, b = (film.frame_path(number).read_bytes() for film in films)
        assert a == b, number


KILLED = """
import os, signal, sys
from scuro.app.cli import run
from scuro.export import encoders, movie, png

def killing(before, count):
    def after(*args):
        nonlocal count
        result = before(*args)
        count -= 1
        if not count:
            os.kill(os.getpid(), signal.SIGKILL)
        return result
    return after

where, *arguments = sys.argv[1:]
if where == "within":
    movie.PngWriter.write_rows = killing(png.PngWriter.write_rows, 2)
elif where == "between":
    movie.Film.keep = killing(movie.Film.keep, 2)
else:
    encoders._Nearest.__call__ = killing(encoders._Nearest.__call__, 3)
run(arguments)
"""


def test_a_killed_film_goes_on_and_comes_out_the_same(tmp_path):
    """Killed within a frame, between two, and while frames are joined: nothing is left over."""
    arguments = ["movie", "sample:1hpv", *SMALL, "--length", "6", "-o"]
    whole, broken = tmp_path / "whole.gif", tmp_path / "broken.gif"
    assert run([*arguments, str(whole)]) == 0
    frames = tmp_path / "broken.gif.frames"
    for where, finished in (("within", 1), ("between", 3), ("joining", 6)):
        command = [sys.executable, "-c", KILLED, where, *arguments, str(broken)]
        assert subprocess.run(command, capture_output=True).returncode == -signal.SIGKILL
        names = [path.name for path in frames.iterdir()]
        assert sum(not name.startswith((".", "plan")) for name in names) == finished
        assert sum(name.startswith(".") for name in names) == (where != "between")
        assert not broken.exists()
    assert run([*arguments, str(broken)]) == 0
    assert broken.read_bytes() == whole.read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["broken.gif", "whole.gif"]


@pytest.mark.parametrize("ending", ["gif", "mp4", "webm"])
def test_the_same_frames_make_the_same_file(tmp_path, ending):
    document = SceneFile((Input(path="sample:1hpv"),), settings=Settings(size=(32, 24)))
    motion, rng = Motion(document, MovieSettings(length=3)), np.random.default_rng(0)
    frames = rng.integers(0, 256, (3, 24, 32, 4), np.uint8)
    made = []
    for name in "ab":
        film = Film(tmp_path / f"{name}.{ending}", motion, {})
        for number, frame in enumerate(frames):
            film.keep(number, frame)
        film.join()
        made.append(film.path.read_bytes())
    assert made[0] == made[1]


def test_frames_of_another_film_are_not_taken(tmp_path, capsys):
    folder = str(tmp_path / "frames")
    common = ["movie", "sample:1hpv", "--size", "48x36", "--length", "2", "--json", "-o", folder]
    assert run(common) == 0
    assert run([*common, "--color", "chain"]) == 0
    out = capsys.readouterr().out
    assert out.count('"drawn": 2') == 2
    names = sorted(p.name for p in (tmp_path / "frames").iterdir())
    assert names == ["000000.png", "000001.png"]


def test_unfinished_frames_are_taken_up_by_the_same_film_only(tmp_path):
    document = SceneFile((Input(path="sample:1hpv"),), settings=Settings(size=(32, 24)))
    motion = Motion(document, MovieSettings(length=3))
    next(Film(tmp_path / "a.gif", motion, {"color": "chain"}).draw(Renderer()))
    assert Film(tmp_path / "a.gif", motion, {"color": "chain"}).missing == [1, 2]
    assert Film(tmp_path / "a.gif", motion, {"color": "element"}).missing == [0, 1, 2]


def test_a_full_disk_keeps_finished_frames(tmp_path, monkeypatch):
    document = SceneFile((Input(path="sample:1hpv"),), settings=Settings(size=(32, 24)))
    film = Film(tmp_path / "a.gif", Motion(document, MovieSettings(length=3)), {})
    frames = film.draw(Renderer())
    assert next(frames) == 0

    def full(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(SaveError, match="No space left"):
        next(frames)
    monkeypatch.undo()
    assert film.missing == [1, 2]
    assert not (tmp_path / "a.gif").exists()
    assert sorted(p.name for p in film.folder.iterdir()) == ["000000.png", "plan.json"]


def test_an_unknown_format_a_sweep_without_planes_and_one_model_are_refused(tmp_path, capsys):
    def said(*arguments: str) -> str:
        assert run(["movie", "sample:1hpv", *arguments]) == 2
        return capsys.readouterr().err

    assert "film format '.avi'" in said("-o", str(tmp_path / "a.avi"))
    assert "--clip" in said("--sweep", "5", "-o", str(tmp_path / "a.gif"))
    assert "one model only" in said("--play", "-o", str(tmp_path / "a.gif"))
    assert "unknown look" in said("--to-look", "goodsel", "-o", str(tmp_path / "a.gif"))
    assert not list(tmp_path.iterdir())


def test_key_frames_are_passed_at_their_seconds(tmp_path):
    keys = tmp_path / "keys.toml"
    keys.write_text("[[key]]\nat = 0\n[[key]]\nat = 1.0\nazimuth = 90\nzoom = 2\nease = 'linear'\n")
    document = SceneFile((Input(path="sample:1hpv"),))
    motion = Motion(document, MovieSettings(keys=str(keys), fps=10.0))
    assert motion.length == 11
    start, middle, end = (motion.at(n).camera for n in (0, 5, 10))

    def side(camera: Camera) -> np.ndarray:
        return camera.view_from_world()[2, :3]

    assert side(start) @ side(end) == pytest.approx(0, abs=1e-6)
    assert side(start) @ side(middle) == pytest.approx(np.cos(np.pi / 4), abs=1e-6)
    assert end.fov < start.fov


def test_halfway_between_cameras_and_settings():
    a, b = Camera((0, 0, 10)), Camera((10, 0, 0))
    assert between(a, b, 0.5).distance == pytest.approx(10)
    assert between(a, b, 0.0).position == pytest.approx(a.position)
    plain = Settings().replace(antialias__method="none")
    first, second = plain, plain.replace(fog__strength=1.0, antialias__method="2x")
    assert blended(first, second, 0.25) is None, "words differ"
    second = plain.replace(fog__strength=1.0)
    assert blended(plain, second, 0.25) == plain.replace(fog__strength=0.25)
    assert blended(plain, second, 1.0) == second
    near, far = Camera((0, 0, 10), fov=4.0), Camera((0, 0, 10), fov=60.0)
    halves = [between(near, far, share).half_height() for share in (0, 0.5, 1)]
    assert halves[1] / halves[0] == pytest.approx(halves[2] / halves[1]), "by equal factors"


def test_pictures_are_mixed_by_what_covers_them():
    a = np.array([[[200, 100, 0, 255], [90, 90, 90, 0]]], np.uint8)
    b = np.array([[[100, 100, 100, 255], [40, 50, 60, 255]]], np.uint8)
    assert mixed(a, b, 0.0).tolist()[0][0] == [200, 100, 0, 255]
    assert mixed(a, b, 0.5).tolist() == [[[150, 100, 50, 255], [40, 50, 60, 128]]]
    assert (mixed(a, b, 1.0) == b).all()


def test_a_look_passes_over_without_a_jump(tmp_path):
    """Occlusion's way, outlines and background change; no step is much larger than the others."""
    document = SceneFile((Input(path="sample:1hpv"),), settings=Settings(size=(48, 36)))
    motion = Motion(document, MovieSettings(motion="none", length=7, to_look="goodsell"))
    film = Film(tmp_path / "frames", motion, {})
    assert len(list(film.draw(Renderer()))) == 7
    frames = np.stack([np.asarray(Image.open(film.frame_path(n)), float) for n in range(7)])
    steps = np.abs(np.diff(frames, axis=0)).mean(axis=(1, 2, 3))
    assert steps.max() < 1.5 * steps.mean()
    other = with_look(document, "goodsell")
    last = Renderer().render(other.scene(), motion.camera(6), steady(other.settings)).pixels
    assert (last == frames[-1]).all()


def test_a_gif_keeps_the_background_and_the_nearest_colors(tmp_path):
    film = tmp_path / "white.gif"
    assert run(["movie", "sample:1hpv", *SMALL, "--length", "2", "-o", str(film)]) == 0
    assert all((page[0, 0] == 255).all() for page in pages(film))
    rng = np.random.default_rng(1)
    frames = [rng.integers(0, 256, (32, 32, 3), np.uint8) for _ in range(2)]
    with open(film, "wb") as file:
        write_gif(file, lambda: iter(frames), 2, 10)
    with Image.open(film) as gif:
        palette = np.array(gif.getpalette(), float).reshape(-1, 3)[:GIF_COLORS]
    best = np.linalg.norm(frames[0][:, :, None] - palette, axis=-1).min(axis=-1)
    assert np.linalg.norm(pages(film)[0] - frames[0].astype(float), axis=-1) == pytest.approx(best)


def test_the_camera_sees_all_frames_of_what_plays(tmp_path):
    """An atom that walks out of the first frame's picture stays in that of the film."""
    path = tmp_path / "walk.pdb"
    line = "ATOM      {}  CA  ALA A   {}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C  \n"
    text = ""
    for n in range(4):
        atoms = line.format(1, 1, 0, 0, 0) + line.format(2, 2, 5 + 10 * n, 0, 0)
        text += f"MODEL     {n + 1:4d}\n{atoms}ENDMDL\n"
    path.write_text(text)
    document = SceneFile((Input(path=str(path)),), settings=Settings(size=(40, 30)))
    motion = Motion(document, MovieSettings(play=True, motion="none"))
    assert motion.length == 31, "ten from model to model"
    for frame in (0, 15, 30):
        moment = motion.at(frame)
        places = project(moment.camera, moment.scene.molecules[0].molecule.positions, (40, 30))
        assert (places[:, :2] > 0).all() and (places[:, :2] < (40, 30)).all()


def test_models_play_in_order(shared):
    md = shared / "molecules" / "md"
    document = SceneFile((Input(path=str(md / "adk.psf.gz")),))
    document = SceneFile(document.input, load=document.load.replace(
        trajectory=str(md / "adk_dims.dcd")))  # fmt: skip
    motion = Motion(document, MovieSettings(play=True, motion="none"))
    first = motion.at(0).scene.molecules[0].molecule.positions
    last = motion.at(motion.length - 1).scene.molecules[0].molecule.positions
    assert motion.length > 50 and np.abs(first - last).max() > 5
    with pytest.raises(SettingsError, match="one model"):
        Motion(SceneFile((Input(path="sample:1hpv"),)), MovieSettings(play=True))


@pytest.mark.parametrize("ending", ["gif", "mp4"])
def test_a_disk_that_fills_while_frames_are_joined_loses_none(tmp_path, ending):
    import resource

    document = SceneFile((Input(path="sample:1hpv"),), settings=Settings(size=(64, 48)))
    film = Film(tmp_path / f"a.{ending}", Motion(document, MovieSettings(length=4)), {})
    assert len(list(film.draw(Renderer()))) == 4
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2048, before[1]))
    try:
        with pytest.raises(SaveError, match="frames are kept in"):
            film.join()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert not film.path.exists() and film.missing == []
    film.join()
    assert film.path.stat().st_size > 2048 and not film.folder.exists()
