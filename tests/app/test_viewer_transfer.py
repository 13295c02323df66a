"""The transfer function's editor by hand: points are dragged, added and taken away, and undone."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("imgui_bundle", reason="needs the viewer extra")

from scuro.export.scene_file import SceneFile
from scuro.render import Renderer
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume
from scuro.viewer.model import Model
from scuro.viewer.panel import transfer_editor
from scuro.viewer.screen import Screen
from scuro.viewer.under import words_at

SIZE = (700.0, 900.0)


@pytest.fixture(scope="module")
def renderer():
    return Renderer()


@pytest.fixture
def screen(renderer):
    values = np.random.default_rng(2).random((12, 12, 12), np.float32)
    values[0, 0, 0], values[-1, -1, -1] = 0, 1
    model = Model(SceneFile(), Scene().add(Volume(values)))
    model.change(settings=model.settings.replace(volume__opacity="0:0 0.5:0.4 0.8:0.6 1:0.8"))
    made = Screen(model, renderer, "rgba8unorm", lambda name, write: "")
    made.resize(*SIZE, 1.0)
    made.panel.open = True
    yield made
    made.close()


@pytest.fixture
def hand(screen, renderer, monkeypatch):
    """Sends events, draws after each, and knows where the editor's points lie."""
    target = renderer.gpu.texture(screen.physical, "rgba8unorm", attachment=True, label="screen")
    found = {}
    paint = transfer_editor._paint

    def spy(paper, subject, corner, width, places, shown):
        found.update(corner=corner, width=width, places=places)
        paint(paper, subject, corner, width, places, shown)

    monkeypatch.setattr(transfer_editor, "_paint", spy)

    def send(kind="", x=0.0, y=0.0, button=0, **more):
        if kind:
            held = (button,) if kind != "pointer_up" and button else ()
            event = {"event_type": kind, "x": x, "y": y, "button": button, "buttons": held}
            screen.handle({**event, "modifiers": (), "ntouches": 0, "touches": {}, **more})
        screen.draw(target)
        return found

    for _ in range(3):
        send()
    if not found:
        pytest.fail("the editor is not in sight: make the screen taller")
    return send


def opacity(screen):
    pairs = (pair.split(":") for pair in screen.model.settings.volume.opacity.split())
    return [(float(v), float(a)) for v, a in pairs]


def test_a_dragged_point_moves_between_its_neighbours_and_one_undo_takes_it_back(screen, hand):
    seen = hand()
    before = opacity(screen)
    (x, y), width = seen["places"][1], seen["width"]
    hand("pointer_move", x, y)
    hand("pointer_down", x, y, 1)
    for step in range(1, 5):
        hand("pointer_move", x + step * width / 20, y - 4 * step, 1)
    hand("pointer_up", x + width / 5, y - 16, 1)
    hand()
    after = opacity(screen)
    assert after[0] == before[0] and after[2:] == before[2:]
    assert after[1][0] == pytest.approx(0.7, abs=0.02)
    assert after[1][1] > before[1][1] + 0.05
    hand("pointer_move", x + width / 5, y - 16)
    hand("pointer_down", x + width / 5, y - 16, 1)
    hand("pointer_move", x + 3 * width, y - 16, 1)
    hand("pointer_up", x + 3 * width, y - 16, 1)
    hand()
    assert opacity(screen)[1][0] == pytest.approx(0.8)  # not past its neighbour
    screen.model.undo()
    screen.model.undo()
    assert opacity(screen) == before


def test_a_right_click_takes_a_point_away(screen, hand):
    x, y = hand()["places"][1]
    hand("pointer_move", x, y)
    hand("pointer_down", x, y, 2)
    hand("pointer_up", x, y, 2)
    hand()
    assert [v for v, _ in opacity(screen)] == [0, 0.8, 1]


def test_opaque_cells_have_no_opacity_to_drag_and_undo_brings_the_line_back(renderer, monkeypatch):
    from scuro.scene.cornerpoint_synthetic import faulted_dome

    model = Model(SceneFile(), Scene().add(faulted_dome()))
    model.change(settings=model.settings.replace(reservoir__show="cells"))
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: "")
    screen.resize(*SIZE, 1.0)
    target = renderer.gpu.texture(screen.physical, "rgba8unorm", attachment=True, label="screen")
    found = {}
    monkeypatch.setattr(
        transfer_editor,
        "_paint",
        lambda paper, subject, corner, width, places, shown: found.update(
            corner=corner, width=width, places=places
        ),
    )

    def send(kind="", x=0.0, y=0.0, button=0):
        if kind:
            screen.handle({"event_type": kind, "x": x, "y": y, "button": button, "modifiers": ()})
        screen.draw(target)

    def drag(x, y):
        send("pointer_move", x, y)
        send("pointer_down", x, y, 1)
        for step in range(1, 4):
            send("pointer_move", x, y - 10 * step, 1)
        send("pointer_up", x, y - 30, 1)

    for _ in range(3):
        send()
    assert found["places"] == []
    drag(found["corner"][0] + 0.5 * found["width"], found["corner"][1] + 90)
    assert model.settings.reservoir.opacity == ""
    model.change(settings=model.settings.replace(reservoir__show="volume"))
    send()
    before = found["places"]
    assert len(before) > 1
    drag(*before[2])
    send()
    assert found["places"][2][1] < before[2][1] - 20 and model.settings.reservoir.opacity
    model.undo()
    send()
    assert found["places"] == before and model.settings.reservoir.opacity == ""
    screen.close()


def test_nothing_is_under_the_pointer_while_a_colormap_is_half_typed(screen):
    model, view = screen.model, screen.view
    assert words_at(view, 0.5, 0.5)
    model.change(settings=model.settings.replace(volume__transfer="uto"))
    assert words_at(view, 0.5, 0.5) == ""
