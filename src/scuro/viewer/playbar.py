"""The play bar: at the lower edge of the picture, where there is something to play."""

from __future__ import annotations

from scuro.settings import parameters
from scuro.viewer.navigate import Size
from scuro.viewer.player import PlaySettings
from scuro.viewer.view import View

_WIDEST, _NARROWEST = 640.0, 260.0
_MARGIN, _HEIGHT = 16.0, 40.0
_CORNERS = 190.0
"""Pixels that the axis cross and the scale bar take on both sides."""
ABOVE_BAR, _ABOVE_CROSS = 48.0, 98.0
"""Pixels from the picture's lower edge to above them."""


def foot(size: Size) -> float:
    """Pixels below the play bar: in a narrow picture it lies above what the corners hold."""
    if size[0] >= _NARROWEST + 2 * _CORNERS:
        return _MARGIN
    # the scale bar's corner, and where it reaches over there the axis cross', too
    return ABOVE_BAR if size[0] >= _NARROWEST + 2 * _ABOVE_CROSS else _ABOVE_CROSS


def room(size: Size) -> float:
    """Pixels at the foot of a picture of this logical size that the play bar takes up."""
    return foot(size) + _HEIGHT


class PlayBar:
    """One view's buttons and slider for the model's player."""

    def __init__(self, view: View) -> None:
        self.view = view

    def draw(self, size: Size) -> None:
        """Draw it over a picture of this logical size; nothing where nothing plays."""
        from imgui_bundle import imgui

        player = self.view.model.player
        length = player.length
        if length < 2:
            return
        width = min(_WIDEST, max(_NARROWEST, size[0] - 2 * _CORNERS))
        corner = (size[0] / 2, size[1] - foot(size))
        imgui.set_next_window_pos(corner, imgui.Cond_.always, (0.5, 1.0))
        imgui.set_next_window_size((width, 0))
        imgui.set_next_window_bg_alpha(0.88)
        flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
        flags |= imgui.WindowFlags_.no_saved_settings
        imgui.push_style_var(imgui.StyleVar_.window_rounding, 6.0)
        imgui.begin("play", None, flags)
        imgui.pop_style_var()
        self._buttons()
        imgui.same_line()
        imgui.set_next_item_width(-1)
        place = player.place
        moved, wanted = imgui.slider_float("##place", place, 0.0, float(length - 1), "")
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        # over the slider's own text, which cannot be a date
        text = player.caption
        extent = imgui.calc_text_size(text)
        middle = ((low.x + high.x - extent.x) / 2, (low.y + high.y - extent.y) / 2)
        imgui.get_window_draw_list().add_text(middle, 0xFFFFFFFF, text)
        if moved:
            player.stop()
            smooth = player.settings.smooth and player.kind == "frames"
            player.seek(wanted if smooth else float(round(wanted)))
        if imgui.is_item_deactivated_after_edit():
            self.view.model.history.end_gesture()
        imgui.end()

    def _buttons(self) -> None:
        from imgui_bundle import imgui

        player = self.view.model.player
        for name, direction, count in (("back", imgui.Dir.left, -1), ("on", imgui.Dir.right, 1)):
            if count > 0:
                imgui.same_line(0, 3)
                if imgui.button("Stop" if player.playing else "Play", (48, 0)):
                    player.toggle()
                imgui.set_item_tooltip("Space")
                imgui.same_line(0, 3)
            if imgui.arrow_button(name, direction):
                player.step(count)
        imgui.same_line()
        if imgui.button("…"):
            imgui.open_popup("how")
        imgui.set_item_tooltip("Speed, loop, interpolation")
        corner = imgui.get_item_rect_min()
        imgui.set_next_window_pos((corner.x, corner.y - 8), imgui.Cond_.always, (0.0, 1.0))
        if imgui.begin_popup("how"):
            self._how()
            imgui.end_popup()

    def _how(self) -> None:
        from imgui_bundle import imgui

        player = self.view.model.player
        by_name = {p.name: p for p in parameters(PlaySettings)}
        settings = player.settings
        imgui.push_item_width(180)
        changed, speed = imgui.slider_float(
            "frames a second", settings.speed, by_name["speed"].low or 0.1, 60.0, "%.3g",
            imgui.SliderFlags_.logarithmic | imgui.SliderFlags_.always_clamp,
        )  # fmt: skip
        if changed:
            settings = settings.replace(speed=speed)
        loops = list(by_name["loop"].choices or ())
        changed, index = imgui.combo("at the end", loops.index(settings.loop), loops)
        if changed:
            settings = settings.replace(loop=loops[index])
        if player.kind == "frames":
            changed, smooth = imgui.checkbox("between frames, too", settings.smooth)
            if changed:
                settings = settings.replace(smooth=smooth)
        imgui.pop_item_width()
        player.settings = settings
