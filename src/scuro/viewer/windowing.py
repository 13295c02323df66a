"""Window and level of a volume by dragging, as radiologists know it."""

from __future__ import annotations

from scuro.viewer.model import Model
from scuro.viewer.view import View


def toggle_windowing(view: View) -> None:
    """Drags set window and level of the volume, or turn again."""
    view.windowing = not view.windowing and bool(view.model.scene.volumes)
    view.changed()


def adjust_window(model: Model, wider: float, higher: float) -> None:
    """Change window and level of the volume by shares of its range of values."""
    if not model.scene.volumes:
        return
    low, high = model.scene.volumes[0].volume.value_range
    span = (high - low) or 1.0
    settings = model.settings.volume
    window = span if settings.window is None else settings.window
    level = (low + high) / 2 if settings.level is None else settings.level
    window = min(max(window + wider * span, span / 256), 2 * span)
    level = min(max(level + higher * span, low - span / 2), high + span / 2)
    changed = model.settings.replace(volume__window=window, volume__level=level)
    model.change("window", settings=changed)
