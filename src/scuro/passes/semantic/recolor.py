"""Base colours by the hierarchy: those of the level in view, or of a palette."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.passes.frame import Frame
from scuro.passes.semantic.levels import place
from scuro.passes.semantic.settings import SemanticSettings
from scuro.scene.regions import Hierarchy
from scuro.style.hierarchy import hierarchy_colors, palette_colors


def object_colors(frame: Frame, hierarchy: Hierarchy) -> NDArray[np.uint32] | None:
    """An sRGB colour for each object at the level in view, alpha 0 for those that keep their own.

    None where nothing is coloured. Without the semantic pipeline the leaves have colours of their
    own.

    Raises:
        SettingsError: The palette is not known.
    """
    settings: SemanticSettings = frame.settings.semantic
    painted = np.flatnonzero(hierarchy.painted)
    if not len(painted) or not settings.color:
        return None
    depth = None
    if settings.mode != "off":
        levels = hierarchy.levels
        here = place(frame, hierarchy)
        now, then = (levels[min(here.level + k, len(levels) - 1)].depth for k in (0, 1))
        depth = now + here.blend * (then - now)
    palette = palette_colors(settings.palette) if settings.palette else None
    colors = np.zeros((len(hierarchy.paths), 4), np.uint8)
    colors[painted, :3] = hierarchy_colors([hierarchy.paths[i] for i in painted], depth, palette)
    colors[painted, 3] = 255
    return colors.view(np.uint32)[:, 0]


def color_by_level(frame: Frame, hierarchy: Hierarchy) -> None:
    """Replace ``albedo`` of cell-scale models by the colours of the level in view.

    Raises:
        SettingsError: The palette is not known.
    """
    colors = object_colors(frame, hierarchy)
    if colors is None:
        return
    albedo = frame.resources["albedo"]
    frame.target("level_albedo", "rgba16float", clear=(0, 0, 0, 0))
    frame.compute_tiles(
        "passes/semantic/recolor.wgsl",
        {"albedo": albedo, "object_colors": frame.gpu.buffer(colors, label="colours")},
    )
    frame.resources["albedo"] = frame.resources["level_albedo"]
