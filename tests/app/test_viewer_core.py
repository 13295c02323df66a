"""The viewer without a window: history, camera, pacing, picking, clipping by handles."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from scuro.app.cli import run
from scuro.export.scene_file import Input, SceneFile, Show, read_scene_file
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Cut
from scuro.viewer import navigate
from scuro.viewer.controls import Controls
from scuro.viewer.handles import Handles
from scuro.viewer.model import Model
from scuro.viewer.pacing import SMALLEST, Pacing, moving_size
from scuro.viewer.pick import sentence
from scuro.viewer.refine import coarse, steps
from scuro.viewer.under import surface_at, words_at
from scuro.viewer.view import REST, View

SIZE = (160, 120)


@pytest.fixture
def view(renderer, clock):
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),))
    return View(Model(document), renderer.sibling(), SIZE, clock)


@pytest.fixture
def controls(view):
    made = Controls(view, Handles(view))
    made.logical = SIZE
    return made


def event(kind, x=80.0, y=60.0, button=1, modifiers=(), **more):
    return {
        "event_type": kind, "x": x, "y": y, "button": button, "modifiers": modifiers, **more
    }  # fmt: skip


def rest(view, clock):
    """Let the view come to rest and refine to the end."""
    clock.now += 2 * REST
    for _ in range(1000):
        view.draw()
        if view.wait is None:
            return view.drawn
    raise AssertionError("the picture never comes to rest")


def pixels(view):
    return view.renderer.gpu.read_texture(view.drawn.resources["picture"])


def test_undo_takes_back_a_whole_gesture_and_redo_brings_it_again(view):
    model = view.model
    before = model.settings
    for strength in (1.5, 2.0, 2.5):
        settings = model.settings.replace(occlusion__strength=strength)
        assert model.change("drag", settings=settings)
    model.history.end_gesture()
    model.change(settings=model.settings.replace(background="black"))
    model.undo()
    assert model.settings.occlusion.strength == 2.5 and model.settings.background == "white"
    model.undo()
    assert model.settings == before and not model.history.can_undo
    model.redo()
    model.redo()
    assert model.settings.background == "black" and not model.history.can_redo


def test_a_change_that_cannot_be_leaves_all_as_it_was_and_says_why(view):
    model = view.model
    bodies = model.scene.bodies()
    assert not model.change(show=(Show(select="chain Q and nonsense("),))
    assert model.message and model.document.show == (Show(style="spacefill"),)
    assert model.scene.bodies() == bodies and not model.history.can_undo


def test_all_views_see_a_change_each_with_its_own_camera(view, renderer, clock):
    other = View(view.model, renderer.sibling(), (64, 48), clock)
    rest(view, clock), rest(other, clock)
    eye = other.camera
    view.move(navigate.orbit(view.camera, (30, 0), SIZE))
    assert other.camera == eye and other.wait is None and view.wait == 0.0
    view.model.change(settings=view.model.settings.replace(background="black"))
    assert other.wait == 0.0


def test_a_moving_picture_is_smaller_and_a_resting_one_is_what_render_makes(view, clock, renderer):
    view.move(navigate.orbit(view.camera, (20, 10), SIZE))
    while view.share == 0:  # its pipelines may have to be made
        view.draw()
    assert view.drawn.size == moving_size(SIZE, 0.5)
    assert view.share < 1 and 0 < view.wait <= REST
    drawn = rest(view, clock)
    assert drawn.size == SIZE and view.share == 1
    expected = renderer.render(view.model.scene, view.camera, view.full_settings)
    assert (pixels(view) == expected.pixels).all()


def test_a_picture_that_is_complete_gives_memory_back_once(view, clock, monkeypatch):
    given = []
    monkeypatch.setattr("scuro.viewer.view.give_back", lambda: given.append(view.share))
    for _ in range(2):
        rest(view, clock)
        view.draw()
        view.move(view.camera.orbited(5, 0))
    assert given == [1.0, 1.0]


def test_refinement_multiplies_samples_and_ends_with_the_settings_themselves():
    settings = Settings().replace(occlusion__technique="ray", occlusion__samples=100)
    made = list(steps(settings))
    assert [s.settings.occlusion.samples for s in made] == [4, 16, 100]
    assert [s.share for s in made] == [0.04, 0.16, 1.0] and made[-1].settings == settings
    assert coarse(settings).occlusion.samples == 4
    assert next(steps(Settings())).settings == Settings()


def test_light_over_a_volume_is_coarse_while_something_moves():
    assert Settings().volume.light_resolution == 0.5
    assert coarse(Settings()).volume.light_resolution == 0.25
    assert coarse(Settings().replace(volume__light_resolution=0.1)).volume.light_resolution == 0.1
    assert next(steps(Settings())).settings.volume.light_resolution == 0.5


def test_pacing_holds_the_frame_time_of_a_machine_whose_time_goes_with_pixels():
    for full in (0.02, 0.3, 2.0, 60.0):
        pacing = Pacing(0.1)
        seen = []
        for _ in range(30):
            seen.append(pacing.scale)
            pacing.measured(full * pacing.scale**2)
        took = full * pacing.scale**2
        assert took <= 0.1 or pacing.scale == SMALLEST
        assert took >= 0.05 or pacing.scale == 1.0 or full > 2
        assert len(set(seen[-5:])) == 1, "the resolution flickers"


def test_orbit_keeps_the_target_and_zoom_keeps_the_point_under_the_pointer():
    for height in (None, 12.0):
        camera = Camera((3, 4, 20), (1, 1, 0), (0, 1, 0), 40, height)
        turned = navigate.orbit(camera, (35, -20), SIZE)
        assert turned.target == camera.target
        assert turned.distance == pytest.approx(camera.distance)
        point = navigate.unproject(camera, (130, 30), SIZE, 15)
        assert navigate.project(camera, [point], SIZE)[0] == pytest.approx([130, 30, 15])
        nearer = navigate.zoom(camera, 2.0, point)
        assert navigate.project(nearer, [point], SIZE)[0, :2] == pytest.approx([130, 30])
        assert navigate.pixel_size(nearer, SIZE) < navigate.pixel_size(camera, SIZE)
        moved = navigate.pan(camera, (10, 5), SIZE, 15)
        assert navigate.project(moved, [point], SIZE)[0, :2] == pytest.approx([140, 35])


def test_a_drag_turns_what_is_in_front_with_the_pointer():
    camera = Camera((0, 0, 20), (0, 0, 0))
    front = [(0.0, 0.0, 2.0)]
    x, y, _ = navigate.project(navigate.orbit(camera, (10, 10), SIZE), front, SIZE)[0]
    assert x > 80 and y > 60


def test_axis_views_and_fit(view, clock):
    for axis, column in (("x", 0), ("y", 1), ("z", 2)):
        back = navigate.along_axis(view.camera, axis).view_from_world()[2, :3]
        assert back[column] == pytest.approx(1)
        away = navigate.along_axis(view.camera, axis, opposite=True).view_from_world()[2, :3]
        assert away[column] == pytest.approx(-1)
    view.move(navigate.zoom(view.camera, 30, view.camera.target))
    view.fit()
    rest(view, clock)
    ids = view.renderer.gpu.read_texture(view.drawn.resources["ids"])[..., 2]
    assert (ids[0] == 0xFFFFFFFF).all() and (ids[60] != 0xFFFFFFFF).any()


def test_a_click_names_the_atom_that_the_ids_say_and_shift_adds(view, controls, clock):
    rest(view, clock)
    ids = view.renderer.gpu.read_texture(view.drawn.resources["ids"])
    atom = int(ids[60, 80, 0])
    for kind in ("pointer_down", "pointer_up"):
        controls.handle(event(kind, 80.5, 60.5))
    molecule = view.model.scene.molecules[0].molecule
    found = view.selection[0]
    assert found.element == atom
    words = sentence(found)
    residue = molecule.residue[atom]
    assert molecule.residue_name[residue] in words and str(molecule.atom_name[atom]) in words
    assert np.linalg.norm(found.anchor - found.position) < 2.2, "not on that atom's sphere"
    for kind in ("pointer_down", "pointer_up"):
        controls.handle(event(kind, 90.5, 60.5, modifiers=("Shift",)))
    assert len(view.selection) == 2
    for kind in ("pointer_down", "pointer_up"):
        controls.handle(event(kind, 1, 1))
    assert view.selection == [] and words_at(view, 0.01, 0.01) == ""


def test_double_click_centres_on_the_atom(view, controls, clock):
    rest(view, clock)
    found = surface_at(view, 0.55, 0.45)
    controls.handle(event("double_click", 0.55 * 160, 0.45 * 120))
    assert view.camera.target == pytest.approx(tuple(found.anchor))


def test_drag_pan_and_wheel_move_the_camera(view, controls, clock):
    rest(view, clock)
    cameras = [view.camera]
    for button, modifiers in ((1, ()), (2, ()), (1, ("Control",))):
        controls.handle(event("pointer_down", 80, 60, button, modifiers))
        controls.handle(event("pointer_move", 95, 66, 0))
        controls.handle(event("pointer_up", 95, 66, button))
        cameras.append(view.camera)
    controls.handle(event("wheel", dy=-200.0, dx=0.0))
    cameras.append(view.camera)
    assert len(set(cameras)) == 5
    assert cameras[1].target == cameras[0].target and cameras[2].target != cameras[1].target
    assert cameras[4].distance < cameras[3].distance


def test_keys_turn_undo_and_add_planes(view, controls):
    def press(key, *modifiers):
        controls.handle(event("key_down", key=key, modifiers=modifiers))

    press("x")
    assert view.camera.view_from_world()[2, 0] == pytest.approx(1)
    press("o")
    assert view.camera.orthographic
    press("c")
    assert len(view.model.clip.planes) == 1
    normal = np.array(view.model.clip.planes[0].normal)
    press("v")
    assert (np.array(view.model.clip.planes[0].normal) == -normal).all()
    press("b")
    assert len(view.model.clip.planes) == 7
    assert view.model.document.clipping.cube_rest == "none"
    press("z", "Control")
    press("z", "Control")
    press("z", "Control")
    assert view.model.clip == Clip()
    press("y", "Control")
    assert len(view.model.clip.planes) == 1
    press("Delete")
    assert view.model.clip == Clip()


def test_a_clip_handle_pushes_its_plane_and_one_undo_takes_the_drag_back(view, controls, clock):
    rest(view, clock)
    before = pixels(view).copy()
    target = view.camera.target
    view.model.change(clip=(Cut(normal=(1.0, 0.0, 0.0), point=target),))
    knob = navigate.project(view.camera, [target], SIZE)[0]
    controls.handle(event("pointer_down", knob[0], knob[1]))
    for x in (5, 10, 20):
        controls.handle(event("pointer_move", knob[0] + x, knob[1], 0))
    controls.handle(event("pointer_up", knob[0] + 20, knob[1]))
    plane = view.model.clip.planes[0]
    moved = navigate.project(view.camera, [plane.point], SIZE)[0]
    assert moved[:2] == pytest.approx([knob[0] + 20, knob[1]], abs=0.01)
    rest(view, clock)
    assert (pixels(view) != before).any(axis=-1).mean() > 0.1
    view.model.undo()
    assert view.model.clip.planes[0].point == target
    # the far end of the stalk tilts
    end = next(h for h in controls.handles.all() if h.kind == "tilt")
    place = navigate.project(view.camera, [end.world], SIZE)[0]
    controls.handle(event("pointer_down", place[0], place[1]))
    controls.handle(event("pointer_move", place[0], place[1] - 10, 0))
    controls.handle(event("pointer_up", place[0], place[1] - 10))
    assert view.model.clip.planes[0].equation()[1] > 0.2


def test_a_plane_that_faces_the_eye_rocks_like_a_ball(view, controls, clock):
    rest(view, clock)
    for away in (1.0, -1.0):
        back = view.camera.view_from_world()[2, :3]
        view.model.change(clip=(Cut(normal=tuple(away * back), point=view.camera.target),))
        knob, end = controls.handles.all()
        assert (knob.kind, end.kind) == ("push", "rock")
        a, b = navigate.project(view.camera, [knob.world, end.world], SIZE)[:, :2]
        assert np.hypot(*(b - a)) > 15, "the handles lie on each other"
        (ring,) = controls.handles.rings()
        flat = (ring - np.asarray(view.camera.target)) @ view.model.clip.planes[0].equation()[:3]
        assert abs(flat).max() < 1e-6
        controls.handle(event("pointer_down", b[0], b[1]))
        controls.handle(event("pointer_move", b[0] + 6, b[1], 0))
        controls.handle(event("pointer_up", b[0] + 6, b[1]))
        normal = view.camera.view_from_world()[:3, :3] @ view.model.clip.planes[0].equation()[:3]
        # what is in front goes with the hand, by the angle of a ball of the ring's radius
        assert normal == pytest.approx(away * np.array([np.sin(1 / 3), 0, np.cos(1 / 3)]), abs=1e-3)


def test_the_first_picture_of_another_file_is_small_for_it_may_take_long(view):
    view.pacing.scale = 1.0
    view.model.change(settings=view.model.settings.replace(antialias__method="none"))
    assert view.pacing.scale == 1.0
    view.model.open(SceneFile(input=(Input(path="sample:1tii"),)))
    assert view.pacing.scale == SMALLEST


def test_another_file_is_opened_without_what_was_set_of_the_first(view):
    from scuro.scene.clip import ClippingSettings

    load = view.model.document.load.replace(model="1")
    view.model.change(clipping=ClippingSettings(cube=(5.0, 5.0, 5.0)), load=load)
    settings = view.model.settings.replace(background="black")
    view.model.change(settings=settings)
    assert view.model.open_path("sample:1tii")
    document = view.model.document
    assert document.clipping.cube is None and document.settings == settings
    assert document.load == type(load)()
    view.model.undo()
    assert view.model.document.load == load and view.model.document.clipping.cube == (5, 5, 5)


def test_every_view_stands_before_another_file_and_undo_brings_back_where_it_stood(
    view, renderer, clock, tmp_path
):
    other = View(view.model, renderer.sibling(), (64, 48), clock)
    turned = navigate.orbit(other.camera, (30, 0), SIZE)
    other.move(turned)
    path = tmp_path / "far.xyz"
    path.write_text("2\n\nC 900 0 0\nO 901.5 0 0\n")
    assert view.model.open_path(str(path))
    for one in (view, other):
        x, y, depth = navigate.project(one.camera, [(900.7, 0, 0)], one.size)[0]
        assert depth > 0 and (x, y) == pytest.approx((one.size[0] / 2, one.size[1] / 2), abs=3)
    view.model.undo()
    assert other.camera == turned
    view.model.redo()
    assert other.camera.target[0] > 800
    # also where a view of the same atoms is opened
    saved = view.document()
    there = replace(saved, view=saved.view.replace(target=(900.0, 0.0, 0.0)))
    view.model.open(there)
    assert other.camera.target == pytest.approx((900.0, 0.0, 0.0))


def test_a_file_beside_what_is_shown_is_seen_from_the_same_side_as_render_shows_both(
    view, clock, tmp_path
):
    from scuro.probe.probe import ProbeSettings

    pytest.importorskip("numba", reason="needs the viewer extra")
    model, before = view.model, view.model.document
    path = tmp_path / "beside.xyz"
    path.write_text("2\n\nC 90 0 0\nO 91.5 0 0\n")
    assert model.set_probe(ProbeSettings())
    probe = model.probe
    view.move(navigate.orbit(view.camera, (30, 10), SIZE))
    turned = view.camera
    assert model.open_path(str(path), beside=True)
    assert model.document == replace(before, input=(*before.input, Input(path=str(path))))
    assert len(model.scene.molecules) == 2 and model.probe not in (None, probe)
    side = [np.subtract(c.position, c.target) / c.distance for c in (turned, view.camera)]
    assert np.allclose(*side)
    for atom in ((91.5, 0, 0), tuple(model.scene.molecules[0].molecule.positions[0])):
        x, y, depth = navigate.project(view.camera, [atom], SIZE)[0]
        assert 0 < x < SIZE[0] and 0 < y < SIZE[1] and depth > 0
    output = tmp_path / "render.png"
    model.set_probe(None)
    model.save(tmp_path / "scene.toml", view.document())
    assert run(["render", str(tmp_path / "scene.toml"), "-o", str(output)]) == 0
    rest(view, clock)
    shown = view.renderer.gpu.read_texture(view.drawn.resources["picture"])
    assert (np.asarray(Image.open(output).convert("RGBA")) == shown).all()
    both = view.camera
    model.change(input=model.document.input[1:])
    assert len(model.scene.molecules) == 1 and view.camera == both, "the hand's stance was lost"
    for _ in range(3):
        model.undo()
    assert len(model.scene.molecules) == 1 and view.camera == turned
    assert model.probe is not None and model.document == before


def test_what_cannot_come_beside_is_said_and_changes_nothing(view, tmp_path):
    before = view.model.document
    scene = tmp_path / "scene.toml"
    view.model.save(scene, view.document())
    assert not view.model.open_path(str(scene), beside=True)
    assert "scene of its own" in view.model.message
    view.model.open_path(str(tmp_path / "none.pdb"), beside=True)
    while view.model.restyle is not None:  # it is read beside the pages, however little there is
        view.model.tick()
    assert "none.pdb" in view.model.message and view.model.document == before


def test_the_saved_view_is_the_view(view, controls, clock, tmp_path, renderer):
    for height in (None, 25.0):
        view.move(replace(navigate.orbit(view.camera, (33, 12), SIZE), height=height))
        rest(view, clock)
        view.model.save(tmp_path / "scene.toml", view.document())
        again = read_scene_file(tmp_path / "scene.toml")
        other = View(Model(again), renderer.sibling(), again.settings.size, clock)
        rest(other, clock)
        difference = np.abs(pixels(other).astype(int) - pixels(view))
        if height is None:
            assert not difference.any()
        else:  # an angle stands for the height, and is rounded
            assert (difference > 8).any(axis=-1).mean() < 0.01
