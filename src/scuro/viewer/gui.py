"""Dear ImGui in one view: its context, its input, its drawing into a texture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scuro.errors import MissingExtraError
from scuro.gpu import Gpu
from scuro.viewer.theme import apply_style, load_font

_SETTLING = 3
"""Frames after an event until ImGui's layout has settled."""
_MOST_TURNS = 16
"""Frames in which ImGui is to come to an event: as many keys may have come before it."""
_BLINK, _TOOLTIP = 0.4, 0.5
"""Seconds between blinks of a text cursor, and until a tooltip shows."""


class Gui:
    """One ImGui context that draws with a GPU of ours.

    Args:
        gpu: Draws it.
        format: Of the textures it is drawn into.

    Raises:
        MissingExtraError: imgui-bundle is not installed.
    """

    def __init__(self, gpu: Gpu, format: str) -> None:
        try:
            from imgui_bundle import imgui
            from wgpu.utils.imgui import ImguiRenderer, ImguiWgpuBackend
        except ImportError:
            raise MissingExtraError("Viewer windows", "viewer") from None
        self._imgui = imgui
        self._gpu = gpu
        self._context = imgui.create_context()
        self._enter()
        self._backend = ImguiWgpuBackend(gpu.device, format)
        self._keys = ImguiRenderer.KEY_MAP
        self._modifiers = ImguiRenderer.KEY_MAP_MOD
        load_font()
        apply_style()
        self._fresh = _SETTLING
        self._quiet = True
        self._place = (-1.0, -1.0)
        self._judged = False
        """Whether a frame has found what is at the place."""
        self._body: Callable[[], None] | None = None

    def _enter(self) -> None:
        """Several views share the process: ImGui has one current context."""
        self._imgui.set_current_context(self._context)

    def handle(self, event: dict[str, Any]) -> bool:
        """Offer an event of rendercanvas; whether the panel takes it."""
        self._enter()
        self._fresh, self._quiet = _SETTLING, False
        io = self._backend.io
        kind = event["event_type"]
        if kind in ("pointer_down", "pointer_up", "pointer_move", "pointer_leave", "double_click"):
            if kind == "pointer_leave":
                io.add_mouse_pos_event(-1e9, -1e9)
                return False
            self._point(event, kind == "pointer_down")
            if kind in ("pointer_down", "pointer_up") and 1 <= event["button"] <= 3:
                io.add_mouse_button_event(event["button"] - 1, kind == "pointer_down")
            return bool(io.want_capture_mouse)
        if kind == "wheel":
            self._point(event, True)
            io.add_mouse_wheel_event(-event["dx"] / 100, -event["dy"] / 100)
            return bool(io.want_capture_mouse)
        if kind in ("key_down", "key_up"):
            if event["key"] == "Escape" and kind == "key_down" and self._close_menu():
                return True
            self._key(event["key"], kind == "key_down")
            return bool(io.want_text_input)
        if kind == "char":
            io.add_input_characters_utf8(event.get("data") or event.get("char_str") or "")
            return bool(io.want_text_input)
        return False

    def _close_menu(self) -> bool:
        """Close the menu that is open; whether there was one.

        ImGui itself does so only where keys walk through its controls, too.
        """
        imgui = self._imgui
        if not imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
            return False
        imgui.internal.close_popup_to_level(0, False)
        return True

    def _point(self, event: dict[str, Any], decide: bool) -> None:
        """Tell where the pointer is; ``decide`` at once whether it is over the panel.

        ImGui finds out in its next frame, or a later one: keys that came before it takes one by
        one. A finger, which comes from nowhere, a wheel, or a press while a slow picture keeps that
        frame waiting, must not be judged by where the pointer was before.
        """
        place = (event["x"], event["y"])
        self._backend.io.add_mouse_pos_event(*place)
        self._judged &= place == self._place
        if decide and not self._judged and self._body is not None:
            for _ in range(_MOST_TURNS):
                self._imgui.new_frame()
                self._body()
                self._imgui.end_frame()
                x, y = self._imgui.get_mouse_pos()
                if max(abs(x - place[0]), abs(y - place[1])) < 1:  # it keeps whole pixels
                    break
            self._judged = True
        self._place = place

    def _key(self, name: str, down: bool) -> None:
        imgui, io = self._imgui, self._backend.io
        if name in self._modifiers:
            io.add_key_event(self._modifiers[name], down)
        key = self._keys.get(name)
        if key is None and len(name) == 1 and name.isascii() and name.isalnum():
            digit = name.isdigit()
            first = imgui.Key._0 if digit else imgui.Key.a
            key = imgui.Key(first.value + ord(name.lower()) - ord("0" if digit else "a"))
        if key is not None:
            io.add_key_event(key, down)

    @property
    def wait(self) -> float | None:
        """Seconds until the interface changes by itself; ``None`` if it does not.

        It settles within a few frames of an event; a tooltip comes a moment after the pointer has
        stopped; a text cursor blinks.
        """
        self._enter()
        if self._fresh > 0:
            return 0.0
        if self._imgui.get_io().want_text_input:
            return _BLINK
        return None if self._quiet else _TOOLTIP

    @property
    def over(self) -> bool:
        """Whether the pointer was over the interface in the last frame."""
        self._enter()
        return bool(self._backend.io.want_capture_mouse)

    def draw(
        self, target: Any, logical: tuple[float, float], ratio: float, body: Callable[[], None]
    ) -> None:
        """Draw over what the target holds.

        Args:
            target: Texture view.
            logical: Width and height in the events' pixels.
            ratio: Physical pixels of the target to one of them.
            body: Calls ImGui.
        """
        self._enter()
        imgui = self._imgui
        if self._fresh > 0:
            self._fresh -= 1
        else:
            self._quiet = True
        io = self._backend.io
        self._body = body
        io.display_size = logical
        io.display_framebuffer_scale = (ratio, ratio)
        imgui.new_frame()
        try:
            body()
        finally:
            imgui.render()
        self._judged = True
        encoder = self._gpu.device.create_command_encoder()
        run = encoder.begin_render_pass(
            color_attachments=[{"view": target, "load_op": "load", "store_op": "store"}]
        )
        self._backend.render(imgui.get_draw_data(), run)
        run.end()
        self._gpu.device.queue.submit([encoder.finish()])

    def close(self) -> None:
        """Free the context."""
        self._enter()
        self._imgui.destroy_context(self._context)
