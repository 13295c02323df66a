"""Marks over a picture: names, legends, a scale bar, the axes; laid out once for all of its parts.

Names are placed by a small survey of the whole picture, so that pictures drawn in parts get the
same ones as those drawn at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from scuro.passes.post.stereo import eye_camera, eye_size
from scuro.render_names import Names, Standing, name_text, namer_of, placed_names, text_size, wanted
from scuro.scene.camera import Camera
from scuro.scene.projection import project
from scuro.style.gauges import CROSS, axis_cross, inks, scale_bar, scene_unit
from scuro.style.marks import (
    Line,
    Mark,
    Text,
)
from scuro.style.paint import linear_rgba
from scuro.style.region_labels import (
    Survey,
    region_labels,
)

if TYPE_CHECKING:
    from scuro.render import Renderer
    from scuro.render_settings import Settings
    from scuro.scene.scene import Scene
    from scuro.style.legend import Legend
    from scuro.trace import Accelerator

ACROSS = 640
"""Pixels across a survey: places of names need no finer grid."""


@dataclass(frozen=True)
class Sight:
    """A picture's view, and what it sees."""

    standing: Standing
    survey: Survey


def picture_marks(
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    names: Names | None = None,
) -> list[Mark]:
    """All that the settings want written over a picture.

    Args:
        renderer: Draws the survey.
        scene: What the picture shows.
        camera: From where.
        settings: Of the picture.
        names: Labels in place of those that a survey finds, with the pixels they are centred on.

    Raises:
        SettingsError: There is nothing of what should be named.
    """
    sight = None
    if (settings.labels.show != "none" and names is None) or tells_regions(scene, settings):
        standing = Standing(camera, settings, renderer.accelerator(scene))
        sight = Sight(standing, renderer.survey(scene, camera, settings))
    fixed = fixed_marks(scene, camera, settings, sight)
    if settings.labels.show == "none":
        marks = fixed
    else:
        if names is None:
            assert sight is not None
            levels = wanted(scene, sight.standing)
            found = region_labels(sight.survey, namer_of(scene, settings), levels)
            names = placed_names(found, sight.survey.size, settings, fixed)
        marks = [name_text(label, x, y, settings) for label, x, y in names]
        marks = [*marks, *fixed]
    if settings.stereo.mode == "none":
        return marks
    return _for_both_eyes(renderer.accelerator(scene), camera, settings, names or [], fixed)


def fixed_marks(
    scene: Scene, camera: Camera, settings: Settings, sight: Sight | None = None
) -> list[Mark]:
    """Legends, scale bar and axes: what does not hang on the scene's surfaces."""
    marks = gauge_marks(scene, camera, settings)
    return marks + legends_of(scene, settings, sight=sight) if settings.legend.show else marks


def tells_regions(scene: Scene, settings: Settings) -> bool:
    """Whether the legend tells colours of a hierarchy, which go with what is in view."""
    return settings.legend.show and bool(scene.hierarchy(settings.semantic.parts).painted.any())


def gauge_marks(scene: Scene, camera: Camera, settings: Settings) -> list[Mark]:
    """Scale bar and axes, which go with the camera."""
    text, size = text_size(settings), eye_size(settings.stereo, settings.size)
    ink, halo = inks(linear_rgba(settings.background))
    marks: list[Mark] = []
    if settings.scale_bar.show:
        marks += scale_bar(camera, scene_unit(scene), size, text, ink, halo)
    if settings.axes.show:
        reach = (CROSS + 1.6) * text
        lower = not (settings.legend.show and settings.legend.corner == "lower left")
        marks += axis_cross(camera, (reach, size[1] - reach if lower else reach), text, halo)
    return marks


def legends_of(
    scene: Scene, settings: Settings, below: float = 0.0, sight: Sight | None = None
) -> list[Mark]:
    """What the scene's colours mean.

    Args:
        scene: The scene.
        settings: Of the picture.
        below: Pixels at the picture's foot to leave free.
        sight: What is in view, for colours that go with it: see :func:`tells_regions`.
    """
    from scuro.style.legend import legend_marks
    from scuro.style.legends import scene_legends

    scene.show_reservoirs(settings.reservoir)
    text, (width, height) = text_size(settings), eye_size(settings.stereo, settings.size)
    ink, halo = inks(linear_rgba(settings.background))
    corner = settings.legend.corner
    if corner == "lower right" and settings.scale_bar.show:
        below = max(below, 2.4 * text)  # the bar has its corner
    height -= round(below)
    paper = (*halo[:3], 228)
    legends = scene_legends(scene, settings)
    regions = _regions(scene, sight) if sight is not None else None
    if regions is not None:
        legends.insert(0, regions)
    return legend_marks(legends, (width, height), text, corner, ink, paper)


def _regions(scene: Scene, sight: Sight) -> Legend | None:
    """What the colours of cell-scale models mean at the level in view."""
    from scuro.passes.semantic.levels import place
    from scuro.passes.semantic.recolor import object_colors
    from scuro.style.legend_hierarchy import LEAVES, hierarchy_legend

    standing = cast(Any, sight.standing)
    semantic = standing.settings.semantic
    hierarchy = scene.hierarchy(semantic.parts)
    if not hierarchy.painted.any():
        return None
    things = sight.survey.ids[..., 2]
    seen = np.bincount(things[things < len(hierarchy.paths)], minlength=len(hierarchy.paths))
    by_level = semantic.color and semantic.mode != "off"
    found = object_colors(standing, hierarchy) if by_level or semantic.palette else None
    if found is not None:
        colors = found.view(np.uint8).reshape(-1, 4)[:, :3]
    else:
        shown = standing.accelerator.bodies
        colors = np.array([body.geometry.sphere_colors[:1, :3].sum(axis=0) for body in shown])
    level = LEAVES
    if by_level:
        here = place(standing, hierarchy)
        last = len(hierarchy.levels) - 1
        level = hierarchy.levels[min(here.level + (here.blend >= 0.5), last)]
    return hierarchy_legend(hierarchy, colors, seen, level)


def _for_both_eyes(
    accelerator: Accelerator,
    camera: Camera,
    settings: Settings,
    names: Names,
    fixed: Sequence[Mark],
) -> list[Mark]:
    """Marks of two pictures, side by side or in each other: names lie as deep as what they hang on.

    All else lies on the picture itself, without parallax.
    """
    size = eye_size(settings.stereo, settings.size)
    beside = settings.stereo.mode == "side-by-side"
    separation = settings.stereo.separation * accelerator.extent
    marks: list[Mark] = []
    anchors = np.array([label.anchor for label, _, _ in names]).reshape(-1, 3)
    middle = project(camera, anchors, size) if len(anchors) else anchors
    for eye in (-1, 1):
        own, jitter = eye_camera(camera, eye, separation, size[1])
        here = project(own, anchors, size) if len(anchors) else anchors
        start = size[0] if beside and eye > 0 else 0.0
        for (label, x, y), a, b in zip(names, middle, here, strict=True):
            moved = name_text(label, x + b[0] - a[0] - jitter[0], y + b[1] - a[1], settings)
            left, _, right, _ = moved.box
            if left >= 0 and right <= size[0]:  # nothing of it in the other eye's picture
                marks.append(replace(moved, x=moved.x + start, eye=0 if beside else eye))
        if beside:
            marks += [shifted(mark, start) for mark in fixed]
    return marks if beside else [*marks, *fixed]


def shifted(mark: Mark, x: float) -> Mark:
    """A mark farther to the right."""
    if isinstance(mark, Text):
        return replace(mark, x=mark.x + x)
    if isinstance(mark, Line):
        return replace(mark, points=tuple((a + x, b) for a, b in mark.points))
    left, top, right, bottom = mark.box
    return replace(mark, box=(left + x, top, right + x, bottom))
