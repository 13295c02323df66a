"""Toon shading: light in a few steps, whatever made it."""

from __future__ import annotations

from scuro.settings import SettingsGroup, setting


class ToonSettings(SettingsGroup):
    """Flat tones in place of smooth shading."""

    steps: int = setting(0, "number of tones; 0 shades smoothly", low=0, high=16, main=True)
