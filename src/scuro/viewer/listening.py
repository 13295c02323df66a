"""Connections to a served viewer: those that say nothing are cut, so that others find a place."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

PATIENCE = 10.0
"""Seconds that a connection may take for its first request, and be idle between two."""


class _Silence:
    """The connections that did not ask for anything yet."""

    def __init__(self) -> None:
        self._silent: set[Any] = set()

    def connections(self, make: Callable[[], Any]) -> Callable[[], Any]:
        """Make connections, and cut each that does not speak in time."""

        def connection() -> Any:
            made = make()
            self._silent.add(made)
            asyncio.get_running_loop().call_later(PATIENCE, self._cut, made)
            return made

        return connection

    def middleware(self) -> Any:
        """Notes who spoke."""
        from aiohttp import web

        @web.middleware
        async def heard(request: web.Request, handler: Any) -> web.StreamResponse:
            self._silent.discard(request.protocol)
            response: web.StreamResponse = await handler(request)
            return response

        return heard

    def _cut(self, connection: Any) -> None:
        if connection in self._silent:
            self._silent.discard(connection)
            if connection.transport is not None:
                connection.transport.abort()


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

    silence = _Silence()
    application.middlewares.insert(0, silence.middleware())
    runner = web.AppRunner(
        application, access_log=None, shutdown_timeout=0.5, keepalive_timeout=PATIENCE
    )
    await runner.setup()
    listener = None
    try:
        assert runner.server is not None
        make = silence.connections(runner.server)
        listener = await asyncio.get_running_loop().create_server(make, host, port)
        yield listener.sockets[0].getsockname()[1]
    finally:
        if listener is not None:
            listener.close()
        await runner.cleanup()
