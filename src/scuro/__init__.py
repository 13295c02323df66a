"""scuro: occlusion and shadow for molecules, cell-scale models, volumes and reservoirs."""

from __future__ import annotations

import sys
import types
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "Camera": "scuro.scene.camera",
    "Clip": "scuro.scene.clip",
    "Image": "scuro.image",
    "Light": "scuro.scene.lights",
    "Lighting": "scuro.scene.lights",
    "Material": "scuro.scene.geometry",
    "Plane": "scuro.scene.clip",
    "Renderer": "scuro.render",
    "Scene": "scuro.scene.scene",
    "ScuroError": "scuro.errors",
    "Settings": "scuro.render_settings",
    "load": "scuro.api",
    "render": "scuro.api",
}
"""Where each public name lives; loaded on first use, so that ``import scuro`` costs nothing."""

__all__ = [
    "Camera",
    "Clip",
    "Image",
    "Light",
    "Lighting",
    "Material",
    "Plane",
    "Renderer",
    "Scene",
    "ScuroError",
    "Settings",
    "load",
    "render",
]

if TYPE_CHECKING:
    from scuro.api import load, render
    from scuro.errors import ScuroError
    from scuro.image import Image
    from scuro.render import Renderer
    from scuro.render_settings import Settings
    from scuro.scene.camera import Camera
    from scuro.scene.clip import Clip, Plane
    from scuro.scene.geometry import Material
    from scuro.scene.lights import Light, Lighting
    from scuro.scene.scene import Scene


class _Package(types.ModuleType):
    """Keeps ``scuro.load`` and ``scuro.render`` functions: importing the modules of the same name,
    which sets them as attributes here, must not hide them."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, types.ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'scuro' has no attribute '{name}'")
    import importlib

    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
