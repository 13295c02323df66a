"""A screen in a window of the desktop, or in a cell of a notebook: any canvas of rendercanvas."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from scuro.errors import MissingExtraError, ScuroError
from scuro.render import Renderer
from scuro.viewer.gamepad import LOOKING, Gamepad
from scuro.viewer.model import Model
from scuro.viewer.screen import Screen

_EVENTS = (
    "pointer_down", "pointer_up", "pointer_move", "pointer_leave", "double_click", "wheel",
    "key_down", "key_up", "char",
)  # fmt: skip


def attach(canvas: Any, loop: Any, model: Model, renderer: Renderer) -> Screen:
    """Show a model on a canvas: draw when something changed, and only then."""
    context = canvas.get_wgpu_context()
    gpu = renderer.gpu
    # our pictures hold encoded colour: an sRGB target would encode it twice
    format = context.get_preferred_format(gpu.device.adapter).removesuffix("-srgb")
    context.configure(device=gpu.device, format=format)
    screen = Screen(model, renderer, format, save_beside)

    shown: list[Any] = [None]

    def draw() -> None:
        asked = (*canvas.get_logical_size(), canvas.get_pixel_ratio())
        if asked != shown[0]:
            # also where a window is taken to a sharper screen and keeps its size
            screen.resize(*asked)
            shown[0] = asked
        screen.draw(context.get_current_texture())
        again()

    def again() -> None:
        wait = screen.wait
        if wait == 0.0:
            canvas.request_draw()
        elif wait is not None:
            loop.call_later(wait, canvas.request_draw)

    def handle(event: dict[str, Any]) -> None:
        screen.take(event)
        canvas.request_draw()

    canvas.add_event_handler(handle, *_EVENTS)
    canvas.add_event_handler(lambda event: screen.close(), "close")
    screen.view.changed = canvas.request_draw
    canvas.request_draw(draw)
    return screen


def save_beside(name: str, write: Callable[[Path], None]) -> str:
    """Write a file into the working directory under a name that is free."""
    path = Path(name)
    count = 1
    while path.exists():
        count += 1
        path = Path(name).with_stem(f"{Path(name).stem}-{count}")
    write(path)
    return f"saved {path}"


def open_window(model: Model, renderer: Renderer) -> Screen:
    """A window of the desktop.

    Raises:
        MissingExtraError: The libraries are not installed.
        ScuroError: There is no desktop.
    """
    if sys.platform == "linux" and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        raise ScuroError("there is no display for a window: use 'scuro serve' and a browser")
    try:
        from rendercanvas.glfw import RenderCanvas, loop
    except ImportError:
        raise MissingExtraError("Viewer windows", "viewer") from None
    except Exception as error:
        raise ScuroError(
            f"no window can be opened ({error}): use 'scuro serve' and a browser"
        ) from None
    name = ", ".join(Path(line.path).name for line in model.document.input)
    canvas = RenderCanvas(
        size=model.settings.size, title=f"{name} · scuro", update_mode="ondemand", max_fps=60
    )
    screen = attach(canvas, loop, model, renderer)
    pad = Gamepad()

    def look() -> None:
        if canvas.get_closed():
            return
        event, wait = pad.look()
        if event is not None:
            screen.take(event)
            canvas.request_draw()
        loop.call_later(wait, look)

    loop.call_later(LOOKING, look)
    return screen


def run_windows() -> None:
    """Run until the last window is closed."""
    from rendercanvas.glfw import loop

    loop.run()
