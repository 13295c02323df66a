"""Lights: directional, point and spot, placed relative to the camera or to the world."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scuro.errors import SettingsError

DIRECTIONAL, POINT, SPOT = "directional", "point", "spot"
KINDS = (DIRECTIONAL, POINT, SPOT)


@dataclass(frozen=True)
class Light:
    """One light. Colours are linear RGB; distances in world units; angles in degrees."""

    kind: str = DIRECTIONAL
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    """The way the light travels (directional and spot)."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Point and spot; in view space (eye at the origin, looking along -z) for camera lights."""
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    attenuation: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Constant, linear and quadratic: light falls off as 1/(c + l d + q d²)."""
    reach: float = math.inf
    """No light beyond this distance (point and spot)."""
    cone: float = 30.0
    """Half-angle of a spot's full light."""
    fade: float = 10.0
    """Angle over which a spot goes from full to none."""
    relative_to: str = "camera"
    """``camera`` (moves with it) or ``world``."""
    shadow: bool = True
    """Whether it casts shadows when shadows are on."""
    size: float = 0.0
    """For soft shadows: angular radius in degrees (directional), radius in world units (others)."""
    name: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise SettingsError(f"unknown light '{self.kind}': known: {', '.join(KINDS)}")
        if self.relative_to not in ("camera", "world"):
            raise SettingsError(
                f"a light is relative to 'camera' or 'world', not '{self.relative_to}'"
            )
        numbers = (
            *self.direction, *self.position, *self.color, self.intensity, *self.attenuation,
            self.cone, self.fade, self.size,
        )  # fmt: skip
        if not all(map(math.isfinite, numbers)) or math.isnan(self.reach):
            raise SettingsError(f"light '{self.name or self.kind}' has numbers that are not finite")
        if self.kind != POINT and not any(self.direction):
            raise SettingsError(f"light '{self.name or self.kind}' has no direction")
        if min(self.attenuation) < 0 or not any(self.attenuation):
            raise SettingsError(
                f"light '{self.name or self.kind}' needs attenuation factors that are not negative"
                " and not all zero"
            )


@dataclass(frozen=True)
class Lighting:
    """All the light of a scene: lights, and an ambient term that occlusion darkens."""

    lights: tuple[Light, ...]
    ambient: float = 0.4
    """Strength of the ambient term."""
    ambient_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Linear RGB of the ambient light."""
