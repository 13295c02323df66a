"""What lies over a red-cyan picture, drawn for each eye through its glass.

ImGui's pipeline writes all channels; here each eye has an ImGui context whose pipeline writes red
alone, or green and blue.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scuro.gpu import Gpu
from scuro.viewer.theme import apply_style, load_font

_RED, _GREEN_BLUE = 0x1, 0x6
"""GPUColorWrite bits."""


class Glasses:
    """Draws with ImGui for one eye or the other; nothing is made before the first use.

    Args:
        gpu: Draws it.
        format: Of the textures it is drawn into.
    """

    def __init__(self, gpu: Gpu, format: str) -> None:
        self._gpu, self._format = gpu, format
        self._lenses: dict[int, tuple[Any, Any]] = {}

    def draw(
        self,
        eye: int,
        target: Any,
        logical: tuple[float, float],
        ratio: float,
        body: Callable[[], None],
    ) -> None:
        """Draw over what the target holds, in an eye's channels.

        Args:
            eye: -1 left, 1 right.
            target: Texture view.
            logical: Its width and height in ImGui's pixels.
            ratio: Physical pixels to one of them.
            body: Calls ImGui.
        """
        from imgui_bundle import imgui

        if eye not in self._lenses:
            self._lenses[eye] = self._made(_RED if eye < 0 else _GREEN_BLUE)
        context, backend = self._lenses[eye]
        imgui.set_current_context(context)
        io: Any = imgui.get_io()
        io.display_size, io.display_framebuffer_scale = logical, (ratio, ratio)
        imgui.new_frame()
        try:
            body()
        finally:
            imgui.render()
        encoder = self._gpu.device.create_command_encoder()
        run = encoder.begin_render_pass(
            color_attachments=[{"view": target, "load_op": "load", "store_op": "store"}]
        )
        backend.render(imgui.get_draw_data(), run)
        run.end()
        self._gpu.device.queue.submit([encoder.finish()])

    def _made(self, channels: int) -> tuple[Any, Any]:
        """A context, and what draws it."""
        from imgui_bundle import imgui
        from wgpu.utils.imgui import ImguiWgpuBackend

        context = imgui.create_context()
        imgui.set_current_context(context)
        backend = ImguiWgpuBackend(_Tinted(self._gpu.device, channels), self._format)
        load_font()
        apply_style()
        return context, backend

    def close(self) -> None:
        """Free the contexts."""
        from imgui_bundle import imgui

        for context, _ in self._lenses.values():
            imgui.set_current_context(context)
            imgui.destroy_context(context)
        self._lenses.clear()


class _Tinted:
    """A device whose render pipelines write only some channels."""

    def __init__(self, device: Any, channels: int) -> None:
        self._device, self._channels = device, channels

    def __getattr__(self, name: str) -> Any:
        return getattr(self._device, name)

    def create_render_pipeline(self, *, fragment: dict[str, Any], **rest: Any) -> Any:
        targets = [{**t, "write_mask": self._channels} for t in fragment["targets"]]
        return self._device.create_render_pipeline(
            fragment={**fragment, "targets": targets}, **rest
        )
