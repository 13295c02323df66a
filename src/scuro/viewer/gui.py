"""Dear ImGui in one view: its context, its input, its drawing into a texture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scuro.errors import MissingExtraError
from scuro.gpu import Gpu


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
        imgui.style_colors_dark()
        style = imgui.get_style()
        style.window_rounding = style.frame_rounding = 4.0
        style.window_border_size = 0.0
        self._frames = 0

    def _enter(self) -> None:
        """Several views share the process: ImGui has one current context."""
        self._imgui.set_current_context(self._context)

    def handle(self, event: dict[str, Any]) -> bool:
        """Offer an event of rendercanvas; whether the panel takes it."""
        self._enter()
        io = self._backend.io
        kind = event["event_type"]
        if kind in ("pointer_down", "pointer_up", "pointer_move", "pointer_leave", "double_click"):
            if kind == "pointer_leave":
                io.add_mouse_pos_event(-1e9, -1e9)
                return False
            io.add_mouse_pos_event(event["x"], event["y"])
            if kind in ("pointer_down", "pointer_up") and 1 <= event["button"] <= 3:
                io.add_mouse_button_event(event["button"] - 1, kind == "pointer_down")
            return bool(io.want_capture_mouse)
        if kind == "wheel":
            io.add_mouse_wheel_event(-event["dx"] / 100, -event["dy"] / 100)
            return bool(io.want_capture_mouse)
        if kind in ("key_down", "key_up"):
            self._key(event["key"], kind == "key_down")
            return bool(io.want_text_input)
        if kind == "char":
            io.add_input_characters_utf8(event.get("data") or event.get("char_str") or "")
            return bool(io.want_text_input)
        return False

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
    def busy(self) -> bool:
        """Whether something of the panel is held or typed into: it must be drawn again."""
        self._enter()
        return bool(self._imgui.is_any_item_active()) or self._frames < 3

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
        self._frames += 1
        io = self._backend.io
        io.display_size = logical
        io.display_framebuffer_scale = (ratio, ratio)
        imgui.new_frame()
        try:
            body()
        finally:
            imgui.render()
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
