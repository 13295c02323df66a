"""The probe in the viewer: keys, light, clip plane, path, and the stream for other programs."""

import asyncio
import itertools
import json
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("numba", reason="needs the viewer extra")

from scuro.errors import LoadError, SettingsError
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.load import load
from scuro.probe.probe import Probe, ProbeSettings, placed_atoms
from scuro.probe.solver import compile_loops
from scuro.probe.stream import stream_handler
from scuro.render import Renderer
from scuro.scene.scene import Scene
from scuro.viewer.controls import Controls
from scuro.viewer.handles import Handles
from scuro.viewer.jobs import Jobs
from scuro.viewer.model import Model
from scuro.viewer.navigate import pixel_size, project
from scuro.viewer.probing import Probing
from scuro.viewer.view import View


@pytest.fixture(scope="module")
def renderer():
    return Renderer()


@pytest.fixture
def probing(renderer):
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),))
    made = Probing(View(Model(document), renderer.sibling(), (64, 48)), Jobs())
    compile_loops()
    assert made.key("p") and made.probe is not None
    return made


def test_the_first_of_a_process_is_compiled_beside_the_pages(renderer, monkeypatch):
    began, let = threading.Event(), threading.Event()
    ready = [False]

    def compile_slowly():
        began.set()
        assert let.wait(20)
        ready[0] = True

    monkeypatch.setattr("scuro.viewer.probing._is_compiled", lambda: ready[0])
    monkeypatch.setattr("scuro.viewer.probing._compile", compile_slowly)
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),))
    jobs = Jobs()
    probing = Probing(View(Model(document), renderer.sibling(), (64, 48)), jobs)
    assert probing.key("p") and probing.key("p"), "asked for twice while it is prepared"
    assert len(jobs.waiting) == 1 and probing.probe is None
    jobs.tick()
    assert began.wait(20) and probing.probe is None, "a slice waited for the compiler"
    let.set()
    while jobs.waiting:
        jobs.tick()
    assert probing.probe is not None and not jobs.failed


def test_it_starts_outside_the_atoms_and_keys_never_carry_it_in(probing):
    probe = probing.probe
    assert probe.constraint.depth(probe.position) < 0
    start = probe.position.copy()
    for key in ("PageUp",) * 30 + ("ArrowLeft", "ArrowUp") * 10:
        assert probing.key(key)
        assert probe.constraint.depth(probe.position) < 0
    assert np.linalg.norm(probe.position - start) > 1
    assert probing.key("p") and probing.probe is None and not probing.key("ArrowUp")


def test_the_mouse_drags_it_over_the_surface_and_lets_the_hand_spring_back(probing):
    view, size = probing.view, (640.0, 480.0)
    controls = Controls(view, Handles(view), probing)
    controls.logical = size
    probe, camera = probing.probe, view.camera

    def at():
        return project(camera, [probe.position], size)[0, :2]

    def send(kind, point):
        held = () if kind == "pointer_up" else (1,)
        event = {"event_type": kind, "x": point[0], "y": point[1], "button": 1, "buttons": held}
        controls.handle({**event, "modifiers": ()})

    out = camera.view_from_world()[2, :3]
    probe.move(view.model.scene.bounds().mean(axis=0) + 80 * out)  # free, toward the eye
    start, aside = at(), at() + np.array((40, -25))
    send("pointer_down", start)
    send("pointer_move", aside)
    assert at() == pytest.approx(aside, abs=0.5)
    send("pointer_up", aside)
    assert view.camera == camera and not probe.force.any()
    # behind the foremost atoms, and then sideways into the molecule
    probe.move(view.model.scene.bounds().mean(axis=0) + 60 * camera.view_from_world()[0, :3])
    start, center = at(), np.array(size) / 2
    send("pointer_down", start)
    for share in np.linspace(0, 1, 40):
        send("pointer_move", start + share * (center - start))
        assert probe.constraint.depth(probe.position) < 0
    assert probe.force.any() and np.linalg.norm(at() - center) > 20
    send("pointer_up", center)
    assert not probe.force.any()
    assert view.camera == camera  # it was held: nothing turned


def test_force_is_stiffness_times_the_way_the_hand_is_inside(probing):
    probe = probing.probe
    probing.change(ProbeSettings(stiffness=3.0))
    middle = probing.view.model.scene.bounds().mean(axis=0)
    probe.move(middle)
    assert probe.force == pytest.approx(3.0 * (probe.position - middle))
    state = probe.state()
    assert state["contact"] and json.loads(json.dumps(state)) == state
    probing.release()
    assert not probe.force.any() and not probe.state()["contact"]


def test_its_light_and_plane_are_in_the_drawn_scene_and_go_with_it(probing):
    view, model = probing.view, probing.view.model
    probing.change(ProbeSettings(clip=True))
    scene = model.dressed(view.camera)
    assert scene.lighting.lights[-1].position == pytest.approx(tuple(probing.probe.position))
    distances = scene.clip.equations() @ np.append(probing.probe.position, 1)
    assert distances == pytest.approx([1.4 + 0.5])
    eye = scene.clip.equations() @ np.append(view.camera.position, 1)
    assert (eye < 0).all(), "the plane does not cut toward the eye"
    assert not model.clip.planes, "the riding plane became part of what can be undone"
    probing.toggle()
    assert not model.dressed(view.camera).clip.planes


def test_recording_ends_at_so_many_places(probing, monkeypatch):
    monkeypatch.setattr("scuro.probe.probe.MOST_PLACES", 5)
    probe = probing.probe
    for _ in range(2):
        probe.recording = True
        for _ in range(12):
            probing.key("ArrowRight")
        assert len(probe.path) == 5 and not probe.recording


def test_a_path_is_recorded_saved_and_replayed(probing, tmp_path):
    probe = probing.probe
    probe.recording = True
    for _ in range(12):
        probing.key("ArrowRight")
    probe.save_path(tmp_path / "path.json")
    track = load(tmp_path / "path.json")
    points = track.points
    assert track.radius == probe.settings.radius and track.summary()["length"] > 2
    assert len(points) == len(probe.path) >= 10
    now = [0.0]
    probing._clock = lambda: now[0]
    probing.replay()
    probing.tick()
    assert probe.position == pytest.approx(points[0], abs=0.01)
    while probing.wait is not None:
        now[0] += probing.wait
        probing.tick()
    assert probe.position == pytest.approx(points[-1], abs=0.01)
    for bad in ("[[1, 2]]", "[]", "3", '[[1, 2, "x"]]', "[[1, 2, NaN]]", "[[1, 2, 3], [4, 5]]"):
        (tmp_path / "bad.json").write_text(f'{{"points": {bad}}}')
        with pytest.raises(LoadError, match="path"):
            load(tmp_path / "bad.json")


def test_a_saved_path_is_drawn_where_it_went_and_replayed(probing, tmp_path, renderer):
    probe = probing.probe
    probe.recording = True
    for key in ("PageUp",) * 12 + ("ArrowRight",) * 12:
        probing.key(key)
    probe.save_path(tmp_path / "path.json")
    model = probing.view.model
    document = model.document
    together = replace(document, input=(*document.input, Input(path=str(tmp_path / "path.json"))))
    assert model.open(together)
    end = time.time() + 30
    while model.restyle is not None and time.time() < end:
        model.tick()
    (item,) = model.scene.tracks
    (body,) = item.bodies()
    assert item.bodies()[0] is body
    np.testing.assert_allclose(body.geometry.spheres[:, :3], probe.path, atol=1e-4)
    assert len(body.geometry.rods) == len(probe.path) - 1
    # in the picture its end is seen where it lies, in its own colour
    camera, size = probing.view.camera, (200, 150)
    settings = model.settings.replace(size=size)
    picture = np.asarray(renderer.render(model.scene, camera, settings))
    x, y, _ = project(camera, [probe.path[-1]], size)[0]
    r, g, b, _ = picture[int(y), int(x)].astype(int)
    assert r > g > b + 40
    # and a new probe goes along it
    model.set_probe(ProbeSettings(), model.middle)
    probing.replay()
    assert probing.replaying and len(probing.path) == len(item.track.points)


def test_the_arrow_grows_with_the_force_and_stays_in_the_picture(probing):
    probe = probing.probe
    _, eye = seen(probing)
    depth = eye.project([probe.position])[0, 2]
    lengths = []
    for push in (0.01, 0.1, 1.0, 10.0, 1000.0):
        probe.target = probe.position + np.array([push, 0, 0])
        arrow = probing._arrow(eye, depth)
        assert arrow[0] < 0 and not arrow[1:].any(), "it shows the way back"
        lengths.append(-arrow[0] / pixel_size(eye.camera, eye.size, depth))
    assert lengths[0] == pytest.approx(lengths[1] / 10, rel=0.05)
    assert all(a < b for a, b in itertools.pairwise(lengths[:4]))
    assert 100 < lengths[-1] <= 110


def test_a_replay_can_be_left(probing):
    probe = probing.probe
    probe.recording = True
    for _ in range(12):
        probing.key("ArrowRight")
    ways = (
        probing.replay,
        lambda: probing.key("ArrowLeft"),
        lambda: probing.press(seen(probing)[0], seen(probing)[1]),
    )
    for leave in ways:
        probing.replay()
        probing.tick()
        assert probing.replaying and probing.wait is not None
        leave()
        assert not probing.replaying and probing.wait is None


def seen(probing):
    """Where the probe is in its picture, and by which eye."""
    (eye,) = probing.view.eyes(probing.view.size)
    x, y, _ = eye.project([probing.probe.position])[0]
    return (x, y), eye


def test_a_gamepad_moves_it_with_time_and_never_into_an_atom(probing):
    from scuro.viewer.gamepad import event_of

    rest = event_of([0.05, -0.1, 0.0, 0.0, -1.0, -1.0])
    assert not any(rest[name] for name in ("x", "y", "z", "turn_x", "turn_y"))
    held = event_of([1.0, 0.0, 0.0, 0.0, -1.0, 1.0])
    assert held["x"] == 1.0 and held["z"] == -1.0, "the right trigger leads away from the eye"
    now = [0.0]
    probing._clock = lambda: now[0]
    probe, start = probing.probe, probing.probe.position.copy()
    probing.push(0.0, 0.0, -1.0)
    assert probing.wait is not None
    for _ in range(200):
        now[0] += 0.05
        probing.tick()
        assert probe.constraint.depth(probe.position) < 0
    assert np.linalg.norm(probe.position - start) > 1
    probing.push(0.0, 0.0, 0.0)
    assert probing.wait is None


def test_without_atoms_there_is_no_probe(probing):
    with pytest.raises(SettingsError, match="no atoms"):
        Probe(Scene(), ProbeSettings(), (0, 0, 0))
    with pytest.raises(SettingsError, match="selects none"):
        placed_atoms(probing.view.model.scene, "element Xe")


def test_other_programs_move_it_and_feel_the_force_a_thousand_times_a_second(probing):
    aiohttp = pytest.importorskip("aiohttp", reason="needs the viewer extra")
    from scuro.viewer.access import Access
    from scuro.viewer.server import Server

    model = probing.view.model
    inside = model.scene.bounds().mean(axis=0)
    took = []

    async def main():
        from aiohttp import web

        server = Server(None, Access.for_host("127.0.0.1"), 2, {"/probe": stream_handler(model)})
        runner = web.AppRunner(server.application(), access_log=None, shutdown_timeout=0.1)
        await runner.setup()
        await web.TCPSite(runner, "127.0.0.1", 0).start()
        url = f"http://127.0.0.1:{runner.addresses[0][1]}/probe"
        async with aiohttp.ClientSession() as session, session.ws_connect(url) as socket:
            for message in ("rubbish", "[]", '{"target": [1, 2]}', '{"target": [1, 2, NaN]}'):
                await socket.send_str(message)
                assert "error" in await socket.receive_json()
            begin = time.process_time()
            for step in range(200):
                target = (inside + np.array([0, 0, 20 - step / 10])).tolist()
                await socket.send_json({"target": target})
                state = await socket.receive_json()
            took.append(time.process_time() - begin)
            assert state["contact"] and model.probe.constraint.depth(state["position"]) < 0
        await runner.cleanup()

    asyncio.run(main())
    # this process does both ends' work
    assert took[0] < 0.4
