"""The points that bound what a scene shows, for cameras, clips and focus."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.geometry import Body, rotation_matrices

if TYPE_CHECKING:
    from scuro.scene.scene import Scene

_EXACT_POINTS = 2_000_000
"""Beyond so many primitives the picture is fitted to the instances' bounding spheres."""
_TRIANGLE = 1.0
"""Å: size of the triangles of cartoons."""
_MOMENTS = 12
"""Moments of a trajectory that stand for all of it."""
_FOCUS_PADDING = 3.0
"""Å around the atoms that are in focus, so that their neighbours show."""


def scene_points(scene: Scene, outermost: bool = False) -> NDArray[np.float64]:
    """(n, 4) world centres and radii that bound the scene's surfaces.

    Volumes and other items without surfaces add the corners of their boxes.

    Args:
        scene: What is seen.
        outermost: Whether those will do that can be met first from some side: for cameras.
    """
    bodies = scene.bodies()
    exact = sum(len(b.geometry) * b.instances for b in bodies) <= _EXACT_POINTS
    found = [body_points(body, exact, outermost) for body in bodies]
    found += [_bare(volume.outline) for volume in scene.volumes]
    found += [_bare(reservoir.outline) for reservoir in scene.reservoirs]
    others = [item for item in scene.items if item not in scene.reservoirs]
    boxes = [item.bounds for item in others if hasattr(item, "bounds")]
    found += [_corners(np.asarray(box)) for box in boxes]
    return np.concatenate(found) if found else np.zeros((0, 4))


def clip_keeps(scene: Scene) -> bool:
    """Whether clipping leaves anything of a scene but its context."""
    if not scene.clip.planes or scene.volumes or scene.reservoirs:
        return True
    equations = scene.clip.cutting.equations()
    bodies = [body for body in scene.bodies() if not body.context]
    exact = sum(len(b.geometry) * b.instances for b in bodies) <= _EXACT_POINTS
    for body in bodies:
        points = body_points(body, exact)
        if body.clipped:
            # triangles reach farther than their corners
            reach = points[:, 3:] + (_TRIANGLE if len(body.geometry.triangles) else 0)
            inside = points[:, :3] @ equations[:, :3].T + equations[:, 3] >= -reach
            points = points[inside.all(axis=1)]
        if len(points):
            return True
    return False


def moving_points(
    scenes: Sequence[Scene], play: Callable[[float], None], last: int, focus: str = ""
) -> NDArray[np.float64]:
    """(n, 4) world centres and radii that bound what scenes show at moments spread over all.

    Args:
        scenes: What is seen.
        play: Puts their atoms where a frame has them.
        last: The last frame's number; the first is 0.
        focus: A selection that alone counts, if there is one.

    Raises:
        LoadError: A frame cannot be read.
        SettingsError: The focus selects nothing.
    """
    found: list[NDArray[np.float64]] = []
    for place in np.unique(np.linspace(0, last, _MOMENTS).round()):
        play(float(place))
        seen = (focus_points(s, focus) if focus else scene_points(s) for s in scenes)
        found += map(hull, seen)
    return np.concatenate(found)


def hull(points: NDArray) -> NDArray[np.float64]:
    """Those of (n, 4) centres and radii whose hull holds the others; all get the largest radius."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        outer = points[ConvexHull(points[:, :3]).vertices]
    except (QhullError, ValueError):  # too few, or flat
        return points
    outer[:, 3] = points[:, 3].max()
    return outer


def body_points(body: Body, exact: bool, outermost: bool = False) -> NDArray[np.float64]:
    """(n, 4) world centres and radii that bound a body: of its primitives (or of those that can be
    met first from some side), or of its instances."""
    geometry = body.geometry
    if not len(geometry) or not len(body.positions):
        return np.zeros((0, 4))
    if exact:
        local = geometry.outermost if outermost else geometry.points
    else:
        middle = geometry.bounds.astype(np.float64).mean(axis=0)
        local = np.append(middle, body.radius)[None]
    turned = np.einsum("kij,nj->kni", rotation_matrices(body.rotations), local[:, :3])
    centers = turned + body.positions[:, None, :]
    radii = np.broadcast_to(local[None, :, 3], centers.shape[:2])
    own = np.concatenate([centers, radii[..., None]], axis=-1).reshape(-1, 4)
    if body.frames is None:
        return own
    if not exact:
        box = body.own_bounds
        own = np.append(box.mean(axis=0), np.linalg.norm(box[1] - box[0]) / 2)[None]
    turned = np.einsum("kij,nj->kni", rotation_matrices(body.frames.rotations), own[:, :3])
    centers = turned + body.frames.positions[:, None, :]
    radii = np.broadcast_to(own[None, :, 3], centers.shape[:2])
    return np.concatenate([centers, radii[..., None]], axis=-1).reshape(-1, 4)


def _bare(points: NDArray) -> NDArray[np.float64]:
    """Points as spheres without radius."""
    return np.concatenate([points, np.zeros((len(points), 1))], axis=1)


def _corners(box: NDArray) -> NDArray[np.float64]:
    axes = np.meshgrid(*box.T, indexing="ij")
    return np.concatenate([np.stack(axes, -1).reshape(-1, 3), np.zeros((8, 1))], axis=1)


def focus_points(scene: Scene, selection: str, flag: str = "--focus") -> NDArray[np.float64]:
    """(n, 4) centres and padded radii of the selected atoms of all molecules.

    ``flag`` names the option in the error.

    Raises:
        SettingsError: Nothing is selected.
    """
    from scuro.style.selection import select

    found = [item.molecule.positions[select(item.molecule, selection)] for item in scene.molecules]
    positions = np.concatenate(found) if found else np.zeros((0, 3))
    if not len(positions):
        raise SettingsError(f"{flag} '{selection}' selects no atoms")
    padding = np.full((len(positions), 1), _FOCUS_PADDING)
    return np.concatenate([positions, padding], axis=1).astype(np.float64)
