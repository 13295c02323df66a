"""The viewer in time: playing, slow work in slices, undo of all of it, files from the panel."""

from dataclasses import replace
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest

from scuro.app.cli import run
from scuro.export.motion import Motion, MovieSettings
from scuro.export.png import read_settings
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.load.trajectory import open_trajectory
from scuro.probe.probe import ProbeSettings
from scuro.render_settings import Settings
from scuro.scene.clip import Cut
from scuro.scene.geometry import Body, Geometry
from scuro.scene.projection import project
from scuro.scene.scene import Scene
from scuro.steps import in_thread
from scuro.viewer.jobs import Jobs, in_turns
from scuro.viewer.model import Model
from scuro.viewer.player import Player
from scuro.viewer.saving import FilmSettings, Saving
from scuro.viewer.view import REST, View

SIZE = (120, 90)
ATOM = "ATOM      1  CA  ALA A   1    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C  \n"


@pytest.fixture
def three(tmp_path):
    """A file of three models: an atom goes 4 Å along x, then far along y."""
    places = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 60.0, 0.0)]
    path = tmp_path / "three.pdb"
    other = ATOM.replace("ATOM      1  CA  ALA A   1", "ATOM      2  CA  ALA A   2")
    path.write_text(
        "".join(
            f"MODEL     {n + 1:4d}\n{ATOM.format(*p)}{other.format(0, -9, 0)}ENDMDL\n"
            for n, p in enumerate(places)
        )
        + "END\n"
    )
    return path


@pytest.fixture
def model(three, clock):
    made = Model(SceneFile(input=(Input(path=str(three)),), show=(Show(style="spacefill"),)))
    made.player._clock = clock
    return made


def protein(**settings):
    shown = (Show(style="spacefill"),)
    return SceneFile((Input(path="sample:1hpv"),), shown, settings=Settings().replace(**settings))


def first(model):
    return model.scene.molecules[0].molecule.positions[0].tolist()


def rest(view, clock, turns=400):
    clock.now += 2 * REST
    for _ in range(turns):
        view.draw()
        if view.wait is None:
            return view.drawn
    raise AssertionError("the picture never comes to rest")


def pixels(drawn):
    return drawn.gpu.read_texture(drawn.resources["picture"])


# --- playing -------------------------------------------------------------------------------------


def test_between_frames_atoms_go_straight(three):
    trajectory = open_trajectory(three)
    assert trajectory.between(0.25)[0].tolist() == [1.0, 0.0, 0.0]
    assert trajectory.between(1.25)[0].tolist() == [4.0, 15.0, 0.0]
    assert trajectory.at(2).positions[0].tolist() == [4.0, 60.0, 0.0]


def test_playing_goes_on_with_time_loops_and_one_undo_takes_it_back(model, clock):
    player = model.player
    assert player.kind == "frames" and player.length == 3 and player.place == 0
    player.settings = player.settings.replace(speed=2.0)
    player.toggle()
    for passed, expected in ((0.25, 0.5), (0.25, 1.0), (0.5, 2.0), (0.1, 0.0)):
        clock.now += passed
        player.tick()
        assert player.place == pytest.approx(expected)
        assert player.wait == 0.0
    clock.now += 0.125
    player.tick()
    assert first(model) == pytest.approx([1.0, 0, 0])
    player.toggle()
    assert player.wait is None and model.document.load.frame == pytest.approx(0.25)
    model.undo()
    assert first(model) == [0, 0, 0] and model.document.load.frame == 0
    model.redo()
    assert first(model) == pytest.approx([1.0, 0, 0])


def test_the_end_may_turn_back_or_stop_and_steps_are_whole(model, clock):
    player = model.player
    player.settings = player.settings.replace(speed=1.0, smooth=False, loop="swing")
    player.toggle()
    seen = []
    for _ in range(5):
        assert player.wait == pytest.approx(1.0)
        clock.now += 1.0
        player.tick()
        seen.append(player.place)
    assert seen == [1, 2, 1, 0, 1]
    player.settings = player.settings.replace(loop="once")
    for _ in range(3):
        clock.now += 1.0
        player.tick()
    assert player.place == 2 and not player.playing
    player.step(1)
    assert player.place == 0
    player.step(-1)
    assert player.place == 2 and model.history.can_undo


def test_keys_of_time_do_nothing_where_there_is_none():
    for scene in (Scene(), None):
        document = SceneFile(input=(Input("sample:1hpv"),)) if scene is None else SceneFile()
        model = Model(document, scene)
        before = model.document
        for go in (lambda p: p.step(1), lambda p: p.step(-1), lambda p: p.seek(3), Player.toggle):
            go(model.player)
        assert model.document == before and not model.player.playing


def test_a_view_fits_all_frames_as_films_do(model, renderer, three, clock):
    view = View(model, renderer.sibling(), SIZE, clock)

    def highest():
        return project(view.camera, [(4.0, 60.0, 0.0)], SIZE)[0, 1]

    # the last frame's atom, far above those of the first, is in the picture from the start
    assert 0 < highest() < 30
    movie = MovieSettings(play=True, motion="none", length=3)
    document = replace(model.document, settings=Settings(size=SIZE))
    filmed = Motion(document, movie).at(0).camera
    assert np.allclose(view.camera.position, filmed.position)
    view.move(view.camera.orbited(90.0, 0.0))
    model.player.seek(1.0)
    view.fit()
    assert 0 < highest() < 30
    assert model.player.place == 1.0 and first(model) == [4.0, 0, 0]
    # what is hidden in all frames needs no room
    model.change(show=(Show(style="spacefill", select="resi 2"),))
    view.fit()
    assert highest() < -30


def test_a_film_frame_and_a_rendered_frame_are_where_the_player_is(model, tmp_path):
    model.player.seek(0.5)
    scene = tmp_path / "scene.toml"
    model.save(scene)
    from scuro.export.scene_file import read_scene_file

    again = read_scene_file(scene).scene()
    assert again.molecules[0].molecule.positions[0].tolist() == [2.0, 0, 0]
    one = Model(SceneFile(input=(Input(path="sample:1hpv"),)))
    assert one.player.length == 0 and one.player.kind == ""


def test_the_probe_gets_out_of_the_way_of_moving_atoms(model):
    pytest.importorskip("numba", reason="needs the viewer extra")
    assert model.set_probe(ProbeSettings(), (4.0, 0.0, 0.0))
    model.player.seek(1.0)
    assert model.probe.constraint.depth(model.probe.position) < 0


# --- what takes long -----------------------------------------------------------------------------


def test_occlusion_is_baked_in_slices_behind_a_plain_picture(renderer, clock, monkeypatch):
    monkeypatch.setattr(type(renderer), "patience", 0.0)
    model = Model(protein())
    view = View(model, renderer.sibling(), SIZE, clock)
    rest(view, clock)
    settings = model.settings.replace(occlusion__technique="baked", occlusion__baked__directions=64)
    model.change(settings=settings)
    shares = []
    while view.wait == 0.0 and len(shares) < 50:
        view.draw()
        if view.built is None:
            break
        shares.append(view.built)
        assert view.drawn.settings.occlusion.technique == "none", "the window waited for it"
        assert view.status.startswith(("building", "compiling"))
    assert len(shares) >= 4 and shares == sorted(shares)
    expected = renderer.render(model.dressed(view.camera), view.camera, view.full_settings)
    assert (pixels(rest(view, clock)) == expected.pixels).all()
    # another view of the scene finds it built
    other = View(model, renderer.sibling(), SIZE, clock)
    other.draw()
    assert other.built is None


def test_what_is_being_built_can_be_cancelled(renderer, clock, monkeypatch):
    model = Model(protein(occlusion__technique="baked", occlusion__baked__directions=66))
    view = View(model, renderer.sibling(), SIZE, clock)
    renderer.accelerator(model.dressed(view.camera))
    monkeypatch.setattr(type(renderer), "patience", 0.0)
    view.draw()
    assert view.built is not None
    view.stop()
    assert rest(view, clock).settings.occlusion.technique == "none"
    assert view.status == "effects left out" and view.complete
    model.change(settings=model.settings.replace(background="black"))
    assert view.wait == 0.0
    view.draw()
    assert view.built is not None


def test_refining_can_be_stopped_and_goes_on_after_a_change(renderer, clock):
    model = Model(protein(renderer="path", path__samples=40))
    view = View(model, renderer.sibling(), (48, 36), clock)
    clock.now += 2 * REST
    while view.share == 0:  # its pipelines may have to be made
        view.draw()
    view.draw()
    assert 0 < view.share < 1
    view.stop()
    assert view.wait is None and view.status.startswith("stopped at")
    model.change(settings=model.settings.replace(background="black"))
    assert view.wait == 0.0 and not view.stopped


def test_a_volumes_pyramid_is_built_in_slices_and_is_the_same(renderer):
    from scuro.passes.volume.classify import Classified
    from scuro.passes.volume.grid import VolumeGrid
    from scuro.passes.volume.pyramid import Pyramid
    from scuro.scene.clip import Clip
    from scuro.scene.volume import Volume
    from scuro.style.transfer_choose import choose_transfer

    values = np.random.default_rng(1).random((20, 24, 28), np.float32)
    volume, center = Volume(values), np.zeros(3)
    grid = VolumeGrid(renderer.gpu, volume, center)
    classified = Classified(grid, choose_transfer(volume))
    uniform = grid.uniform(0.5, Clip(), center, classified.table_end)
    whole = Pyramid(classified, uniform)
    sliced = Pyramid(classified, uniform, build=False)
    shares = list(sliced.build(1 << 14))
    assert len(shares) > 6 and shares == sorted(shares) and shares[-1] == pytest.approx(1)
    read = renderer.gpu.read_texture
    assert (read(whole.texture) == read(sliced.texture)).all()


def test_jobs_do_a_slice_at_a_time_and_leave_nothing_when_cancelled():
    jobs, seen = Jobs(), []

    def work(name):
        try:
            for n in range(3):
                seen.append((name, n))
                yield n / 3
            return f"{name} done"
        finally:
            seen.append((name, "end"))

    jobs.add("a", work("a"))
    jobs.add("b", work("b"))
    assert jobs.wait == 0.0
    jobs.tick()
    jobs.cancel(jobs.waiting[0])
    for _ in range(9):
        jobs.tick()
    assert seen == [("a", 0), ("a", "end"), ("b", 0), ("b", 1), ("b", 2), ("b", "end")]
    assert jobs.message == "b done" and jobs.wait is None

    def wait():
        made = yield from in_thread(lambda: 6 * 7)
        return str(made)

    jobs.add("c", wait())
    while jobs.wait is not None:
        jobs.tick()
    assert jobs.message == "42"


def test_random_hands_neither_fail_nor_leave_work_behind(renderer):
    pytest.importorskip("imgui_bundle", reason="needs the viewer extra")
    pytest.importorskip("psutil", reason="needs the viewer extra")
    from scuro.measure.soak import soak
    from scuro.viewer.screen import Screen

    model = Model(protein())
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: name)
    screen.resize(700.0, 300.0, 1.0)
    for seconds in (2.0, 8.0, 32.0):  # a busy machine takes longer to put all back as it was
        done = soak(screen, seconds, seed=3, warm=False)
        if done.events > 10:
            break
    assert done.events > 10 and done.rounds and screen.wait is None
    assert model.document.show == protein().show and model.probe is None
    screen.close()


# --- undo of everything, and files ---------------------------------------------------------------


def test_undo_takes_back_probe_clipping_and_cube(renderer, clock):
    pytest.importorskip("numba", reason="needs the viewer extra")
    model = Model(protein())
    model.set_probe(ProbeSettings())
    model.change(probe=ProbeSettings(radius=2.0))
    assert model.probe.constraint.probe == 2.0
    model.change(clip=(Cut(normal=(1.0, 0, 0)),))
    model.change(clipping=model.document.clipping.replace(cube=(9.0, 8.0, 7.0)))
    assert len(model.clip.planes) == 7
    model.undo()
    assert len(model.clip.planes) == 1
    model.undo()
    assert not model.clip.planes
    model.undo()
    assert model.probe.constraint.probe == 1.4
    model.undo()
    assert model.probe is None and not model.history.can_undo
    for _ in range(4):
        model.redo()
    assert model.probe.constraint.probe == 2.0 and len(model.clip.planes) == 7


@pytest.fixture
def saving(renderer, clock, tmp_path):
    pytest.importorskip("numba", reason="needs the viewer extra")
    model = Model(protein(lighting__preset="simple", depth_of_field__blur=2.0))
    view = View(model, renderer.sibling(), SIZE, clock)
    model.change(clip=(Cut(normal=(0.3, 0, 1.0), point=view.camera.target),))
    model.set_probe(ProbeSettings(clip=True), view.camera.target)
    view.move(view.camera.orbited(31.0, 12.0))

    def deliver(name, write):
        write(tmp_path / name)
        return f"saved {name}"

    return Saving(view, Jobs(), deliver)


def finish(jobs):
    while jobs.wait is not None:
        jobs.tick()
    return jobs.message


def test_a_saved_picture_is_what_is_shown_and_what_render_makes_of_it(saving, clock, tmp_path):
    from PIL import Image

    saving.picture()
    saving.scene()
    assert finish(saving._jobs) == "saved scuro.png"
    saved = np.asarray(Image.open(tmp_path / "scuro.png").convert("RGBA"))
    assert (pixels(rest(saving.view, clock)) == saved).all()
    assert saved[..., :3].std() > 20
    assert read_settings(tmp_path / "scuro.png")["light"], "the probe's light is not in the file"
    for source in ("scene.toml", "scuro.png"):
        assert run(["render", str(tmp_path / source), "-o", str(tmp_path / "again.png")]) == 0
        again = np.asarray(Image.open(tmp_path / "again.png").convert("RGBA"))
        assert (again == saved).all(), source


def read_pixels(path):
    """The channels of an OpenEXR file by name, or the one array of another picture."""
    if path.suffix == ".exr":
        import OpenEXR

        with OpenEXR.File(str(path), separate_channels=True) as read:
            return {name: np.array(c.pixels) for name, c in read.channels().items()}
    if path.suffix == ".png":
        import imageio.v3

        return {"": np.asarray(imageio.v3.imread(path))}
    import tifffile

    return {"": tifffile.imread(path)}


@pytest.mark.parametrize("name", ["deep.tif", "layers.exr", "deep.png"])
def test_deep_pictures_and_layers_are_those_of_the_command_line(saving, tmp_path, name):
    saving.picture_settings = saving.picture_settings.replace(name=name, bits="16")
    saving.picture()
    saving.scene()
    assert finish(saving._jobs) == f"saved {name}"
    bits = [] if name.endswith(".exr") else ["--bits", "16"]
    again = tmp_path / f"again{Path(name).suffix}"
    assert run(["render", str(tmp_path / "scene.toml"), "-o", str(again), *bits]) == 0
    saved, made = read_pixels(tmp_path / name), read_pixels(again)
    assert set(saved) == set(made) and len(saved) >= 1
    for layer, values in made.items():
        assert np.array_equal(saved[layer], values), layer
    assert any(values.std() > 0 for values in saved.values())


@pytest.mark.parametrize("elsewhere", [False, True])
def test_deep_pictures_name_their_file_as_seen_from_where_they_lie(
    renderer, tmp_path, monkeypatch, elsewhere
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.xyz").write_text("2\n\nC 0 0 0\nO 0 0 1.2\n")
    settings = Settings().replace(occlusion__technique="none")
    document = SceneFile(input=(Input(path=str(tmp_path / "two.xyz")),), settings=settings)
    view = View(Model(document), renderer.sibling(), (60, 40))

    def deliver(name, write):
        write(tmp_path / name)
        return f"saved {name}"

    saving = Saving(view, Jobs(), deliver, elsewhere)
    saving.picture_settings = saving.picture_settings.replace(name="deep.png", bits="16")
    saving.picture()
    assert finish(saving._jobs) == "saved deep.png"
    # a page's picture may land in any folder: it names the file as the server was told
    wanted = str(tmp_path / "two.xyz") if elsewhere else "two.xyz"
    assert read_settings(tmp_path / "deep.png")["input"][0]["path"] == wanted


def test_pictures_in_parts_can_be_stopped_between_them():
    turns, ended = [], []

    def action(pause):
        try:
            for number in range(100):
                turns.append(number)
                pause(number / 100)
        finally:
            ended.append(True)
        return "whole"

    jobs = Jobs()
    jobs.add("picture", in_turns(action))
    for _ in range(4):
        jobs.tick()
    assert turns == [0, 1, 2] and jobs.waiting[0].share == 0.02
    jobs.cancel(jobs.waiting[0])
    assert ended and turns == [0, 1, 2]
    jobs.add("picture", in_turns(action))
    while jobs.waiting:
        jobs.tick()
    assert jobs.message == "whole" and len(turns) == 103


def test_a_film_from_the_panel_is_that_of_the_command_line(saving, tmp_path):
    saving.film_settings = FilmSettings(name="film.gif")
    saving.movie = saving.movie.replace(length=3, motion="rock")
    saving.film()
    saving.scene()
    assert finish(saving._jobs) == "saved film.gif"
    command = ["movie", str(tmp_path / "scene.toml"), "--length", "3", "--motion", "rock"]
    assert run([*command, "-o", str(tmp_path / "again.gif")]) == 0
    assert (tmp_path / "film.gif").read_bytes() == (tmp_path / "again.gif").read_bytes()


@pytest.mark.parametrize("elsewhere", [False, True])
def test_numbered_frames_from_the_panel_are_those_of_the_command_line(saving, tmp_path, elsewhere):
    saving._elsewhere = elsewhere
    saving.film_settings = FilmSettings(name="frames")
    saving.movie = saving.movie.replace(length=3, motion="rock")
    saving.film()
    saving.scene()
    assert finish(saving._jobs) == ("saved frames.zip" if elsewhere else "saved frames")
    command = ["movie", str(tmp_path / "scene.toml"), "--length", "3", "--motion", "rock"]
    assert run([*command, "-o", str(tmp_path / "again")]) == 0
    again = {path.name: path.read_bytes() for path in (tmp_path / "again").iterdir()}
    assert sorted(again) == ["000000.png", "000001.png", "000002.png"]
    if elsewhere:
        with ZipFile(tmp_path / "frames.zip") as packed:
            assert {Path(n).parent.name for n in packed.namelist()} == {"frames"}
            found = {Path(n).name: packed.read(n) for n in packed.namelist()}
    else:
        found = {path.name: path.read_bytes() for path in (tmp_path / "frames").iterdir()}
    assert found == again
    assert not list(tmp_path.glob(".*"))


def test_saving_says_what_it_cannot_do(saving):
    for name, words in (("picture.bmp", "bmp"), ("../.hidden", "no name of a file")):
        saving.picture_settings = saving.picture_settings.replace(name=name)
        saving.picture()
        assert words in finish(saving._jobs)
    saving.picture_settings = saving.picture_settings.replace(name="a.png")
    saving.picture()
    saving._jobs.tick()
    saving.view.model.change(settings=saving.view.model.settings.replace(background="black"))
    assert "changed meanwhile" in finish(saving._jobs)


# --- slice planes --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ramp():
    """A volume whose values are 10 x + y of the voxel, in a scene seen along -z."""
    from scuro.scene.scene import Scene
    from scuro.scene.volume import Volume

    values = np.tile(np.arange(24)[:, None] + 10 * np.arange(24), (24, 1, 1)).astype(np.float32)
    return Scene().add(Volume(values))


def test_a_slice_plane_shows_the_colour_of_each_value_where_it_lies(renderer, ramp):
    from scuro.scene.view import ViewSettings, view_camera
    from scuro.style.transfer_choose import choose_transfer
    from scuro.viewer import navigate
    from scuro.viewer.voxel import voxel_at

    settings = Settings(size=(96, 96)).replace(
        volume__planes__z=0.5, volume__transfer="gray", antialias__method="none"
    )
    camera = view_camera(ramp, ViewSettings(orthographic=True), 1.0)
    picture = renderer.render(ramp, camera, settings).pixels
    item = ramp.volumes[0]
    transfer = choose_transfer(item.volume, "gray")
    checked = 0
    for x in range(20, 76, 5):
        for y in range(20, 76, 5):
            pixel = (x + 0.5, y + 0.5)
            found = voxel_at(item, settings.volume, ramp.clip, camera, pixel, (96, 96))
            (i, j, k), value, depth = found
            assert k in (11, 12)
            place = navigate.unproject(camera, pixel, (96, 96), depth)
            at = np.linalg.inv(item.volume.world_from_index) @ np.append(place, 1)
            assert at[2] == pytest.approx(11.5) and abs(at[0] - i) <= 0.5 and abs(at[1] - j) <= 0.5
            exact = 10 * at[0] + at[1]
            expected = transfer.color(np.array([exact]))[0] * 255
            assert np.abs(picture[y, x, :3] - expected).max() <= 3
            checked += 1
    assert checked > 100 and value == 10 * i + j


def test_slice_planes_hide_what_is_behind_and_heed_clipping(renderer, ramp):
    from scuro.scene.clip import Clip, Plane
    from scuro.scene.view import ViewSettings, view_camera

    base = Settings(size=(64, 64)).replace(volume__transfer="viridis")
    camera = view_camera(ramp, ViewSettings(azimuth=20, elevation=20), 1.0)

    def covered(**changes):
        return renderer.render(ramp, camera, base.replace(**changes)).pixels

    alone = covered(volume__planes__z=0.25)
    within = covered(volume__planes__z=0.25, volume__planes__alone=False)
    volume = covered()
    assert (alone != within).any() and (within != volume).any()
    whole = (alone != 255).any(axis=-1).sum()
    before = ramp.clip
    middle = ramp.bounds().mean(axis=0)
    ramp.clip = replace(Clip(), planes=(Plane(tuple(middle.tolist()), (1.0, 0, 0)),))
    try:
        half = (covered(volume__planes__z=0.25) != 255).any(axis=-1).sum()
    finally:
        ramp.clip = before
    assert 0.35 * whole < half < 0.65 * whole


# --- cells of a reservoir ------------------------------------------------------------------------


def test_a_selected_cell_is_named_by_its_place_in_the_grid():
    from scuro.scene.cornerpoint_synthetic import faulted_dome
    from scuro.viewer.pick import Pick, sentence

    scene = Scene().add(faulted_dome(12, 10, 6))
    item, part, body = next(o for o in scene.owners() if o[2].name.endswith("cells"))
    found = Pick(item, body, 0, part, (3 * 10 + 4) * 12 + 5, (0.0, 0.0, 0.0))
    assert sentence(found).endswith("cells 6, 5, 4")


@pytest.mark.parametrize("show", ["volume", "cells"])
def test_the_cell_under_the_pointer_is_the_first_that_is_shown(show):
    from scuro.scene.camera import Camera
    from scuro.scene.clip import Clip, Plane
    from scuro.scene.cornerpoint_synthetic import faulted_dome
    from scuro.scene.reservoir import ReservoirItem
    from scuro.style.reservoir_options import ReservoirSettings
    from scuro.viewer import navigate
    from scuro.viewer.cell import cell_at, cell_sentence

    grid = faulted_dome(12, 12, 6)
    settings = ReservoirSettings(show=show, property="PORO", opacity="0:1 1:1")
    item = ReservoirItem(grid, settings)
    cells = np.flatnonzero(grid.active)
    centers = grid.to_world(grid.corners(cells), item.exaggeration).reshape(-1, 8, 3).mean(axis=1)
    low, high = item.bounds
    middle, size = (low + high) / 2, (400, 300)
    top = middle.copy()
    top[2] += 3 * float(np.linalg.norm(high - low))
    camera = Camera(tuple(top), tuple(middle), (0, 1, 0), 30)
    columns = cells % (12 * 12)
    checked = 0
    for column in np.unique(columns)[::7]:
        above = np.flatnonzero(columns == column)[0]  # the uppermost active cell
        pixel = tuple(navigate.project(camera, [centers[above]], size)[0, :2])
        (i, j, k), value, depth = cell_at(item, Clip(), camera, pixel, size)
        expected = np.unravel_index(cells[above], grid.active.shape)
        # a slanting ray may pass the edge of a higher neighbour
        if (k - 1, j - 1, i - 1) == tuple(map(int, expected)):
            assert value == pytest.approx(float(item.values()[above]))
            assert depth < float(camera.distance) + float(np.ptp(item.bounds, axis=0)[2])
            assert f"cell {i}, {j}, {k}" in cell_sentence(item, (i, j, k), value)
            checked += 1
    assert checked >= 6
    # a plane through the third cell of a column takes those above away
    third = np.flatnonzero(columns == np.unique(columns)[60])[2]
    plane = Plane(tuple(centers[third].tolist()), (0.0, 0.0, -1.0))
    pixel = tuple(navigate.project(camera, [centers[third]], size)[0, :2])
    (i, j, k), _, depth = cell_at(item, Clip((plane,)), camera, pixel, size)
    assert (k - 1, j - 1, i - 1) == np.unravel_index(cells[third], grid.active.shape)
    assert depth == pytest.approx(float(top[2] - centers[third][2]), rel=1e-6)
    assert cell_at(item, Clip(), camera, pixel, size)[2] < depth
    assert cell_at(item, Clip(), camera, (1, 1), size) is None


def balls(count):
    """Many spheres: building their tables takes many steps."""
    rng = np.random.default_rng(count)
    spheres = np.float32(
        np.hstack([rng.random((count, 3)) * count ** (1 / 3), np.ones((count, 1))])
    )
    geometry = Geometry(spheres, np.full((count, 4), 200, np.uint8), np.arange(count, dtype="i4"))
    return Body(geometry)


def built_slowly(renderer, clock, monkeypatch):
    """A view of some spheres, whose scene is then replaced by others; every step is seen."""
    monkeypatch.setattr(type(renderer), "patience", 0.0)
    model = Model(SceneFile(settings=Settings(background="white")), Scene())
    model.scene.extra_bodies = [balls(50)]
    view = View(model, renderer.sibling(), SIZE, clock)
    rest(view, clock)
    model.scene.extra_bodies = [balls(3000)]
    model.tell()
    return view


def test_what_is_traced_is_built_in_steps_behind_the_picture_before(renderer, clock, monkeypatch):
    view = built_slowly(renderer, clock, monkeypatch)
    before, shares = view.drawn, []
    for _ in range(500):
        view.draw()
        if view.drawable:
            break
        assert view.drawn is before
        shares.append(view.built)
    assert len(shares) > 10 and shares == sorted(shares)
    expected = renderer.render(view.model.scene, view.camera, view.full_settings)
    assert (pixels(rest(view, clock)) == expected.pixels).all()


def test_building_what_is_traced_can_be_cancelled(renderer, clock, monkeypatch):
    view = built_slowly(renderer, clock, monkeypatch)
    before = view.drawn
    view.draw()
    view.stop()
    assert view.complete and view.wait is None and view.draw() is before
    assert view.status == "stopped before it was built"
    view.move(view.camera.orbited(20, 0))
    assert view.wait == 0.0 and view.status.startswith("refining")
    view.draw()
    assert view.status.startswith("building")
    assert rest(view, clock) is not before and view.share == 1
