"""How long pages of a served viewer wait for each other while the scene is worked on."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import time
from collections.abc import Callable
from typing import Any

from scuro.viewer.model import Model
from scuro.viewer.screen import Screen

_STEP = 0.05
"""Seconds between two moves of the onlooker's hand."""


async def gaps(
    model: Model,
    make_screen: Callable[[Any], Screen],
    deeds: dict[str, Callable[[], Any]],
    size: tuple[int, int],
    most: float,
) -> dict[str, float]:
    """The longest time between two pictures of a page that turns, while another page works.

    Args:
        model: The scene of both pages.
        make_screen: Makes a page's screen.
        deeds: What is done to the scene, by name.
        size: Width and height of the onlooker's page.
        most: Seconds for each, the other page's refining included.

    Returns:
        Seconds by name.
    """
    import aiohttp
    from aiohttp import web

    from scuro.viewer.access import Access
    from scuro.viewer.server import Server

    server = Server(make_screen, Access.for_host("127.0.0.1"))
    runner = web.AppRunner(server.application(), access_log=None, shutdown_timeout=0.5)
    await runner.setup()
    try:
        await web.TCPSite(runner, "127.0.0.1", 0).start()
        address = f"http://127.0.0.1:{runner.addresses[0][1]}"
        origin = {"Origin": address}
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(address + "/view", headers=origin, max_msg_size=0) as actor,
            session.ws_connect(address + "/view", headers=origin, max_msg_size=0) as looker,
        ):
            works = asyncio.create_task(_take(actor, size, []))
            seen: list[float] = []
            looks = asyncio.create_task(_take(looker, size, seen))
            turns = asyncio.create_task(_turn(looker))
            found = {}
            try:
                await asyncio.sleep(3)
                for name, deed in deeds.items():
                    seen.clear()
                    seen.append(time.perf_counter())
                    deed()
                    await _done(model, most)
                    seen.append(time.perf_counter())
                    found[name] = max(b - a for a, b in itertools.pairwise(seen))
            finally:
                for task in (works, looks, turns):
                    task.cancel()
                await asyncio.gather(works, looks, turns, return_exceptions=True)
            return found
    finally:
        await runner.cleanup()


async def _done(model: Model, most: float) -> None:
    """Until nothing is read or built beside the pages, and some seconds of refining more."""
    end = time.perf_counter() + most
    while model.restyle is not None and time.perf_counter() < end:
        await asyncio.sleep(0.2)
    await asyncio.sleep(0.3 * most)


async def _take(page: Any, size: tuple[int, int], seen: list[float]) -> None:
    """Take all pictures of a page, noting when."""
    message = {"type": "resize", "width": size[0], "height": size[1], "ratio": 1, "modifiers": []}
    await page.send_str(json.dumps(message))
    with contextlib.suppress(TypeError, ValueError):
        while True:
            header = json.loads(await page.receive_str())
            await page.receive_bytes()
            seen.append(time.perf_counter())
            shown = {"type": "shown", "index": header["index"], "modifiers": []}
            await page.send_str(json.dumps(shown))


async def _turn(page: Any) -> None:
    """A hand that turns the scene for ever."""
    event = {"x": 200, "y": 200, "button": 1, "modifiers": []}
    await page.send_str(json.dumps({"type": "pointer_down", **event}))
    step = 0
    while True:
        step += 1
        moved = {**event, "type": "pointer_move", "x": 200 + 3 * (step % 40), "button": 0}
        await page.send_str(json.dumps(moved))
        await asyncio.sleep(_STEP)
