"""The legend of cell-scale models: which compartment, or ingredient, has which colour now."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.regions import BY_INSTANCE, BY_OBJECT, Hierarchy, Level
from scuro.style.legend import MOST_SWATCHES, Legend
from scuro.style.region_labels import Namer

LEAVES = Level("ingredient", BY_INSTANCE)
"""Below ingredients nothing has a colour of its own."""


def hierarchy_legend(
    hierarchy: Hierarchy, colors: NDArray[np.uint8], seen: NDArray, level: Level
) -> Legend | None:
    """The regions that a picture shows at a level; ``None`` if there are none.

    Those that take up most of the picture have their lines, in the order of the tree, so that lines
    do not change places while the camera moves.

    Args:
        hierarchy: Of the scene.
        colors: sRGB (n, 3) of each object.
        seen: (n,) how much of the picture each object takes up.
        level: Whose regions are told; those of instances and their parts are ingredients.
    """
    level = level if level.kind == BY_OBJECT else LEAVES
    namer = Namer(hierarchy)
    weight: dict[str, float] = {}
    largest: dict[str, int] = {}
    for thing in np.flatnonzero(hierarchy.painted & (np.asarray(seen) > 0)).tolist():
        name = namer.name(np.array([0, 0, thing, 0], np.uint32), level)
        weight[name] = weight.get(name, 0.0) + float(seen[thing])
        if name not in largest or seen[thing] > seen[largest[name]]:
            largest[name] = thing
    if not weight:
        return None
    kept = sorted(sorted(weight, key=lambda n: -weight[n])[:MOST_SWATCHES], key=largest.__getitem__)
    rows = []
    for name in kept:
        red, green, blue = (int(v) for v in colors[largest[name]])
        rows.append(((red, green, blue), name))
    # "compartment 2" is a depth: of no interest in a legend
    title = level.name.rstrip(" 0123456789")
    return Legend(title, swatches=tuple(rows), more=len(weight) - len(kept))
