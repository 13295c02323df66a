"""Names of the regions in view, drawn into the finished picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.settings import SettingsGroup, setting

if TYPE_CHECKING:
    from scuro.passes.frame import Frame
    from scuro.scene.scene import Scene

_ENOUGH = 640
"""Regions are looked for in so many pixels across: places of names need no finer grid."""


class LabelSettings(SettingsGroup):
    """Names of compartments, ingredients, chains … on the picture."""

    show: bool = setting(False, "name the regions in view, at the level in view", main=True)
    most: int = setting(12, "names in one picture, at most", low=1, high=200)


def draw_labels(pixels: NDArray[np.uint8], frame: Frame | None, scene: Scene) -> NDArray[np.uint8]:
    """The picture (h, w, 4) with the names that its settings ask for.

    Args:
        pixels: The picture.
        frame: That it came from; none if it was drawn in parts.
        scene: What it shows.

    Raises:
        SettingsError: It was drawn in parts.
    """
    if frame is None:
        raise SettingsError(
            "labels are placed in a picture drawn at once: lower --size or --antialias, or draw it "
            "without --labels"
        )
    from scuro.passes.semantic.levels import place
    from scuro.style.region_labels import region_labels, with_labels

    hierarchy = scene.hierarchy(frame.settings.semantic.parts)
    here = place(frame, hierarchy)
    ids = frame.gpu.read_texture(frame.resources["ids"])
    step = max(1, ids.shape[1] // _ENOUGH)
    labels = region_labels(ids[::step, ::step], hierarchy, here.level, here.blend)
    scale = step * pixels.shape[1] / ids.shape[1]
    return with_labels(pixels, labels, scale, frame.settings.labels.most)
