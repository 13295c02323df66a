"""What a scene made in a program shows, in the words of a document."""

from __future__ import annotations

from scuro.export.scene_file import Show
from scuro.scene.clip import Cut, Plane
from scuro.scene.scene import Scene
from scuro.settings import parameters
from scuro.style.options import Representation


def cut_of(plane: Plane) -> Cut:
    """A plane as scene files have it."""
    return Cut(normal=plane.normal, point=plane.point)


def cuts_of(scene: Scene) -> tuple[Cut, ...]:
    """A scene's clipping planes."""
    return tuple(map(cut_of, scene.clip.planes))


def shows_of(scene: Scene) -> tuple[Show, ...]:
    """How a scene shows its first molecule."""
    sizes = {p.name for p in parameters(Representation)}
    shown_ones = scene.molecules[0].shown if scene.molecules else ()
    return tuple(
        Show(
            style=shown.style,
            color=shown.color,
            select=shown.select,
            opacity=shown.material.opacity,
            context=shown.context,
            sizes=Representation(**{k: v for k, v in shown.options if k in sizes}),
        )
        for shown in shown_ones
    )
