"""Lights: directional, point and spot, placed relative to the camera or to the world."""

from __future__ import annotations

from dataclasses import dataclass

from scuro.errors import SettingsError
from scuro.settings import SettingsGroup, setting

DIRECTIONAL, POINT, SPOT = "directional", "point", "spot"
KINDS = (DIRECTIONAL, POINT, SPOT)


class Light(SettingsGroup):
    """One light."""

    kind: str = setting(DIRECTIONAL, "what it is", choices=KINDS)
    direction: tuple[float, float, float] = setting(
        (0.0, 0.0, -1.0), "the way the light travels (directional and spot)"
    )
    position: tuple[float, float, float] = setting(
        (0.0, 0.0, 0.0),
        "place of a point or spot light: in the world, or as the camera sees it, "
        "eye at the origin, looking along -z",
    )
    color: tuple[float, float, float] = setting((1.0, 1.0, 1.0), "linear RGB", low=0)
    intensity: float = setting(1.0, "strength", low=0)
    attenuation: tuple[float, float, float] = setting(
        (1.0, 0.0, 0.0),
        "constant, linear and quadratic: light falls off as 1/(c + l d + q d²)",
        low=0,
    )
    reach: float | None = setting(
        None, "no light beyond this distance (point and spot)", low=0, switch=True
    )
    cone: float = setting(30.0, "half-angle of a spot's full light", low=0, high=180, unit="deg")
    fade: float = setting(
        10.0, "angle over which a spot goes from full to none", low=0, high=180, unit="deg"
    )
    relative_to: str = setting(
        "camera", "what it is placed by and moves with", choices=("camera", "world")
    )
    shadow: bool = setting(True, "casts shadows when shadows are on")
    size: float = setting(
        0.0,
        "for soft shadows: angular radius in degrees (directional), radius (others)",
        low=0,
    )
    name: str = setting("", "name, for people")

    def __post_init__(self) -> None:
        super().__post_init__()
        who = f"light '{self.name or self.kind}'"
        if self.kind != POINT and not any(self.direction):
            raise SettingsError(f"{who} has no direction")
        if not any(self.attenuation):
            raise SettingsError(f"{who} needs an attenuation factor that is not zero")


@dataclass(frozen=True)
class Lighting:
    """All the light of a scene: lights, and an ambient term that occlusion darkens."""

    lights: tuple[Light, ...]
    ambient: float = 0.4
    """Strength of the ambient term."""
    ambient_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Linear RGB of the ambient light."""
