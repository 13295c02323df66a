"""What of a reservoir is shown: its property, time step, cells, and vertical exaggeration."""

from __future__ import annotations

from scuro.errors import SettingsError
from scuro.settings import SettingsGroup, setting


def _check_slices(value: str) -> None:
    parse_slices(value)


def parse_slices(text: str) -> list[tuple[int, int]]:
    """Read ``i12 k3`` into pairs of axis (0 to 2) and one-based number.

    Raises:
        SettingsError: A word is not a letter i, j or k and a number.
    """
    found = []
    for word in text.replace(",", " ").split():
        axis, number = "ijk".find(word[0].lower()), word[1:]
        if axis < 0 or not number.isdigit() or int(number) < 1:
            raise SettingsError(f"a slice is i, j or k and a number from 1, e.g. k3, not '{word}'")
        found.append((axis, int(number)))
    return found


def parse_box(text: str) -> list[tuple[int, int, int]]:
    """Read ``i=5:20 k=1:3`` into axis, first and last number, one-based and inclusive.

    Raises:
        SettingsError: A word is not of that form.
    """
    found = []
    for word in text.replace(",", " ").split():
        axis, equals, numbers = word.partition("=")
        first, _, last = numbers.partition(":")
        last = last or first
        if axis.lower() not in ("i", "j", "k") or not equals or not (first + last).isdigit():
            raise SettingsError(f"a box is like i=5:20 k=1:3, not '{word}'")
        found.append(("ijk".index(axis.lower()), int(first), int(last)))
    return found


def _check_box(value: str) -> None:
    parse_box(value)


class ReservoirSettings(SettingsGroup):
    """Reservoirs: what is shown."""

    show: str = setting(
        "auto",
        "volume: see into the cells; cells: their opaque outer faces; slices; iso; auto: cells",
        choices=("auto", "volume", "cells", "slices", "iso"),
        main=True,
    )
    property: str = setting("auto", "which property, e.g. SWAT; auto: SOIL, SWAT, PORO or the like")
    time: int = setting(-1, "time step, from 0; negative numbers count from the last")
    exaggeration: float | None = setting(None, "factor on heights", low=0.01, high=1000)
    transfer: str = setting(
        "auto", "colour and opacity: auto, a colormap's name, or a transfer function's file"
    )
    opacity: str = setting("", "opacity points instead of the transfer function's: '0.2:0 0.8:0.4'")
    low: float | None = setting(None, "show no cells with values below this", switch=True)
    high: float | None = setting(None, "show no cells with values above this", switch=True)
    box: str = setting("", "show no cells outside, e.g. 'i=5:20 k=1:3'", check=_check_box)
    slices: str = setting("", "layers that 'slices' shows, e.g. 'k3 i12'", check=_check_slices)
    iso: float | None = setting(None, "value of the surface that 'iso' shows; auto: the middle")
    lines: bool | None = setting(
        None, "draw cells' edges; auto: of opaque cells that are large enough to keep them apart"
    )
    faults: bool = setting(False, "draw the faces at which faults split the model")
    wells: bool = setting(True, "draw wells, where the files hold them")
