"""The served viewer and those who break the rules of the wire, or try for other files."""

import asyncio
import base64
import contextlib
import json
import struct

import pytest
from click.testing import CliRunner
from serving import RESIZE, closed, rested, served, view

from scuro.app.serve import command
from scuro.errors import SettingsError
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.load.options import LoadOptions
from scuro.probe.probe import ProbeSettings
from scuro.probe.stream import stream_handler
from scuro.viewer import access, listening, server
from scuro.viewer.access import Access, Files
from scuro.viewer.model import Model

aiohttp = pytest.importorskip("aiohttp", reason="needs the viewer extra")

TEXT, CONTINUED, PING, FINAL = 1, 0, 9, 0x80


@pytest.fixture(scope="module")
def model():
    document = SceneFile(input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),))
    return Model(document)


async def raw(base):
    """A bare connection to the server."""
    port = int(base.rpartition(":")[2])
    return await asyncio.open_connection("127.0.0.1", port)


async def raw_view(base):
    """A bare connection on which a page's WebSocket is open."""
    reader, writer = await raw(base)
    host = base.removeprefix("http://")
    key = base64.b64encode(bytes(16)).decode()
    writer.write(
        f"GET /view HTTP/1.1\r\nHost: {host}\r\nOrigin: {base}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        f"Sec-WebSocket-Key: {key}\r\n\r\n".encode()
    )
    assert b" 101 " in await reader.readuntil(b"\r\n\r\n")
    return reader, writer


def frame(first, payload, length=None):
    """A masked WebSocket frame (the mask is zero) that says it is ``length`` long."""
    return bytes([first, 0xFF]) + struct.pack(">Q", length or len(payload)) + bytes(4) + payload


async def close_code(reader):
    """The code in the close frame, which may come after pictures."""
    async with asyncio.timeout(10):
        while True:
            first, length = await reader.readexactly(2)
            if length >= 126:
                wide = 2 if length == 126 else 8
                length = int.from_bytes(await reader.readexactly(wide), "big")
            payload = await reader.readexactly(length)
            if first == 0x88:
                return struct.unpack(">H", payload[:2])[0]


async def left(server, count):
    """Wait until so many pages are there."""
    for _ in range(100):
        if server.clients == count:
            return
        await asyncio.sleep(0.05)
    raise AssertionError(f"{server.clients} pages hold a place, not {count}")


async def still_served(good):
    await good.send_json({"type": "key_down", "key": "y", "modifiers": []})
    assert await asyncio.wait_for(rested(good), 20)


def test_connections_that_ask_for_nothing_are_cut(renderer, model, monkeypatch):
    monkeypatch.setattr(listening, "PATIENCE", 0.3)

    async def scenario(session, base, server):
        async with view(session, base) as good:
            await good.send_json(RESIZE)
            for begin in (b"", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: "):
                reader, writer = await raw(base)
                writer.write(begin)
                with contextlib.suppress(ConnectionError):
                    assert await asyncio.wait_for(reader.read(), 5) == b""
                writer.close()
            await rested(good)
            await still_served(good)

    served(renderer, model, scenario)


def test_a_page_that_does_not_answer_any_more_loses_its_place(renderer, model, monkeypatch):
    monkeypatch.setattr(server, "_HEARTBEAT", 0.4)

    async def scenario(session, base, server):
        _, silent = await raw_view(base)  # never says anything
        _, half = await raw_view(base)  # stops in the middle of a frame
        half.write(frame(TEXT | FINAL, b"{" * 10, 100))
        await left(server, 2)
        await left(server, 0)
        silent.close()
        half.close()

    served(renderer, model, scenario)


def test_a_page_that_leaves_in_mid_frame_frees_its_place(renderer, model):
    async def scenario(session, base, server):
        async with view(session, base) as good:
            await good.send_json(RESIZE)
            await rested(good)
            _, half = await raw_view(base)
            half.write(frame(TEXT | FINAL, b"{" * 10, 100))
            await left(server, 2)
            half.transport.abort()
            await left(server, 1)
            await still_served(good)

    served(renderer, model, scenario)


def test_a_page_that_takes_no_pictures_is_given_up(monkeypatch):
    monkeypatch.setattr(server, "_SLOWEST_SEND", 0.05)

    class Stuck:
        closed = False

        async def send_str(self, text):
            await asyncio.sleep(1)
            raise AssertionError("it waited for a page that takes nothing")

    class Pictures:
        async def due(self):
            await asyncio.sleep(0)

        def messages(self):
            yield "{}"

    with pytest.raises(TimeoutError):
        asyncio.run(server._paint(Stuck(), Pictures()))


def test_pictures_wait_until_the_last_but_one_was_shown(renderer, model):
    async def scenario(session, base, server):
        # who says that more was seen than was sent has seen what was sent: one at most by then
        for shown, most in ((0, 2), (1e6, 3)):
            async with view(session, base) as page:
                await page.send_json({"type": "shown", "index": shown})
                await page.send_json(RESIZE)
                for _ in range(4):
                    await page.receive(20)
                taken = 4
                for key in "xyzxyz":
                    await page.send_json({"type": "key_down", "key": key, "modifiers": []})
                    with contextlib.suppress(asyncio.TimeoutError):
                        while await page.receive(0.2):
                            taken += 1
                assert taken / 2 <= most, "each has a header"

    served(renderer, model, scenario)


@pytest.mark.parametrize(
    "frames",
    [
        [frame(TEXT | FINAL, b"", 1 << 40)],
        [frame(TEXT, b"x" * 3000), frame(CONTINUED, b"x" * 3000)],
        [frame(TEXT, b"x")] + [frame(CONTINUED, b"x" * 100)] * 41,
    ],
    ids=["declared", "fragments", "many-fragments"],
)
def test_what_is_too_long_is_refused_before_it_is_whole(renderer, model, frames):
    async def scenario(session, base, server):
        reader, writer = await raw_view(base)
        for part in frames:
            writer.write(part)
        assert await close_code(reader) == aiohttp.WSCloseCode.MESSAGE_TOO_BIG
        writer.close()
        await left(server, 0)

    served(renderer, model, scenario)


def test_what_unpacks_to_more_than_may_be_sent_is_refused(renderer, model):
    async def scenario(session, base, server):
        bomb = await view(session, base, compress=15)
        assert bomb.compress
        await bomb.send_str("0" * 1_000_000)
        assert await closed(bomb) == aiohttp.WSCloseCode.MESSAGE_TOO_BIG

    served(renderer, model, scenario)


def test_floods_of_what_is_no_message_leave_others_their_turn(renderer, model):
    async def scenario(session, base, server):
        async with view(session, base) as good:
            await good.send_json(RESIZE)
            await rested(good)
            for flood in (frame(PING | FINAL, b"")[:1] + b"\x80" + bytes(4), frame(CONTINUED, b"")):
                reader, writer = await raw_view(base)
                writer.write(frame(TEXT, b""))

                async def send(writer=writer, flood=flood):
                    while True:
                        writer.write(flood * 500)
                        await writer.drain()
                        await asyncio.sleep(0)

                async def drop(reader=reader):
                    while await reader.read(1 << 16):
                        pass

                tasks = [asyncio.create_task(send()), asyncio.create_task(drop())]
                await still_served(good)
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)
                writer.transport.abort()

    served(renderer, model, scenario)


def test_tokens_are_compared_in_constant_time(monkeypatch):
    real, compared = access.hmac.compare_digest, []
    monkeypatch.setattr(
        access.hmac, "compare_digest", lambda a, b: compared.append((a, b)) or real(a, b)
    )
    assert not Access("0.0.0.0", "secret").knows("secreT")
    assert compared == [(b"secreT", b"secret")]


def test_programs_connect_to_the_probe_on_the_same_terms(renderer, model):
    pytest.importorskip("numba", reason="needs the viewer extra")
    model.set_probe(ProbeSettings(light=False))
    extra = {"/probe": stream_handler(model)}

    async def refused(session, url, status, **headers):
        with pytest.raises(aiohttp.WSServerHandshakeError) as error:
            await session.ws_connect(url, headers=headers)
        assert error.value.status == status

    async def scenario(session, base, server):
        await refused(session, base + "/probe", 403, Origin="http://evil.example")
        await refused(session, base + "/probe", 403, Host="evil.example")
        async with session.ws_connect(base + "/probe") as program:
            await refused(session, base + "/probe", 503)
            await program.send_str("[" * 2000)
            assert "error" in await program.receive_json()
            await program.send_str("x" * server_bytes)
            assert await closed(program) == aiohttp.WSCloseCode.MESSAGE_TOO_BIG

    async def outside(session, base, server):
        await refused(session, base + "/probe", 401)
        await refused(session, base + "/probe?token=x", 401)
        await refused(session, base + "/probe?token=secret", 403, Origin="http://evil.example")
        async with session.ws_connect(base + "/probe?token=secret") as program:
            await program.send_str("{}")
            assert await program.receive_json()

    server_bytes = server.LONGEST_MESSAGE + 1
    served(renderer, model, scenario, most=1, extra=extra)
    served(renderer, model, outside, Access("0.0.0.0", "secret"), extra=extra)


def test_the_folder_it_runs_in_gives_no_way_out(tmp_path, monkeypatch):
    """With ``--root .`` names that mean something else than a file of the folder stay shut."""
    home, root = tmp_path / "home", tmp_path / "root"
    for folder in (home, root):
        folder.mkdir()
    (home / "secret.pdb").write_text("ATOM")
    (root / "mine.pdb").write_text("ATOM")
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(root)
    files = Files.of(SceneFile(), ".")
    assert files.may_open("mine.pdb")
    # a home; a download; the server's standard input
    for path in ("~/secret.pdb", "~", "~nobody/x", "1abc", "pdb_00001abc", "-"):
        assert not files.may_open(path), path
        for load in (LoadOptions(trajectory=path), LoadOptions(structures=path)):
            with pytest.raises(SettingsError, match="not among the files"):
                files.check(SceneFile(load=load))
    files.check(SceneFile(load=LoadOptions(trajectory="mine.pdb")))


def test_a_scene_file_of_the_root_cannot_have_another_file_read(tmp_path, monkeypatch, model):
    """Not even read and then not shown, as large files are beside the pages."""
    monkeypatch.setattr("scuro.viewer.restyle.LARGE_FILES", 0)
    read = []
    monkeypatch.setattr(SceneFile, "scene", lambda document: read.append(document))
    root, outside = tmp_path / "root", tmp_path / "secret.pdb"
    root.mkdir()
    outside.write_text("ATOM")
    (root / "scene.toml").write_text(f"scuro = 1\n[[input]]\npath = {json.dumps(str(outside))}\n")
    files = Files.of(model.document, str(root))
    guarded = Model(model.document, model.scene, guard=files.check)
    assert not guarded.open_path(str(root / "scene.toml"))
    assert "not among the files" in guarded.message and guarded.restyle is None and not read


def test_serve_binds_to_this_machine_and_guards_its_files(monkeypatch):
    runs = []
    monkeypatch.setattr(server, "run", lambda made, host, port, ready: runs.append((made, host)))
    assert CliRunner().invoke(command, ["sample:1hpv"]).exit_code == 0
    made, host = runs[0]
    assert host == "127.0.0.1" and made._access.token is None and made._most == 8
    screen = made._make_screen(lambda name, write: "")
    for beside in (False, True):
        screen.view.model.message = ""
        assert not screen.view.model.open_path("/etc/passwd", beside)
        assert "not among the files" in screen.view.model.message
    screen.close()
    assert CliRunner().invoke(command, ["sample:1hpv", "--host", "0.0.0.0"]).exit_code == 0
    assert runs[1][0]._access.token
