"""Slice planes: planes across a volume that show its values, alone or within the volume."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scuro.passes.frame import Frame
from scuro.settings import SettingsGroup, setting

_RIM = 1.5
"""Pixels of a slice's coloured rim."""


class PlaneSettings(SettingsGroup):
    """Slice planes: values of the volume, opaque and unlit."""

    x: float | None = setting(
        None, "slice across x at this share of the volume", low=0, high=1, switch=True
    )
    y: float | None = setting(
        None, "slice across y at this share of the volume", low=0, high=1, switch=True
    )
    z: float | None = setting(
        None, "slice across z at this share of the volume", low=0, high=1, switch=True
    )
    alone: bool = setting(True, "show the slices without the volume around them")

    @property
    def places(self) -> tuple[float | None, float | None, float | None]:
        """Where the slices across x, y and z lie; ``None`` for none."""
        return self.x, self.y, self.z

    @property
    def on(self) -> bool:
        """Whether there are any."""
        return self.places != (None, None, None)


def draw_planes(
    frame: Frame, settings: PlaneSettings, volume: Mapping[str, Any], surfaces: bool
) -> Any:
    """Draw the slices over ``color``.

    Args:
        frame: With ``color`` and, if there are ``surfaces``, ``surface``.
        settings: Which.
        volume: What volume.wgsl wants bound.
        surfaces: Whether there are any that may hide slices.

    Returns:
        Texture like ``surface`` with the slices in it, at which rays through the volume end.
    """
    at = tuple(-1.0 if place is None else place for place in settings.places)
    width, height = frame.size
    sliced = frame.target("sliced_surface", "rgba32float")
    color = frame.target("sliced_color", "rgba16float")
    frame.target("volume_depth", "r32float")
    frame.compute(
        "passes/volume/planes.wgsl",
        {
            **volume,
            "planes": {"at": at, "rim": _RIM * frame.scale, "width": width, "height": height},
        },
        constants={"SURFACES": surfaces},
        label="slice planes",
    )
    frame.resources["color"] = color
    return sliced
