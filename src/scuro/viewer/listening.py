"""Connections to a served viewer: those that say nothing are cut, so that others find a place."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

PATIENCE = 10.0
"""Seconds that a connection may take for its first request, and be idle between two."""


@asynccontextmanager
async def listening(application: Any, host: str, port: int) -> AsyncIterator[int]:
    """Serve a web application as long as the context lasts; gives the port.

    Args:
        application: Of :meth:`scuro.viewer.server.Server.application`.
        host: Address to bind.
        port: 0 for any free one.

    Raises:
        OSError: The address cannot be bound.
    """
    from aiohttp import web

    # aiohttp counts the time for the first request as idle, too; left to itself, it waits an hour
    runner = web.AppRunner(
        application, access_log=None, shutdown_timeout=0.5, keepalive_timeout=PATIENCE
    )
    await runner.setup()
    try:
        await web.TCPSite(runner, host, port).start()
        yield runner.addresses[0][1]
    finally:
        await runner.cleanup()
