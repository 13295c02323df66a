"""Light set-ups by name, and their upload."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.camera import Camera
from scuro.scene.lights import DIRECTIONAL, KINDS, Light, Lighting
from scuro.settings import SettingsGroup, setting

if TYPE_CHECKING:
    from scuro.render_settings import Settings

MAX_LIGHTS = 16
"""As in wgsl/lights.wgsl."""

_KEY = (0.55, -0.75, -0.85)
"""From the upper left, in front: the habit of illustrators."""


def _exposed(*lights: Light, ambient: float) -> Lighting:
    """Lights scaled together so that white, turned to them best and unshadowed, just fits.

    ChimeraX's strengths are for pictures that add light in sRGB and clip what is beyond white; in
    linear light their proportions stay and nothing clips but highlights.
    """
    normals = np.random.default_rng(0).normal(size=(2000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[:, 2] = np.abs(normals[:, 2])  # those that the viewer sees
    sum_ = np.full(len(normals), ambient)
    for light in lights:
        to_light = -np.asarray(light.direction) / np.linalg.norm(light.direction)
        sum_ += light.intensity * np.maximum(normals @ to_light, 0)
    scale = _WHITE / float(sum_.max())
    return Lighting(
        tuple(light.replace(intensity=light.intensity * scale) for light in lights),
        ambient * scale,
    )


_WHITE = 0.92
"""Linear light of white at its brightest; sRGB 245."""

_CHIMERA_KEY = (1, -1, -1)
_CHIMERA_FILL = (-0.2, -0.2, -0.959)

# Proportions of simple, full, soft, gentle and flat are ChimeraX's (std_commands/lighting)
PRESETS: dict[str, Lighting] = {
    "studio": _exposed(
        Light(direction=_KEY, intensity=0.72, name="key"),
        Light(direction=(-0.9, -0.1, -0.6), intensity=0.18, shadow=False, name="fill"),
        Light(direction=(-0.3, -0.6, 0.75), intensity=0.30, shadow=False, name="back"),
        ambient=0.42,
    ),
    "simple": _exposed(
        Light(direction=_CHIMERA_KEY, intensity=1.0, name="key"),
        Light(direction=_CHIMERA_FILL, intensity=0.5, shadow=False, name="fill"),
        ambient=0.4,
    ),
    "full": _exposed(
        Light(direction=_CHIMERA_KEY, intensity=0.7, name="key"),
        Light(direction=_CHIMERA_FILL, intensity=0.3, shadow=False, name="fill"),
        Light(direction=(-0.3, -0.6, 0.75), intensity=0.25, shadow=False, name="back"),
        ambient=0.8,
    ),
    "soft": _exposed(ambient=1.5),
    "gentle": _exposed(
        Light(direction=_CHIMERA_FILL, intensity=0.5, shadow=False, name="fill"), ambient=1.2
    ),
    "flat": _exposed(ambient=1.45),
}

IMPLIED: dict[str, dict[str, str]] = {
    "full": {"occlusion": "hybrid", "shadows": "soft"},
    "soft": {"occlusion": "hybrid"},
    "gentle": {"occlusion": "hybrid"},
}
"""Techniques that a set-up brings along where the settings say ``auto``; none otherwise."""


_SILHOUETTE = 2.5
"""Width in pixels of the lines without which flat light would show no shape."""


def with_implied(settings: Settings) -> Settings:
    """Settings whose ``auto`` techniques, and borders, are those that the lighting implies."""
    implied = IMPLIED.get(settings.lighting.preset, {})
    changes: dict[str, Any] = {
        f"{group}__technique": implied.get(group, "none")
        for group in ("occlusion", "shadows")
        if getattr(settings, group).technique == "auto"
    }
    if settings.borders.width is None:
        changes["borders__width"] = _SILHOUETTE if settings.lighting.preset == "flat" else 0.0
    return settings.replace(**changes)


class LightingSettings(SettingsGroup):
    """Light: a named set-up and corrections to it."""

    preset: str = setting(
        "full",
        "set-up of lights; full, soft and gentle bring their occlusion and shadows along",
        choices=tuple(PRESETS),
        main=True,
    )
    key: float = setting(1.0, "factor on the first light", low=0, high=10)
    fill: float = setting(1.0, "factor on all other lights", low=0, high=10)
    ambient: float = setting(1.0, "factor on the ambient light", low=0, high=10)


def lighting_of(settings: LightingSettings, own: Lighting | None) -> Lighting:
    """The lights to use: a scene's own, or the preset; corrected by the settings' factors."""
    base = own or PRESETS[settings.preset]
    lights = tuple(
        light.replace(intensity=light.intensity * (settings.key if i == 0 else settings.fill))
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
