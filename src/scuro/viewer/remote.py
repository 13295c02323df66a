"""One browser page: its screen, the pictures it is sent, and what it is allowed to say."""

from __future__ import annotations

import asyncio
import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from scuro.viewer.screen import Screen

EVENTS = {
    "resize": ("width", "height", "ratio"),
    "pointer_down": ("x", "y", "button"),
    "pointer_up": ("x", "y", "button"),
    "pointer_move": ("x", "y", "button"),
    "pointer_leave": (),
    "pointer_enter": (),
    "double_click": ("x", "y", "button"),
    "wheel": ("x", "y", "dx", "dy"),
    "key_down": ("key",),
    "key_up": ("key",),
    "char": ("data",),
    "shown": ("index",),
    "gamepad": ("x", "y", "z", "turn_x", "turn_y"),
}
"""The messages a page may send, and what each must hold."""
IGNORED = frozenset({"show", "hide", "focus_in", "focus_out", "close"})
"""Messages that renderview sends and nobody needs."""
_WORDS = {"key", "data"}
LONGEST_WORD = 64
_FARTHEST = 1e6
_AHEAD = 2
"""Pictures that may be on their way: more would only add to the delay."""
_QUALITY = 85
"""Of JPEG pictures while something moves; the last one is lossless."""
MOST_RATIO = 4.0


def read_event(text: str) -> dict[str, Any] | None:
    """An event of a page as rendercanvas has it; ``None`` for one to be ignored.

    Raises:
        ValueError: It is no event, or holds what an event cannot.
    """
    try:
        message = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError("no JSON") from error
    if not isinstance(message, dict) or not isinstance(message.get("type"), str):
        raise ValueError("no event")
    kind = message["type"]
    if kind in IGNORED:
        return None
    if kind not in EVENTS:
        raise ValueError("unknown event")
    event: dict[str, Any] = {"event_type": kind}
    for name in EVENTS[kind]:
        value = message.get(name)
        if name in _WORDS:
            if not isinstance(value, str) or len(value) > LONGEST_WORD or _broken(value):
                raise ValueError(f"bad {name}")
        elif (
            isinstance(value, bool)
            or not isinstance(value, (int, float))
            or not -_FARTHEST <= value <= _FARTHEST
        ):
            raise ValueError(f"bad {name}")
        event[name] = value
    modifiers = message.get("modifiers", [])
    if not isinstance(modifiers, list) or not all(isinstance(m, str) for m in modifiers):
        raise ValueError("bad modifiers")
    event["modifiers"] = tuple(modifiers[:8])
    return event


def _broken(word: str) -> bool:
    """Whether a word holds half a character (a lone surrogate), which is no text."""
    return any("\ud800" <= letter <= "\udfff" for letter in word)


class Remote:
    """A page's screen and the order of its pictures.

    Args:
        make_screen: Makes the screen, given how it delivers files.
    """

    def __init__(self, make_screen: Callable[[Any], Screen]) -> None:
        self._files: list[tuple[str, bytes]] = []
        self.screen = make_screen(self._keep)
        self.screen.view.changed = self.wake
        self._wake = asyncio.Event()
        self._sent = self._confirmed = 0
        self._texture: Any = None

    def wake(self) -> None:
        """There may be something to draw."""
        self._wake.set()

    def _keep(self, name: str, write: Callable[[Path], None]) -> str:
        """Deliver a file by sending it: nothing is written on this machine to stay."""
        with TemporaryDirectory(prefix="scuro-") as folder:
            path = Path(folder) / name
            write(path)
            self._files.append((name, path.read_bytes()))
        return f"{name} is downloaded"

    def receive(self, event: dict[str, Any]) -> None:
        """Act on an event from :func:`read_event`."""
        if event["event_type"] == "shown":
            self._confirmed = min(max(self._confirmed, int(event["index"])), self._sent)
        elif event["event_type"] == "resize":
            ratio = min(max(event["ratio"], 0.25), MOST_RATIO)
            self.screen.resize(event["width"], event["height"], ratio)
        else:
            self.screen.take(event)
        self.wake()

    async def due(self) -> None:
        """Wait until a picture should be drawn."""
        while True:
            self._wake.clear()
            wait = self.screen.wait
            behind = self._sent - self._confirmed >= _AHEAD
            if min(self.screen.logical) <= 1 or behind:
                wait = None
            if wait == 0.0:
                # let events and other pages have their turn
                await asyncio.sleep(0)
                return
            try:
                await asyncio.wait_for(self._wake.wait(), wait)
            except TimeoutError:
                return

    def messages(self) -> Iterator[str | bytes]:
        """Draw the next picture; give it, and files that were asked for, as messages."""
        gpu, size = self.screen.gpu, self.screen.physical
        if self._texture is None or self._texture.size[:2] != size:
            self._texture = gpu.texture(size, "rgba8unorm", attachment=True, label="screen")
        self.screen.draw(self._texture)
        pixels = gpu.read_texture(self._texture)[..., :3]
        mimetype, data = encoded(pixels, lossless=self.screen.wait is None)
        self._sent += 1
        yield json.dumps({"type": "picture", "mimetype": mimetype, "index": self._sent})
        yield data
        while self._files:
            name, content = self._files.pop(0)
            yield json.dumps({"type": "file", "name": name})
            yield content

    def close(self) -> None:
        """Free what the page held."""
        self.screen.close()


def encoded(pixels: np.ndarray, lossless: bool) -> tuple[str, bytes]:
    """MIME type and bytes of a picture (h, w, 3)."""
    from PIL import Image

    out = io.BytesIO()
    picture = Image.fromarray(np.ascontiguousarray(pixels))
    if lossless:
        picture.save(out, "PNG", compress_level=1)
        return "image/png", out.getvalue()
    picture.save(out, "JPEG", quality=_QUALITY, subsampling=0)
    return "image/jpeg", out.getvalue()
