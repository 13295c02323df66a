"""A served viewer and its pages, for tests."""

import asyncio
import json

import pytest

from scuro.viewer.access import Access
from scuro.viewer.listening import listening

aiohttp = pytest.importorskip("aiohttp", reason="needs the viewer extra")
pytest.importorskip("imgui_bundle", reason="needs the viewer extra")

from scuro.viewer.screen import Screen  # noqa: E402
from scuro.viewer.server import Server  # noqa: E402

RESIZE = {"type": "resize", "width": 700.0, "height": 64.0, "ratio": 1.0}


def served(renderer, model, scenario, access=None, most=3, extra=None):
    """Run ``scenario(session, base, server)`` against a server of its own."""

    async def main():
        server = Server(
            lambda deliver: Screen(model, renderer, "rgba8unorm", deliver),
            access or Access.for_host("127.0.0.1"),
            most,
            extra,
        )
        async with (
            listening(server.application(), "127.0.0.1", 0) as port,
            aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as session,
        ):
            await asyncio.wait_for(scenario(session, f"http://127.0.0.1:{port}", server), 60)

    asyncio.run(main())


def view(session, base, origin="own", **options):
    headers = {} if origin is None else {"Origin": base if origin == "own" else origin}
    return session.ws_connect(base + "/view", headers=headers, max_msg_size=0, **options)


async def picture(socket, timeout=30):
    """The next picture's header and bytes."""
    header = json.loads((await socket.receive(timeout)).data)
    data = (await socket.receive(timeout)).data
    if header["type"] == "picture":
        await socket.send_json({"type": "shown", "index": header["index"]})
    return header, data


async def rested(socket):
    """Pictures until the lossless one."""
    while True:
        header, data = await picture(socket)
        if header.get("mimetype") == "image/png":
            return data


async def closed(socket):
    """The code a socket is closed with."""
    async for _ in socket:
        pass
    return socket.close_code
