"""Names over a picture: of which regions, where there is room, how large.

Letters have a share of the picture's height, or on paper of a given resolution nine points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.passes.post.stereo import eye_size
from scuro.scene.camera import Camera
from scuro.scene.regions import Hierarchy, Level
from scuro.style.gauges import inks
from scuro.style.labels import placed
from scuro.style.marks import (
    ASCENT,
    CAPITALS,
    DESCENT,
    Mark,
    Rect,
    Text,
    covered,
    halo_width,
    text_width,
)
from scuro.style.paint import linear_rgba
from scuro.style.region_labels import BY_ELEMENT, Namer, RegionLabel, levels_between

if TYPE_CHECKING:
    from scuro.render_settings import Settings
    from scuro.scene.scene import Scene
    from scuro.trace import Accelerator

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


_namers: WeakKeyDictionary[Scene, tuple[Any, Namer]] = WeakKeyDictionary()


def namer_of(scene: Scene, settings: Settings) -> Namer:
    """What names the scene's regions; kept while the scene does not change.

    Raises:
        SettingsError: A selection is not understood.
    """
    hierarchy = scene.hierarchy(settings.semantic.parts)
    key = (hierarchy, settings.labels.show == "atoms", settings.labels.select)
    kept = _namers.get(scene)
    if kept is None or kept[0] != key:
        kept = _namers[scene] = (key, _namer(scene, hierarchy, settings))
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
