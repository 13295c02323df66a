"""From words on the command line to a transfer function."""

from __future__ import annotations

from pathlib import Path

from scuro.errors import SettingsError
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction, from_colormap, from_window
from scuro.style.transfer_auto import automatic
from scuro.style.transfer_files import SUFFIXES, read_transfer


def choose_transfer(
    volume: Volume,
    transfer: str = "auto",
    opacity: str = "",
    window: float | None = None,
    level: float | None = None,
) -> TransferFunction:
    """The transfer function that the settings ask for.

    Args:
        volume: What it is for.
        transfer: ``auto``, a file (``FILE:PRESET``) or a colormap's name.
        opacity: Points ``value:opacity`` that replace the opacities.
        window: Width of a window of values; colours are then ``transfer``'s colormap or grey.
        level: Its middle; the middle of the data's range by default.

    Raises:
        SettingsError: a word is not understood.
        LoadError: the file cannot be read.
    """
    low, high = volume.value_range
    path, _, preset = transfer.partition(":")
    if window is not None or level is not None:
        width = (high - low) if window is None else window
        colormap = "gray" if transfer == "auto" else transfer
        made = from_window(width, (low + high) / 2 if level is None else level, colormap)
    elif transfer == "auto":
        made = automatic(volume)
    elif Path(path).suffix.lower() in SUFFIXES:
        made = read_transfer(path, volume, preset or None)
    else:
        made = from_colormap(transfer, (low, high), automatic(volume).opacities)
    points = opacity_points(opacity)
    return made.with_opacities(points) if points else made


def opacity_points(text: str) -> list[tuple[float, float]]:
    """Points of ``"40:0 90:0.8"``; empty for empty text."""
    points = []
    for word in text.replace(",", " ").split():
        value, colon, opacity = word.partition(":")
        try:
            points.append((float(value), float(opacity)))
        except ValueError:
            colon = ""
        if not colon:
            raise SettingsError(
                f"opacity points are written value:opacity, as in '40:0 90:0.8', not '{word}'"
            )
    return sorted(points)
