"""Light set-ups by name, and their upload."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.camera import Camera
from scuro.scene.lights import DIRECTIONAL, KINDS, Light, Lighting
from scuro.settings import SettingsGroup, setting

MAX_LIGHTS = 16
"""As in wgsl/lights.wgsl."""

_KEY = (0.55, -0.75, -0.85)
"""From the upper left, in front: the habit of illustrators."""

# Strengths of simple, full, soft, gentle and flat are ChimeraX's (std_commands/lighting)
PRESETS: dict[str, Lighting] = {
    "studio": Lighting(
        (
            Light(direction=_KEY, intensity=0.72, name="key"),
            Light(direction=(-0.9, -0.1, -0.6), intensity=0.18, shadow=False, name="fill"),
            Light(direction=(-0.3, -0.6, 0.75), intensity=0.30, shadow=False, name="back"),
        ),
        ambient=0.42,
    ),
    "simple": Lighting(
        (
            Light(direction=(1, -1, -1), intensity=1.0, name="key"),
            Light(direction=(-0.2, -0.2, -0.959), intensity=0.5, shadow=False, name="fill"),
        ),
        ambient=0.4,
    ),
    "full": Lighting(
        (
            Light(direction=(1, -1, -1), intensity=0.7, name="key"),
            Light(direction=(-0.2, -0.2, -0.959), intensity=0.3, shadow=False, name="fill"),
        ),
        ambient=0.8,
    ),
    "soft": Lighting((), ambient=1.5),
    "gentle": Lighting((), ambient=1.5),
    "flat": Lighting((), ambient=1.45),
}


class LightingSettings(SettingsGroup):
    """Light: a named set-up and corrections to it."""

    preset: str = setting("studio", "set-up of lights", choices=tuple(PRESETS), main=True)
    key: float = setting(1.0, "factor on the first light", low=0, high=10)
    fill: float = setting(1.0, "factor on all other lights", low=0, high=10)
    ambient: float = setting(1.0, "factor on the ambient light", low=0, high=10)


def lighting_of(settings: LightingSettings, own: Lighting | None) -> Lighting:
    """The lights to use: a scene's own, or the preset; corrected by the settings' factors."""
    base = own or PRESETS[settings.preset]
    lights = tuple(
        Light(
            **{
                **light.__dict__,
                "intensity": light.intensity * (settings.key if i == 0 else settings.fill),
            }
        )
        for i, light in enumerate(base.lights)
    )
    return Lighting(lights, base.ambient * settings.ambient, base.ambient_color)


def lights_uniform(
    lighting: Lighting, camera: Camera, center: NDArray, *, shadows: bool
) -> dict[str, Any]:
    """Field values of ``Lights`` (wgsl/lights.wgsl), in scene space.

    Args:
        lighting: Lights relative to camera or world.
        camera: What camera lights move with.
        center: World position of the origin of scene space.
        shadows: Whether lights that may cast shadows get a layer of the shadow texture.
    """
    if len(lighting.lights) > MAX_LIGHTS:
        raise SettingsError(f"at most {MAX_LIGHTS} lights, not {len(lighting.lights)}")
    world_from_view = np.linalg.inv(camera.view_from_world())
    layer = 0
    table = []
    for light in lighting.lights:
        direction = np.asarray(light.direction, np.float64)
        position = np.asarray(light.position, np.float64)
        if light.relative_to == "camera":
            direction = world_from_view[:3, :3] @ direction
            position = (world_from_view @ np.append(position, 1.0))[:3]
        length = np.linalg.norm(direction)
        casts = shadows and light.shadow and light.intensity > 0
        table.append(
            {
                "position": position - center,
                "kind": KINDS.index(light.kind),
                "direction": direction / length if length else (0, 0, -1),
                "reach": 3e38 if light.reach is None else light.reach,
                "color": np.asarray(light.color) * light.intensity,
                "shadow": layer if casts else -1,
                "attenuation": light.attenuation,
                "size": math.tan(math.radians(light.size))
                if light.kind == DIRECTIONAL
                else light.size,
                "cos_full": math.cos(math.radians(light.cone)),
                "cos_none": math.cos(math.radians(light.cone + light.fade)),
                "pad0": 0.0,
                "pad1": 0.0,
            }
        )
        layer += casts
    return {
        "ambient": np.asarray(lighting.ambient_color) * lighting.ambient,
        "count": len(table),
        "list": table,
    }
