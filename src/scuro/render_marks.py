"""Marks over a picture: names, legends, a scale bar, the axes; laid out once for all of its parts.

Names are placed by a small survey of the whole picture, so that pictures drawn in parts get the
same ones as those drawn at once. Letters have a share of the picture's height, or on paper of a
given resolution nine points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.passes.post.stereo import eye_camera, eye_size
from scuro.scene.camera import Camera
from scuro.scene.projection import project
from scuro.scene.regions import Hierarchy, Level
from scuro.style.gauges import CROSS, axis_cross, inks, scale_bar, scene_unit
from scuro.style.labels import placed
from scuro.style.marks import (
    ASCENT,
    CAPITALS,
    DESCENT,
    Line,
    Mark,
    Rect,
    Text,
    covered,
    halo_width,
    text_width,
)
from scuro.style.paint import linear_rgba
from scuro.style.region_labels import (
    BY_ELEMENT,
    Namer,
    RegionLabel,
    Survey,
    levels_between,
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
_SHARE, SMALLEST_TEXT, _POINTS = 1 / 40, 11.0, 12.0
"""Height of letters: of the picture, in pixels at least, and in 1/96 inch on paper (9 points)."""
Names = Sequence[tuple[RegionLabel, float, float]]
"""Labels and the pixels that they are centred on."""
_LEVELS = {"chains": "chain", "residues": "residue"}


@dataclass(frozen=True)
class Standing:
    """Where a camera stands in a scene, and with what settings: what levels are chosen by."""

    camera: Camera
    settings: Settings
    accelerator: Accelerator


def text_size(settings: Settings) -> float:
    """Height of letters, in pixels of the picture."""
    if settings.text is not None:
        return settings.text * settings.px
    if settings.dpi is not None:
        return max(SMALLEST_TEXT, _POINTS * settings.px)
    return max(SMALLEST_TEXT, float(round(settings.size[1] * _SHARE)))


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
    if settings.stereo.mode != "side-by-side":
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


def wanted(scene: Scene, standing: Standing) -> list[tuple[Level, float]]:
    """Levels of the hierarchy whose regions get names, and how opaque these are.

    Raises:
        SettingsError: There is nothing of the kind in the scene.
    """
    from scuro.passes.semantic.levels import place

    settings = standing.settings
    hierarchy = scene.hierarchy(settings.semantic.parts)
    show = settings.labels.show
    if show == "regions":
        here = place(cast(Any, standing), hierarchy)
        return levels_between(hierarchy, here.level, here.blend)
    if show == "atoms" and scene.molecules:
        return [(Level("atom", BY_ELEMENT), 1.0)]
    found = [level for level in hierarchy.levels if level.name == _LEVELS.get(show)]
    if not found:
        raise SettingsError(f"the scene has no {show} to name: use --labels regions")
    return [(found[0], 1.0)]


_namers: dict[str, tuple[Any, Namer]] = {}


def namer_of(scene: Scene, settings: Settings) -> Namer:
    """What names the scene's regions; kept while the scene does not change.

    Raises:
        SettingsError: A selection is not understood.
    """
    hierarchy = scene.hierarchy(settings.semantic.parts)
    key = (hierarchy, settings.labels.show == "atoms", settings.labels.select)
    kept = _namers.get("last")
    if kept is None or kept[0] != key:
        kept = _namers["last"] = (key, _namer(scene, hierarchy, settings))
    return kept[1]


def _namer(scene: Scene, hierarchy: Hierarchy, settings: Settings) -> Namer:
    from scuro.style.selection import select

    names: dict[int, list[str]] = {}
    masks: dict[int, Any] = {}
    number = 0
    for item in scene.items:
        bodies = item.bodies() if hasattr(item, "bodies") else []
        if hasattr(item, "molecule"):
            if settings.labels.show == "atoms":
                known = atom_names(item.molecule, select(item.molecule, settings.labels.select))
                names |= {number + n: known for n in range(len(bodies))}
            if settings.labels.select != "all":
                mask = select(item.molecule, settings.labels.select)
                masks |= {number + n: mask for n in range(len(bodies))}
        number += len(bodies)
    return Namer(hierarchy, names, masks)


def atom_names(molecule: Any, chosen: NDArray[np.bool_]) -> list[str]:
    """``ASP 25 CA``; where the chosen atoms are of one residue, an atom's name alone."""
    atoms = [str(name).strip() for name in molecule.atom_name]
    if len(np.unique(molecule.residue[chosen])) < 2:
        return atoms
    residues = [
        f"{name} {number}"
        for name, number in zip(molecule.residue_name, molecule.residue_number, strict=True)
    ]
    return [f"{residues[r]} {name}" for r, name in zip(molecule.residue, atoms, strict=True)]


def placed_names(
    labels: Sequence[RegionLabel],
    survey: tuple[float, float],
    settings: Settings,
    marks: Sequence[Mark] = (),
) -> list[tuple[RegionLabel, float, float]]:
    """Labels for which there is room, the largest regions first, and the pixels they are about.

    Args:
        labels: In pixels of a survey.
        survey: Its size.
        settings: Of the picture.
        marks: What is in the picture already.
    """
    size = eye_size(settings.stereo, settings.size)
    scale = size[0] / survey[0]
    extents = [name_extent(label.text, text_size(settings)) for label in labels]
    places = np.array([(scale * la.x, scale * la.y, 1.0) for la in labels]).reshape(-1, 3)
    found = placed(
        places,
        extents,
        size,
        order=np.arange(len(labels)),
        centered=True,
        most=settings.labels.most,
        taken=taken_by(marks),
    )
    return [
        (labels[n], left + extents[n][0] / 2, top + extents[n][1] / 2) for n, (left, top) in found
    ]


def taken_by(marks: Sequence[Mark]) -> list[Rect]:
    """Where no label may lie."""
    around = [covered([mark]) for mark in marks]
    return [box for box in around if box is not None]


def name_extent(text: str, size: float) -> tuple[float, float]:
    """Width and height that a label takes up, with room around it."""
    rim = halo_width(size)
    return text_width(text, size) + 2 * rim + 0.3 * size, (ASCENT + DESCENT + 0.1) * size + 2 * rim


def name_text(
    label: RegionLabel, x: float, y: float, settings: Settings, opacity: float | None = None
) -> Text:
    """A label's words about a pixel; ``opacity`` in place of its own."""
    size = text_size(settings)
    ink, halo = inks(linear_rgba(settings.background))
    alpha = round(255 * (label.opacity if opacity is None else opacity))
    color, rim = (*ink[:3], alpha), (*halo[:3], round(0.8 * alpha))
    return Text(label.text, x, y + CAPITALS * size / 2, size, color, rim, "m")


def _for_both_eyes(
    accelerator: Accelerator,
    camera: Camera,
    settings: Settings,
    names: Names,
    fixed: Sequence[Mark],
) -> list[Mark]:
    """Marks of two pictures side by side: names lie as deep as what they hang on."""
    size = eye_size(settings.stereo, settings.size)
    separation = settings.stereo.separation * accelerator.extent
    marks: list[Mark] = []
    anchors = np.array([label.anchor for label, _, _ in names]).reshape(-1, 3)
    middle = project(camera, anchors, size) if len(anchors) else anchors
    for eye in (-1, 1):
        own, jitter = eye_camera(camera, eye, separation, size[1])
        here = project(own, anchors, size) if len(anchors) else anchors
        start = size[0] if eye > 0 else 0.0
        for (label, x, y), a, b in zip(names, middle, here, strict=True):
            moved = name_text(label, x + b[0] - a[0] - jitter[0], y + b[1] - a[1], settings)
            left, _, right, _ = moved.box
            if left >= 0 and right <= size[0]:  # nothing of it in the other eye's picture
                marks.append(replace(moved, x=moved.x + start))
        marks += [shifted(mark, start) for mark in fixed]
    return marks


def shifted(mark: Mark, x: float) -> Mark:
    """A mark farther to the right."""
    if isinstance(mark, Text):
        return replace(mark, x=mark.x + x)
    if isinstance(mark, Line):
        return replace(mark, points=tuple((a + x, b) for a, b in mark.points))
    left, top, right, bottom = mark.box
    return replace(mark, box=(left + x, top, right + x, bottom))
