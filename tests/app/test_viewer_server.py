"""The served viewer: who may connect, what a page may say, and that pages do not disturb others."""

import asyncio
import io
import json
import os
from pathlib import Path

import pytest
from PIL import Image
from serving import RESIZE, closed, picture, rested, served, view

from scuro.errors import SettingsError
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.viewer.access import Access, Files, is_loopback
from scuro.viewer.model import Model
from scuro.viewer.remote import MOST_RATIO, read_event

aiohttp = pytest.importorskip("aiohttp", reason="needs the viewer extra")
pytest.importorskip("imgui_bundle", reason="needs the viewer extra")

from scuro.viewer.screen import LARGEST, MOST_PIXELS, Screen  # noqa: E402
from scuro.viewer.server import LONGEST_MESSAGE, MESSAGES, MOST_FAULTS  # noqa: E402


@pytest.fixture(scope="module")
def renderer():
    return Renderer()


@pytest.fixture(scope="module")
def model():
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),))
    return Model(document)


def test_only_loopback_goes_without_a_token():
    assert all(map(is_loopback, ("127.0.0.1", "::1", "localhost", "127.9.9.9")))
    assert not any(map(is_loopback, ("0.0.0.0", "::", "192.168.1.5", "example.org")))
    assert Access.for_host("127.0.0.1").token is None
    first, second = Access.for_host("0.0.0.0"), Access.for_host("0.0.0.0")
    assert first.token and len(first.token) >= 32 and first.token != second.token
    assert first.token in first.link(80) and first.knows(first.token)
    assert not any(map(first.knows, (None, "", "x", first.token + "x", "ü")))


def test_pages_come_with_headers_and_nothing_else_can_be_fetched(renderer, model):
    async def scenario(session, base, server):
        for path in ("/", "/client.js", "/client.css", "/renderview.js"):
            async with session.get(base + path) as answer:
                assert answer.status == 200 and await answer.text()
                assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
                assert answer.headers["X-Content-Type-Options"] == "nosniff"
        for path in ("/../pyproject.toml", "/etc/passwd", "/web/index.html", "/%2e%2e/x", "/x"):
            async with session.get(base + path) as answer:
                assert answer.status == 404

    served(renderer, model, scenario)


def test_other_sites_may_not_connect(renderer, model):
    async def scenario(session, base, server):
        port = base.rpartition(":")[2]
        others = ("http://evil.example", "null", f"http://evil.example:{port}", None, "file://")
        for origin in others:
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await view(session, base, origin)
            assert refused.value.status == 403
        # a name of another site that was made to point here
        headers = {"Host": f"evil.example:{port}", "Origin": f"http://evil.example:{port}"}
        async with session.get(base + "/", headers=headers) as answer:
            assert answer.status == 403
        assert server.clients == 0

    served(renderer, model, scenario)


def test_outside_loopback_a_token_is_needed_and_leaves_the_address_bar(renderer, model):
    access = Access("0.0.0.0", "secret-token")

    async def scenario(session, base, server):
        for query in ("", "?token=wrong", "?token="):
            async with session.get(f"{base}/{query}") as answer:
                assert answer.status == 401
        with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
            await view(session, base)
        assert refused.value.status == 401
        link = f"{base}/?token=secret-token"
        async with session.get(link, allow_redirects=False) as answer:
            assert answer.status == 302 and answer.headers["Location"] == "/"
            cookie = answer.headers["Set-Cookie"]
            assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
        async with session.get(base + "/") as answer:
            assert answer.status == 200
        async with view(session, base) as socket:
            await socket.send_json(RESIZE)
            assert await rested(socket)

    served(renderer, model, scenario, access)


def test_two_pages_see_one_scene_each_from_its_own_side(renderer, model):
    async def scenario(session, base, server):
        async with view(session, base) as one, view(session, base) as two:
            for socket in (one, two):
                await socket.send_json(RESIZE)
            await asyncio.gather(rested(one), rested(two))
            await one.send_json({"type": "key_down", "key": "x", "modifiers": []})
            assert await rested(one)
            with pytest.raises(asyncio.TimeoutError):
                await picture(two, timeout=0.5)
            model.change(settings=model.settings.replace(background="navy"))
            for data in await asyncio.gather(rested(one), rested(two)):
                corner = Image.open(io.BytesIO(data)).getpixel((1, 30))
                assert corner == (0, 0, 128)
            model.undo()

    served(renderer, model, scenario)


def test_no_more_pages_than_allowed_and_a_place_is_free_again(renderer, model):
    async def scenario(session, base, server):
        async with view(session, base), view(session, base):
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await view(session, base)
            assert refused.value.status == 503
        for _ in range(100):
            if server.clients == 0:
                break
            await asyncio.sleep(0.05)
        assert server.clients == 0
        async with view(session, base) as socket:
            await socket.send_json(RESIZE)
            assert await rested(socket)

    served(renderer, model, scenario, most=2)


def test_rubbish_floods_and_vanishing_do_not_disturb_another_page(renderer, model):
    async def scenario(session, base, server):
        async with view(session, base) as good:
            await good.send_json(RESIZE)
            await rested(good)
            rubbish = await view(session, base)
            for message in ("", "{", "[]", "null", '{"type": 3}', '{"type": "eval"}', "[" * 2000):
                await rubbish.send_str(message)
            for _ in range(MOST_FAULTS):
                await rubbish.send_bytes(b"\0")
            assert await closed(rubbish) == aiohttp.WSCloseCode.POLICY_VIOLATION
            large = await view(session, base)
            await large.send_str("x" * (LONGEST_MESSAGE + 1))
            assert await closed(large) == aiohttp.WSCloseCode.MESSAGE_TOO_BIG
            flood = await view(session, base)
            move = json.dumps({"type": "pointer_move", "x": 1, "y": 2, "button": 0})
            try:
                for _ in range(6 * MESSAGES):
                    await flood.send_str(move)
            except ConnectionError:
                pass
            assert await closed(flood) == aiohttp.WSCloseCode.POLICY_VIOLATION
            gone = await view(session, base)
            await gone.send_json(RESIZE)
            gone._response.connection.transport.abort()
            await good.send_json({"type": "key_down", "key": "y", "modifiers": []})
            assert await rested(good)
            for _ in range(100):
                if server.clients == 1:
                    break
                await asyncio.sleep(0.05)
            assert server.clients == 1

    served(renderer, model, scenario)


def test_probe_messages_that_are_all_there_are_answered_in_turn_with_others(model):
    """Without waiting for a network between them: only the turn that each gives lets others run."""
    pytest.importorskip("numba", reason="needs the viewer extra")
    from scuro.probe.probe import ProbeSettings
    from scuro.probe.stream import stream_handler

    model.set_probe(ProbeSettings(light=False))

    class Message:
        data = "{}"

    class Socket:
        answers = 0

        async def __aiter__(self):
            for _ in range(50):
                yield Message

        async def send_str(self, text):
            self.answers += 1

    async def scenario():
        socket, seen = Socket(), []

        async def other():
            while True:
                seen.append(socket.answers)
                await asyncio.sleep(0)

        task = asyncio.create_task(other())
        await stream_handler(model)(socket)
        task.cancel()
        return socket.answers, len(seen)

    try:
        answers, turns = asyncio.run(scenario())
    finally:
        model.set_probe(None)
    assert answers == 50 and turns >= 50


def test_a_program_that_floods_the_probe_leaves_pages_their_turn(renderer, model):
    pytest.importorskip("numba", reason="needs the viewer extra")
    from scuro.probe.probe import ProbeSettings
    from scuro.probe.stream import stream_handler

    model.set_probe(ProbeSettings(light=False))

    async def scenario(session, base, server):
        async with view(session, base) as good, session.ws_connect(base + "/probe") as program:
            await good.send_json(RESIZE)
            await rested(good)

            async def flood():
                while True:
                    await program.send_str("{}")
                    await program.receive()

            async def rubbish():
                while True:
                    await program.send_str("[" * 2000)

            for act in (flood, rubbish):
                task = asyncio.create_task(act())
                await good.send_json({"type": "key_down", "key": "y", "modifiers": []})
                assert await asyncio.wait_for(rested(good), 30)
                task.cancel()

    try:
        served(renderer, model, scenario, extra={"/probe": stream_handler(model)})
    finally:
        model.set_probe(None)


def test_the_panel_offers_no_setting_that_reads_a_file_unguarded(model):
    """What the panel shows of films: everything that names a file is left to the command line."""
    import inspect

    from scuro.export.motion import MovieSettings
    from scuro.settings import parameters
    from scuro.viewer.panel.files import Files as FilesPart

    texts = {p.name for p in parameters(MovieSettings) if p.type is str and not p.choices}
    assert texts == {"keys", "to_look"}, "a new text setting of films: may it name a file?"
    assert 'without=("keys", "to_look")' in inspect.getsource(FilesPart.save)


def test_the_size_of_pictures_is_bounded(renderer, model):
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: "")
    for size in ((1e6, 1e6), (1e6, 1.0), (3000.0, 2000.0)):
        screen.resize(*size, MOST_RATIO)
        width, height = screen.physical
        assert max(width, height) <= LARGEST and width * height <= 1.01 * MOST_PIXELS
    saving = screen.panel.saving
    saving.picture_settings = saving.picture_settings.replace(scale=8.0)
    with pytest.raises(SettingsError, match="pixels a side"):
        saving.picture()
    screen.resize(-5, 0, -1)
    assert screen.physical == (1, 1)
    screen.close()


@pytest.mark.parametrize(
    "message",
    [
        '{"type": "resize", "width": 1e999, "height": 5, "ratio": 1}',
        '{"type": "resize", "width": NaN, "height": 5, "ratio": 1}',
        '{"type": "wheel", "x": 1, "y": 1, "dx": 0}',
        '{"type": "pointer_down", "x": "1", "y": 1, "button": 1}',
        '{"type": "pointer_down", "x": true, "y": 1, "button": 1}',
        '{"type": "key_down", "key": 5}',
        '{"type": "eval", "data": "1"}',
        '{"type": "char", "data": "%s"}' % ("x" * 100),
        '{"type": "char", "data": "\\ud800"}',
        '{"type": "key_down", "key": "a", "modifiers": "Shift"}',
        '{"type": "key_down", "key": "a", "modifiers": [1]}',
        '{"type": "shown", "index": %s}' % ("9" * 4000),
    ],
)
def test_events_that_hold_what_they_cannot_are_refused(message):
    with pytest.raises(ValueError):
        read_event(message)


def test_only_named_files_and_those_below_the_root_open(tmp_path):
    root, outside = tmp_path / "root", tmp_path / "secret.pdb"
    root.mkdir()
    outside.write_text("ATOM")
    (root / "inside.pdb").write_text("ATOM")
    (root / "deep").mkdir()
    (root / "deep" / "map.mrc").write_text("x")
    (root / "deep" / "notes.txt").write_text("x")
    os.symlink(outside, root / "link.pdb")
    os.symlink(tmp_path, root / "up")
    os.symlink(root / "circle", root / "circle")
    start = SceneFile(input=(Input(path=str(outside)),))
    files = Files.of(SceneFile(input=(Input(path="sample:1hpv"),)), str(root))

    def document(path):
        return SceneFile(input=(Input(path=str(path)),))

    files.check(document(root / "inside.pdb"))
    files.check(document("sample:1tii"))
    for path in (
        outside, root / "link.pdb", root / "up" / "secret.pdb", root / ".." / "secret.pdb",
        f"{root}/deep/../../secret.pdb", "/etc/passwd", "1abc", "-", str(root) + "x/y.pdb",
        f"{root}/a\0.pdb", root / "circle", f"{root}/deep/" + "x" * 5000,
    ):  # fmt: skip
        with pytest.raises(SettingsError, match="not among the files"):
            files.check(document(path))
    assert [Path(p).name for p in files.listing()] == ["map.mrc", "inside.pdb"]
    # every text setting that could name a file counts
    for transfer in (str(outside), f"{outside}:preset", "/etc/passwd", "../secret.pdb"):
        settings = Settings().replace(volume__transfer=transfer)
        with pytest.raises(SettingsError, match="not among the files"):
            files.check(SceneFile(settings=settings))
    files.check(SceneFile(settings=Settings().replace(volume__transfer="viridis")))
    assert Files.of(start).may_open(str(outside))


def test_pages_are_told_of_files_by_the_names_they_know(tmp_path, renderer, monkeypatch):
    root, other = tmp_path / "served", tmp_path / "elsewhere"
    (root / "deep").mkdir(parents=True)
    other.mkdir()
    (other / "first.xyz").write_text("1\n\nC 0 0 0\n")
    (other / "link.xyz").symlink_to(other / "first.xyz")
    broken = root / "deep" / "broken.pdb"
    broken.write_text("nothing\n")
    (root / "bad.toml").write_text("scuro = 1\ncolour = 3\n")
    monkeypatch.chdir(other)
    document = SceneFile(input=(Input(path="link.xyz"),))
    files = Files.of(document, str(root))
    model = Model(document, guard=files.check)
    told = []
    monkeypatch.setattr("scuro.viewer.panel.panel.words", lambda text, *color: told.append(text))
    screen = Screen(model, renderer, "rgba8unorm", str, files.listing, True, files.told)
    screen.resize(800.0, 200.0, 1.0)
    target = renderer.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    for path, name in (
        (str(broken), "deep/broken.pdb"),
        (str(root / "bad.toml"), "bad.toml, line 2"),
    ):
        told.clear()
        assert not model.open_path(path) and str(tmp_path) in model.message
        screen.draw(target)
        assert told and told[0].startswith(name) and str(tmp_path) not in told[0], told
    assert files.told(f"{other / 'first.xyz'}: x, {Path('link.xyz').absolute()}") == (
        "first.xyz: x, link.xyz"
    )
    screen.close()


def test_a_page_cannot_make_the_model_open_another_file(model):
    files = Files.of(model.document)
    guarded = Model(model.document, model.scene, guard=files.check)
    assert not guarded.open_path("/etc/passwd")
    assert "not among the files" in guarded.message and guarded.scene is model.scene


def test_files_that_lead_to_others_lead_nowhere_else(tmp_path):
    from scuro.errors import LoadError
    from scuro.load.source import confined, open_source

    root, started = tmp_path / "root", tmp_path / "started"
    for folder in (root, started, started / "proteins"):
        folder.mkdir()
    secret = tmp_path / "secret.grdecl"
    inside, beside = root / "a.grdecl", started / "proteins" / "b.pdb"
    for file in (secret, inside, beside, started / "model.json"):
        file.write_text("x")
    os.symlink(secret, root / "link.grdecl")
    document = SceneFile(input=(Input(str(started / "model.json")), Input("sample:1hpv")))
    with confined(Files.of(document, str(root)).may_follow):
        assert open_source(inside).path and open_source(beside).path
        assert open_source("sample:1tii").path
        here = Path(__file__)  # the working directory is no place that a sample's name opens
        for path in (secret, root / "link.grdecl", root / ".." / "secret.grdecl", here):
            with pytest.raises(LoadError, match="not among the files"):
                open_source(path)
    assert open_source(secret).path
