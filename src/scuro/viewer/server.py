"""The viewer in browsers: one page, one screen; all pages share the scene.

What keeps it safe is in ``access`` and in the limits below; docs/security.md states it for people.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files as resource_files
from typing import TYPE_CHECKING, Any

from scuro.errors import MissingExtraError, ScuroError
from scuro.viewer.access import COOKIE, Access
from scuro.viewer.listening import listening
from scuro.viewer.remote import Remote, read_event
from scuro.viewer.screen import Screen

if TYPE_CHECKING:
    from aiohttp import web

log = logging.getLogger("scuro.serve")

MOST_CLIENTS = 8
"""Pages at once, unless told otherwise."""
LONGEST_MESSAGE = 4096
"""Bytes of a page's message."""
MESSAGES = 400
"""Messages a second that a page may send for long; twice as many in a burst."""
MOST_FAULTS = 20
"""Messages without sense after which a page is sent away."""
_HEARTBEAT = 20.0
"""Seconds between two questions whether a page is still there."""
_SLOWEST_SEND = 30.0
"""Seconds after which a page that does not take its picture is given up."""
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' blob: data:; connect-src 'self'; frame-ancestors 'none'; "
    "base-uri 'none'; form-action 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
_PAGE = {
    "/": ("web/index.html", "text/html"),
    "/client.js": ("web/client.js", "text/javascript"),
    "/client.css": ("web/client.css", "text/css"),
}


def _pages() -> dict[str, tuple[str, str]]:
    """Text and MIME type by path: nothing else can be fetched."""
    own = resource_files("scuro.viewer")
    pages = {
        path: (own.joinpath(name).read_text("utf-8"), kind) for path, (name, kind) in _PAGE.items()
    }
    script = resource_files("rendercanvas.core").joinpath("renderview.js").read_text("utf-8")
    return pages | {"/renderview.js": (script, "text/javascript")}


@dataclass
class _Budget:
    """A bucket of messages that fills up with time."""

    left: float = 2.0 * MESSAGES
    at: float = 0.0

    def spend(self, now: float) -> bool:
        """Take one message; False if there is none left."""
        self.left = min(2.0 * MESSAGES, self.left + (now - self.at) * MESSAGES) - 1
        self.at = now
        return self.left >= 0


class Server:
    """Serves screens.

    Args:
        make_screen: Makes the screen of a page, given how it delivers files.
        access: Who may connect.
        most_clients: Pages at once.
        extra: Further WebSocket handlers by path, for programs that are no browsers.
    """

    def __init__(
        self,
        make_screen: Callable[[Any], Screen],
        access: Access,
        most_clients: int = MOST_CLIENTS,
        extra: dict[str, Callable[[Any], Any]] | None = None,
    ) -> None:
        self._make_screen = make_screen
        self._access = access
        self._most = most_clients
        self._extra = extra or {}
        self._pages = _pages()
        self.clients = 0

    def application(self) -> web.Application:
        """The web application."""
        from aiohttp import web

        app = web.Application(middlewares=[self._middleware()], client_max_size=LONGEST_MESSAGE)
        for path in self._pages:
            app.router.add_get(path, self._page)
        app.router.add_get("/view", self._view)
        for path, handler in self._extra.items():
            app.router.add_get(path, self._program(handler))
        return app

    def _middleware(self) -> Any:
        from aiohttp import web

        @web.middleware
        async def guard(request: web.Request, handler: Any) -> web.StreamResponse:
            if not self._access.right_host(request.headers):
                raise web.HTTPForbidden(text="this name does not lead here", headers=_HEADERS)
            given = request.query.get("token") or request.cookies.get(COOKIE)
            if not self._access.knows(given):
                raise web.HTTPUnauthorized(
                    text="open the link with its token that scuro printed", headers=_HEADERS
                )
            response: web.StreamResponse = await handler(request)
            if not response.prepared:
                response.headers.update(_HEADERS)
            return response

        return guard

    async def _page(self, request: web.Request) -> web.Response:
        from aiohttp import web

        if "token" in request.query:
            # keep the token out of the address bar, the history and the Referer
            moved = web.HTTPFound(request.path, headers=_HEADERS)
            moved.set_cookie(COOKIE, request.query["token"], httponly=True, samesite="Strict")
            raise moved
        text, kind = self._pages[request.path]
        return web.Response(text=text, content_type=kind)

    def _program(self, handler: Callable[[Any], Any]) -> Callable[[web.Request], Any]:
        async def connect(request: web.Request) -> web.WebSocketResponse:
            socket = await self._connect(request, browser=False)
            try:
                await handler(socket)
            finally:
                self.clients -= 1
            return socket

        return connect

    async def _connect(self, request: web.Request, browser: bool) -> web.WebSocketResponse:
        from aiohttp import web

        if not self._access.right_origin(request.headers, required=browser):
            raise web.HTTPForbidden(text="only pages of this viewer may connect", headers=_HEADERS)
        if self.clients >= self._most:
            raise web.HTTPServiceUnavailable(
                text=f"all {self._most} places are taken", headers=_HEADERS
            )
        socket = web.WebSocketResponse(max_msg_size=LONGEST_MESSAGE, heartbeat=_HEARTBEAT)
        self.clients += 1
        try:
            await socket.prepare(request)
        except BaseException:
            self.clients -= 1
            raise
        return socket

    async def _view(self, request: web.Request) -> web.WebSocketResponse:
        from aiohttp import WSCloseCode

        socket = await self._connect(request, browser=True)
        remote = None
        try:
            remote = Remote(self._make_screen)
            painter = asyncio.create_task(_paint(socket, remote))
            listener = asyncio.create_task(_listen(socket, remote))
            done, pending = await asyncio.wait(
                (painter, listener), return_when=asyncio.FIRST_COMPLETED
            )
            for task in pending:
                task.cancel()
            await asyncio.gather(*pending, return_exceptions=True)
            faults = [_tell(task.exception()) for task in done]
            if why := next(filter(None, faults), ""):
                await _leave(socket, WSCloseCode.INTERNAL_ERROR, why)
        except ScuroError as error:
            log.warning("a page could not be shown: %s", error)
        finally:
            self.clients -= 1
            if remote is not None:
                remote.close()
            with contextlib.suppress(Exception):
                await asyncio.wait_for(socket.close(), 2)
        return socket


async def _paint(socket: Any, remote: Remote) -> None:
    """Send pictures when there is something new, no faster than they are taken."""
    while not socket.closed:
        await remote.due()
        for message in remote.messages():
            send = socket.send_str if isinstance(message, str) else socket.send_bytes
            await asyncio.wait_for(send(message), _SLOWEST_SEND)


async def _listen(socket: Any, remote: Remote) -> None:
    """Act on a page's messages; leave it if it floods or keeps sending nonsense."""
    from aiohttp import WSCloseCode, WSMsgType

    budget, faults = _Budget(), 0
    clock = asyncio.get_running_loop().time
    budget.at = clock()
    async for message in socket:
        if not budget.spend(clock()):
            await _leave(socket, WSCloseCode.POLICY_VIOLATION, "too many messages")
            return
        try:
            if message.type != WSMsgType.TEXT:
                raise ValueError("no text")
            event = read_event(message.data)
        except ValueError:
            faults += 1
            if faults >= MOST_FAULTS:
                await _leave(socket, WSCloseCode.POLICY_VIOLATION, "messages without sense")
                return
            continue
        if event is not None:
            remote.receive(event)


async def _leave(socket: Any, code: int, why: str) -> None:
    with contextlib.suppress(Exception):
        await asyncio.wait_for(socket.close(code=code, message=why.encode()), 2)


def _tell(error: BaseException | None) -> str:
    """Say why a page ended, unless it simply went away; the words for its people."""
    if error is None or isinstance(error, (ConnectionError, TimeoutError)):
        return ""
    log.error("a page ended", exc_info=error)
    return f"a fault of scuro itself, {type(error).__name__}"


def run(server: Server, host: str, port: int, ready: Callable[[int], None]) -> None:
    """Serve until interrupted.

    Args:
        server: What to serve.
        host: Address to bind.
        port: 0 for any free one.
        ready: Called with the port once it is bound.

    Raises:
        ScuroError: The address cannot be bound.
    """
    asyncio.run(_run(server, host, port, ready))


async def _run(server: Server, host: str, port: int, ready: Callable[[int], None]) -> None:
    async with contextlib.AsyncExitStack() as stack:
        try:
            bound = await stack.enter_async_context(listening(server.application(), host, port))
        except OSError as error:
            raise ScuroError(
                f"cannot listen on {host}:{port} ({error.strerror}): choose another --port"
            ) from None
        ready(bound)
        await asyncio.Event().wait()


def need_web() -> None:
    """See that what serving needs is installed.

    Raises:
        MissingExtraError: It is not.
    """
    try:
        import aiohttp  # noqa: F401
        import imgui_bundle  # noqa: F401
        import rendercanvas  # noqa: F401
    except ImportError:
        raise MissingExtraError("Browser views", "viewer") from None
