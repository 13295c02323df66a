"""Faults of the viewer's own: people and logs are told, and other pages go on."""

from __future__ import annotations

import pytest

pytest.importorskip("aiohttp", reason="needs the viewer extra")
pytest.importorskip("imgui_bundle", reason="needs the viewer extra")

from aiohttp import WSMsgType
from test_viewer_server import RESIZE, picture, served, view

from scuro.export.scene_file import SceneFile
from scuro.render import Renderer
from scuro.scene.scene import Scene
from scuro.viewer.model import Model
from scuro.viewer.screen import Screen

KEY = {"event_type": "key_down", "key": "f", "modifiers": ()}


@pytest.fixture(scope="module")
def renderer():
    return Renderer()


@pytest.fixture
def model():
    return Model(SceneFile(), Scene())


def broken(*_):
    raise IndexError("list index out of range")


def test_a_hand_that_meets_a_fault_is_told_and_the_screen_stays(renderer, model, caplog):
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: "")
    screen.controls.handle = broken
    screen.take(KEY)
    assert "a fault of scuro itself (IndexError: list index out of range)" in model.message
    assert caplog.records[-1].exc_info[0] is IndexError
    with pytest.raises(IndexError):
        screen.handle(KEY)  # tests and the soak see it


def test_a_page_that_cannot_be_drawn_is_told_why_and_another_goes_on(
    renderer, model, caplog, monkeypatch
):
    async def scenario(session, base, server):
        async with view(session, base) as good, view(session, base) as bad:
            await good.send_json(RESIZE)
            await picture(good)
            draw = Screen.draw
            monkeypatch.setattr(Screen, "draw", broken)
            await bad.send_json(RESIZE)
            while (message := await bad.receive(10)).type in (WSMsgType.TEXT, WSMsgType.BINARY):
                await bad.send_json({"type": "shown", "index": 1000})
            monkeypatch.setattr(Screen, "draw", draw)
            assert message.data == 1011
            assert message.extra == "a fault of scuro itself, IndexError"
            assert caplog.records[-1].exc_info[0] is IndexError
            await good.send_json({**RESIZE, "width": 710.0})
            header, _ = await picture(good)
            assert header["type"] == "picture"

    served(renderer, model, scenario)


def test_a_scene_that_meets_a_fault_is_told_and_comes_back_with_undo(renderer, model, caplog):
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: "")
    screen.resize(200.0, 150.0, 1.0)
    target = screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    screen.draw(target)
    assert screen.view.error == ""
    whole = screen.view.renderer.frame
    dark = model.settings.replace(background="black")

    def frame(scene, camera, settings, *more, **named):
        if settings.background == "black":
            raise IndexError("list index out of range")
        return whole(scene, camera, settings, *more, **named)

    screen.view.renderer.frame = frame
    model.change(settings=dark)
    screen.draw(target)
    assert "a fault of scuro itself (IndexError" in screen.view.error
    assert caplog.records[-1].exc_info[0] is IndexError
    screen.draw(target)
    model.undo()
    while screen.view.share == 0:  # its pipelines may have to be made
        screen.draw(target)
    assert screen.view.error == "" and screen.view.drawn is not None
    screen.close()
