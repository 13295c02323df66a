"""How rays are cast through a reservoir, and how it is lit."""

from __future__ import annotations

from scuro.settings import SettingsGroup, setting


class StrategySettings(SettingsGroup):
    """Ray casting through corner-point cells (Campagnolo 2021, chapter 4)."""

    technique: str = setting(
        "libc",
        "srg: a regular grid sampled from the cells; libc: cell by cell, linear between entry and "
        "exit; plts: accurate point location for every sample",
        choices=("srg", "libc", "plts"),
        main=True,
    )
    step: float = setting(
        0.125, "distance between samples, in a cell's least mean extent", low=0.005, high=4
    )
    cutoff: float = setting(0.01, "rays end at this transparency", low=0, high=0.5)
    fast: bool = setting(True, "libc: integrate each cell's segment by tables, not by samples")
    resample: float = setting(
        4.0, "srg: samples per cell along each axis (the thesis's r')", low=0.25, high=32
    )
    occlusion: bool = setting(
        True, "darken what the viewer sees through matter, by the cones of volume.occlusion"
    )
    shadow: bool = setting(
        False,
        "shadows of the lights, by the cones of volume.shadow; also on where surfaces have shadows",
    )
    light_resolution: int = setting(
        160,
        "most voxels of the grid in which light is worked out, along the model's longest side",
        low=16,
        high=512,
    )
