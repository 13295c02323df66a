"""Colours by name."""

from __future__ import annotations

from functools import cache

from scuro.errors import SettingsError


@cache
def srgb(color: str) -> tuple[float, float, float, float]:
    """sRGB and opacity, 0 to 1, of a CSS name, a hex code, or ``transparent``."""
    if color.strip().lower() in ("transparent", "none"):
        return (0.0, 0.0, 0.0, 0.0)
    from cmap import Color

    try:
        found = Color(color)
    except (ValueError, TypeError):
        raise SettingsError(
            f"unknown color '{color}': use a CSS name such as 'steelblue', or '#rrggbb'"
        ) from None
    return tuple(found)  # type: ignore[return-value]


def check_color(color: str) -> None:
    """Raise :class:`SettingsError` if a setting names no colour; ``background`` is one."""
    if color not in ("white", "black", "background"):  # known without the list of names
        srgb(color)


def linear_rgba(color: str) -> tuple[float, float, float, float]:
    """Linear RGB and opacity, 0 to 1, of a colour by name."""
    r, g, b, a = srgb(color)
    return (_linear(r), _linear(g), _linear(b), a)


def premultiplied(color: str) -> tuple[float, float, float, float]:
    """Linear RGB times opacity, and opacity."""
    r, g, b, a = linear_rgba(color)
    return (r * a, g * a, b * a, a)


def _linear(c: float) -> float:
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
