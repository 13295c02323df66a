"""What a screen of any size shows: sharp or small ones, two pictures side by side, and words."""

import numpy as np
import pytest

from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render_names import SMALLEST_TEXT, text_size
from scuro.render_settings import Settings
from scuro.settings import parameters
from scuro.viewer.model import Model
from scuro.viewer.panel.panel import _WARNING
from scuro.viewer.playbar import foot, room
from scuro.viewer.view import REST

pytest.importorskip("imgui_bundle", reason="needs the viewer extra")


def screen_of(renderer, size, ratio=1.0, **changes):
    from scuro.viewer.screen import Screen

    document = SceneFile(
        input=(Input(path="sample:1hpv"),),
        show=(Show(style="spacefill"),),
        settings=Settings().replace(occlusion__technique="none", **changes),
    )
    screen = Screen(Model(document), renderer, "rgba8unorm", lambda name, write: name)
    screen.resize(*size, ratio)
    return screen


def rest(screen):
    """The screen's pixels when it is complete."""
    screen.view._moved -= 2 * REST
    target = screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    for _ in range(40):
        screen.draw(target)
        if screen.view.complete and not screen.view.moving and not screen.gui._fresh:
            break
    return screen.gpu.read_texture(target)[..., :3]


def move(screen, x, y):
    screen.handle({"event_type": "pointer_move", "x": x, "y": y, "button": 0, "modifiers": ()})


def test_on_a_narrow_screen_the_panel_waits_folded(renderer):
    for width, open in ((480.0, False), (900.0, True)):
        screen = screen_of(renderer, (width, 320.0))
        assert screen.panel.open == open
        # afterwards it is as a person left it
        screen.panel.open = not open
        screen.resize(width, 330.0, 1.0)
        assert screen.panel.open != open
        screen.close()


def test_letters_on_a_sharp_screen_are_no_smaller_than_on_others(renderer):
    screen = screen_of(renderer, (400.0, 300.0), 2.0)
    settings = screen.view.full_settings
    assert settings.size[1] == 600 and text_size(settings) == 2 * SMALLEST_TEXT
    # and a picture saved at a scale has them as large as its screen
    document = screen.panel.saving._sized(3.0, 16384)
    assert text_size(document.settings) == 6 * SMALLEST_TEXT
    screen.resize(400.0, 300.0, 1.0)
    assert screen.view.full_settings.text is None
    screen.close()


def test_two_pictures_side_by_side_fill_a_screen_of_an_odd_width(renderer):
    screen = screen_of(renderer, (421.0, 240.0), stereo__mode="side-by-side")
    shown = rest(screen)
    assert screen.view.error == "" and screen.view.drawn.settings.size == (420, 240)
    assert shown[:, :420].std() > 10
    screen.close()


def test_why_nothing_can_be_drawn_is_said_until_it_can(renderer):
    screen = screen_of(renderer, (300.0, 200.0))
    model = screen.model
    rest(screen)
    model.change(settings=model.settings.replace(attention__subtree="chain ("))
    rest(screen)
    assert "attention" in screen.view.error
    rest(screen)
    assert "attention" in screen.view.error
    model.undo()
    rest(screen)
    assert screen.view.error == ""
    screen.close()


def test_words_under_a_pointer_at_rest_change_with_the_scene(renderer, monkeypatch):
    screen = screen_of(renderer, (300.0, 200.0))
    rest(screen)
    move(screen, 150.0, 100.0)
    rest(screen)
    before = screen._hover
    assert "chain" in before
    asked = []
    monkeypatch.setattr(
        "scuro.viewer.screen.words_at", lambda view, x, y: asked.append((x, y)) or "another"
    )
    screen.model.change(show=(Show(style="cartoon"),))
    rest(screen)
    assert screen._hover == "another" and len(asked) >= 1
    screen.close()


@pytest.mark.parametrize("width", [360, 420, 480, 600, 700, 1200])
def test_the_play_bar_lies_beside_or_above_what_the_corners_hold(width):
    size = (width, 320)
    wide = min(640, max(260, width - 380))
    left, right = (width - wide) / 2, (width + wide) / 2
    # the axis cross, and the longest scale bar with its number
    assert left >= 90 or foot(size) >= 90
    assert right <= width - 140 or foot(size) >= 42
    assert room(size) > foot(size)


def test_a_click_that_comes_between_two_pictures_reaches_the_panel(renderer):
    screen = screen_of(renderer, (900.0, 320.0))
    rest(screen)
    fold = {"x": 900.0 - 330.0 + 210.0, "y": 19.0, "button": 1, "modifiers": ()}
    for kind in ("pointer_move", "pointer_down", "pointer_up"):
        screen.handle({"event_type": kind, **fold})
        assert not screen.controls.dragging, "the press went to the scene"
    rest(screen)
    assert not screen.panel.open
    screen.close()


@pytest.mark.parametrize("height", [None, 20.0])
def test_fitting_leaves_room_for_the_play_bar(renderer, height):
    from dataclasses import replace

    from scuro.scene.points import scene_points
    from scuro.viewer import navigate

    screen = screen_of(renderer, (480.0, 320.0))
    view, points = screen.view, scene_points(screen.model.scene)[:, :3]
    view.camera = replace(view.camera, height=height)
    for below in (0.0, room((480.0, 320.0)) / 320):
        view.foot = below
        view.fit()
        y = navigate.project(view.camera, points, (480.0, 320.0))[:, 1]
        assert y.min() > 0 and y.max() < 320 * (1 - below)
        assert y.max() - y.min() > 0.75 * 320 * (1 - below), "smaller than it need be"
    screen.close()


def test_a_panel_over_the_picture_leaves_the_bars_at_its_foot(renderer):
    screen = screen_of(renderer, (480.0, 320.0))
    before = rest(screen)
    screen.panel.open = True
    after = rest(screen)
    bar = (slice(280, 308), slice(340, 465))
    assert (before[bar] < 60).all(axis=-1).any(), "no scale bar: this shows nothing"
    assert (before[bar] == after[bar]).all()
    assert (before[:240, 200:470] != after[:240, 200:470]).any(axis=-1).mean() > 0.8
    screen.close()


@pytest.mark.parametrize("height", [None, 30.0])
def test_side_by_side_shows_all_that_was_seen_and_one_eye_as_it_was(renderer, height):
    from dataclasses import replace

    from scuro.scene.points import scene_points

    screen = screen_of(renderer, (560.0, 400.0))
    view, model = screen.view, screen.model
    points = scene_points(model.scene)[:, :3]
    view.camera = replace(view.camera, height=height)
    view.fit()
    before = view.camera
    model.change(settings=model.settings.replace(stereo__mode="side-by-side"))
    rest(screen)
    for eye in view.eyes((560.0, 400.0)):
        x = eye.project(points)[:, 0] - eye.start
        assert x.min() > 0 and x.max() < 280 and np.ptp(x) > 190
    model.undo()
    assert view.camera.position == pytest.approx(before.position)
    assert view.camera.height == pytest.approx(before.height)
    model.change(settings=model.settings.replace(stereo__mode="red-cyan"))
    assert view.camera.position == pytest.approx(before.position), "as wide as for one eye"
    screen.close()


class Canvas:
    """As rendercanvas has them, with textures of ours."""

    def __init__(self, gpu, size):
        self.gpu, self.size, self.ratio = gpu, size, 1.0
        self.draw, self.asked, self.handlers = None, 0, []

    def get_wgpu_context(self):
        return self

    def get_preferred_format(self, adapter):
        return "rgba8unorm-srgb"

    def configure(self, *, device, format):
        self.format = format

    def get_logical_size(self):
        return self.size

    def get_pixel_ratio(self):
        return self.ratio

    def get_current_texture(self):
        physical = tuple(round(self.ratio * s) for s in self.size)
        self.texture = self.gpu.texture(physical, self.format, attachment=True)
        return self.texture

    def add_event_handler(self, handler, *kinds):
        self.handlers.append((handler, kinds))

    def request_draw(self, draw=None):
        self.draw, self.asked = draw or self.draw, self.asked + 1


class Loop:
    def call_later(self, wait, act):
        pass


def test_a_window_that_is_taken_to_a_sharper_display_is_drawn_anew_at_its_pixels(renderer):
    from scuro.viewer.window import attach

    canvas = Canvas(renderer.gpu, (300.0, 200.0))
    document = SceneFile(
        input=(Input(path="sample:1hpv"),), settings=Settings().replace(occlusion__technique="none")
    )
    screen = attach(canvas, Loop(), Model(document), renderer)
    assert canvas.format == "rgba8unorm", "colours would be encoded twice"
    canvas.draw()
    assert (screen.physical, screen.view.ratio) == ((300, 200), 1.0)
    canvas.ratio = 2.0  # its logical size stays, and no event tells
    canvas.draw()
    assert (screen.physical, screen.view.ratio) == ((600, 400), 2.0)
    assert screen.view.size == (600, 400) and screen.controls.logical == (300.0, 200.0)
    screen.view._moved -= 2 * REST
    asked = canvas.asked
    for _ in range(40):
        canvas.draw()
        if screen.view.complete:
            break
    assert screen.view.drawn.size == (600, 400) and canvas.asked > asked
    # a click means the pixels twice as far from the corner
    shown = renderer.gpu.read_texture(canvas.texture)[..., :3]
    (handler, kinds), *_ = canvas.handlers
    assert {"pointer_down", "pointer_up"} <= set(kinds)
    for kind in ("pointer_down", "pointer_up"):
        handler({"event_type": kind, "x": 150.0, "y": 100.0, "button": 1, "modifiers": ()})
    (found,) = screen.view.selection
    assert np.abs(shown[200, 300].astype(int) - 255).max() > 20, "nothing is there"
    x, y, _ = screen.view.eyes((600.0, 400.0))[0].project([found.position])[0]
    assert (x, y) == pytest.approx((300.5, 200.5), abs=0.6)
    screen.close()


def test_what_is_off_is_switched_on_and_units_are_told_of_rows_of_numbers(renderer, monkeypatch):
    from imgui_bundle import imgui

    from scuro.passes.volume.planes import PlaneSettings
    from scuro.scene.clip import ClippingSettings
    from scuro.viewer.panel.fields import Fields

    by_name = {p.name: p for p in (*parameters(PlaneSettings), *parameters(ClippingSettings))}
    assert by_name["x"].switch and by_name["cube"].switch and not by_name["cube_center"].switch
    screen = screen_of(renderer, (900.0, 320.0))
    ticked, written = [], []

    def checkbox(title, value):
        ticked.append((title, value))
        return False, value

    monkeypatch.setattr(imgui, "checkbox", checkbox)
    monkeypatch.setattr(imgui, "text", written.append)
    fields, seen = Fields(), []
    monkeypatch.setattr(
        screen.panel,
        "draw",
        lambda size: seen.extend(
            fields.edit(name, by_name[name], value)
            for name, value in (("x", None), ("x", 0.5), ("cube", (3.0, 4.0, 5.0)),
                                ("cube_center", None))
        ),
    )  # fmt: skip
    screen.draw(screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True))
    assert [tick[0] for tick in ticked] == ["##on", "##on", "##on", "auto##auto"]
    assert [tick[1] for tick in ticked] == [False, True, True, True]
    assert seen == [(False, None), (False, 0.5), (False, (3.0, 4.0, 5.0)), (False, None)]
    assert written == ["x", "cube (Å)", "cube center"]
    screen.close()


@pytest.mark.parametrize("background", ["white", "black", "#445566", "transparent"])
def test_bar_and_axes_stand_out_on_every_background(renderer, background):
    screen = screen_of(renderer, (480.0, 320.0), background=background)
    shown = rest(screen).astype(int)
    ground = shown[3, 3]
    bar = shown[300:303, 440]
    assert np.abs(bar - ground).max(axis=-1).min() > 90, "the bar"
    text = shown[278:297, 340:440]
    assert (np.abs(text - ground).max(axis=-1) > 90).sum() > 30, "its length"
    # around the axes the disc is as the background, not a blot on it
    assert np.abs(shown[320 - 50, 50 - 35] - ground).max() < 140
    screen.close()


def test_the_panel_tells_lengths_in_the_scenes_unit_and_leaves_out_what_it_has_not(
    renderer, monkeypatch
):
    from imgui_bundle import imgui

    from scuro.scene.scene import Scene
    from scuro.scene.volume import Volume
    from scuro.viewer.screen import Screen

    model = Model(SceneFile(), Scene().add(Volume(np.zeros((8, 8, 8), np.float32), unit="mm")))
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: name)
    screen.resize(900.0, 600.0, 1.0)
    screen.handles.add_plane()
    screen.handles.toggle_cube("none")
    written = []
    for kind in ("text", "drag_float3", "input_text", "checkbox", "button"):
        real = getattr(imgui, kind)

        def spy(title, *rest, real=real, **more):
            written.append(title)
            return real(title, *rest, **more)

        monkeypatch.setattr(imgui, kind, spy)
    monkeypatch.setattr(screen.panel, "_tabs", {"Tools": screen.panel._tabs["Tools"]})
    for _ in range(2):
        written.clear()
        screen.draw(screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True))
    assert {"point (mm)", "cube (mm)", "cube center (mm)", "cube turn (deg)", "Box"} <= set(written)
    assert not {"spare", "whole atoms", "Navigation cube"} & set(written)
    screen.close()


def test_escape_closes_a_menu_before_it_clears_the_selection(renderer):
    from imgui_bundle import imgui

    screen = screen_of(renderer, (900.0, 400.0))
    rest(screen)
    opened = []
    draw = screen.panel.draw

    def with_menu(size):
        draw(size)
        imgui.begin("scuro")
        if not opened:
            imgui.open_popup("words")
        opened.append(imgui.begin_popup("words"))
        if opened[-1]:
            imgui.text("one")
            imgui.end_popup()
        imgui.end()

    target = screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    screen.panel.draw = with_menu
    screen.draw(target)
    screen.draw(target)
    assert opened[-1], "no menu: this shows nothing"
    screen.view.windowing = True
    for expected in (True, False):  # the second time it is the view's
        for kind in ("key_down", "key_up"):
            screen.handle({"event_type": kind, "key": "Escape", "modifiers": ()})
        screen.draw(target)
        assert not opened[-1] and screen.view.windowing == expected
    screen.close()


def test_what_went_wrong_is_said_once_in_its_color_until_it_is_read(renderer, monkeypatch):
    screen = screen_of(renderer, (900.0, 400.0))
    rest(screen)
    told = []
    monkeypatch.setattr(
        "scuro.viewer.panel.panel.words", lambda text, *color: told.append((text, *color))
    )
    jobs, saving = screen.panel.jobs, screen.panel.saving
    target = screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    saving.picture_settings = saving.picture_settings.replace(name="x.bmp")
    saving.picture()
    while jobs.waiting:
        jobs.tick()
    assert jobs.message.count("x.bmp") == 1 and jobs.failed
    screen.draw(target)
    assert told == [(jobs.message, _WARNING)]
    # the cross before it
    click = {"x": 900.0 - 330.0 + 17.0, "y": 65.0, "button": 1, "modifiers": ()}
    for kind in ("pointer_move", "pointer_down", "pointer_up"):
        screen.handle({"event_type": kind, **click})
        screen.draw(target)
    assert jobs.message == ""
    saving.scene()
    told.clear()
    screen.draw(target)
    assert told == [("scene.toml", None)], "no warning"
    screen.close()


def test_a_wheel_that_comes_right_after_keys_scrolls_the_panel_it_is_over(renderer):
    screen = screen_of(renderer, (900.0, 320.0))
    move(screen, 100.0, 100.0)
    rest(screen)
    camera = screen.view.camera
    for key in ("a", "e", "a", "e"):  # between two pictures; they mean nothing to the scene
        for kind in ("key_down", "key_up"):
            screen.handle({"event_type": kind, "key": key, "modifiers": ()})
    wheel = {"event_type": "wheel", "x": 700.6, "y": 200.0, "dx": 0.0, "dy": 100.0, "modifiers": ()}
    turns, interface = [], screen.gui._body
    screen.gui._body = lambda: (turns.append(1), interface())
    screen.handle(wheel)
    assert screen.view.camera == camera, "the scene was zoomed"
    assert 1 < len(turns) < 12, "no more frames than the keys need"
    screen.handle({**wheel, "x": 200.0})
    assert screen.view.camera != camera, "no wheel at all: this shows nothing"
    screen.close()
