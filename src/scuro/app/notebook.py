"""The viewer in a notebook's cell: ``from scuro.app.notebook import show``."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from scuro.errors import MissingExtraError
from scuro.export.scene_file import SceneFile
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.scene import Scene
from scuro.viewer.model import Model
from scuro.viewer.window import attach

_renderers: list[Renderer] = []
"""One for all cells: opening a GPU takes longer than most pictures."""


def show(
    scene: Scene | SceneFile,
    *,
    size: tuple[int, int] = (800, 500),
    settings: Settings | None = None,
    device: str | None = None,
) -> Any:
    """A widget that shows a scene; the last value of a cell is displayed.

    Args:
        scene: A scene of :func:`scuro.load`, or a scene file that was read.
        size: Width and height in CSS pixels.
        settings: How it is drawn at first.
        device: Adapter number or part of its name, for the first widget of a process.

    Raises:
        MissingExtraError: The notebook's libraries are not installed.
    """
    try:
        from rendercanvas.jupyter import RenderCanvas, loop
    except ImportError:
        raise MissingExtraError("Notebook cells", "viewer") from None
    document = scene if isinstance(scene, SceneFile) else SceneFile()
    if settings is not None:
        document = replace(document, settings=settings)
    model = Model(document, None if isinstance(scene, SceneFile) else scene)
    if not _renderers:
        _renderers.append(Renderer(device))
    canvas = RenderCanvas(size=size, update_mode="ondemand", max_fps=60)
    canvas.scuro = attach(canvas, loop, model, _renderers[0])
    return canvas
