"""The two lines of every short script: from files to a scene, from a scene to a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from scuro.errors import SettingsError
from scuro.load import load as read
from scuro.scene.scene import Scene

if TYPE_CHECKING:
    from scuro.image import Image
    from scuro.render import Renderer
    from scuro.render_settings import Settings
    from scuro.scene.camera import Camera


def load(
    *inputs: str | Path, format: str | None = None, assembly: str | None = None, **options: Any
) -> Scene:
    """Read files into one scene.

    Args:
        inputs: Paths, PDB IDs (downloaded once), ``sample:1tii``, or ``-`` for standard input.
        format: The format's usual ending, where a name does not say.
        assembly: The biological assembly to show, by its number in the file.
        options: What to read: see :class:`scuro.load.LoadOptions`, e.g. ``waters=False``.

    Raises:
        LoadError: A file is missing, damaged, or of no known format.
        SettingsError: An unknown option, or no inputs.
    """
    if not inputs:
        raise SettingsError("load needs at least one path or PDB ID")
    scene = Scene()
    for name in inputs:
        scene.add(read(name, format=format, **options))
    for item in scene.molecules:
        item.assembly = assembly
    return scene


def render(
    scene: Scene,
    *,
    size: tuple[int, int] | None = None,
    camera: Camera | None = None,
    settings: Settings | None = None,
    device: str | None = None,
    **changes: Any,
) -> Image:
    """Draw a scene once.

    Args:
        scene: What to draw.
        size: Width and height in pixels.
        camera: From where; by default all of the scene is seen.
        settings: All settings; the defaults otherwise.
        device: Adapter number or part of its name.
        changes: Single settings, e.g. ``lighting__preset="full"``.
    """
    from scuro.render_settings import Settings

    settings = settings or Settings()
    if size is not None:
        settings = settings.replace(size=size)
    if changes:
        settings = settings.replace(**changes)
    return _shared_renderer(device).render(scene, camera, settings)


_renderers: dict[str | None, Renderer] = {}


def _shared_renderer(device: str | None) -> Renderer:
    """One renderer a device and process: opening a GPU costs more than most pictures."""
    from scuro.render import Renderer  # opens the graphics library, which reading has no use for

    if device not in _renderers:
        _renderers[device] = Renderer(device)
    return _renderers[device]
