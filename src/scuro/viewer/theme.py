"""How the panel and what lies over the picture look: font, colours, distances."""

from __future__ import annotations

from importlib.resources import as_file

from scuro.style.marks import FONT

INK, PAPER = 0xFF26221E, 0xE6FFFFFF
"""Text over pictures and its ground, as ImGui packs colours: alpha, blue, green, red."""
ACCENT = 0xFF2A90FF
"""What is selected, held or measured."""
FONT_SIZE = 15.0
_TEXT, _FAINT = (0.92, 0.925, 0.93), (0.58, 0.60, 0.63)
_GROUND, _FIELD, _RAISED = (0.105, 0.112, 0.125), (0.165, 0.175, 0.195), (0.24, 0.255, 0.285)
_BLUE, _BRIGHT = (0.20, 0.42, 0.66), (0.30, 0.56, 0.86)


def load_font() -> None:
    """The font of pictures' labels."""
    from imgui_bundle import imgui

    with as_file(FONT) as path:
        imgui.get_io().fonts.add_font_from_file_ttf(str(path), FONT_SIZE)


def apply_style() -> None:
    """Dark and flat, so that the picture is what is seen."""
    from imgui_bundle import imgui

    imgui.style_colors_dark()
    style = imgui.get_style()
    style.window_rounding = style.window_border_size = style.popup_border_size = 0.0
    style.frame_rounding = style.grab_rounding = style.popup_rounding = 3.0
    style.scrollbar_size, style.grab_min_size = 11.0, 9.0
    style.window_padding = imgui.ImVec2(10, 8)
    style.frame_padding = imgui.ImVec2(7, 3)
    style.item_spacing = imgui.ImVec2(7, 5)
    style.item_inner_spacing = imgui.ImVec2(6, 4)
    style.indent_spacing = 14.0
    style.separator_text_border_size = 1.0
    colors = {
        "text": _TEXT, "text_disabled": _FAINT,
        "window_bg": _GROUND, "popup_bg": (0.13, 0.14, 0.155),
        "frame_bg": _FIELD, "frame_bg_hovered": _RAISED, "frame_bg_active": _RAISED,
        "button": _RAISED, "button_hovered": _BLUE, "button_active": _BRIGHT,
        "header": (0.155, 0.165, 0.185), "header_hovered": _RAISED, "header_active": _BLUE,
        "slider_grab": _BRIGHT, "slider_grab_active": (0.45, 0.68, 0.95),
        "check_mark": (0.45, 0.70, 1.0), "plot_histogram": _BLUE,
        "tab": _GROUND, "tab_hovered": _BLUE, "tab_selected": _BLUE,
        "title_bg": _GROUND, "title_bg_active": _GROUND, "title_bg_collapsed": _GROUND,
        "separator": _RAISED,
    }  # fmt: skip
    for name, (r, g, b) in colors.items():
        style.set_color_(getattr(imgui.Col_, name), imgui.ImVec4(r, g, b, 1.0))
