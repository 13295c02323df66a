"""How rays are cast through a reservoir, and how it is lit."""

from __future__ import annotations

from scuro.settings import SettingsGroup, setting


class StrategySettings(SettingsGroup):
    """Ray casting through corner-point cells (Campagnolo 2021, chapter 4)."""

    technique: str = setting(
        "libc",
        "libc: cell by cell, linear between entry and exit",
        choices=("libc",),
        main=True,
    )
    step: float = setting(
        0.125, "distance between samples, in a cell's least mean extent", low=0.005, high=4
    )
    cutoff: float = setting(0.01, "rays end at this transparency", low=0, high=0.5)
    fast: bool = setting(True, "libc: integrate each cell's segment by tables, not by samples")
