"""Depth for post passes: by itself in a texture, and how far the scene reaches along it."""

from __future__ import annotations

import numpy as np

from scuro.passes.frame import Frame
from scuro.scene.camera import Camera
from scuro.scene.geometry import Body
from scuro.scene.points import body_points

_EXACT_POINTS = 1 << 20
"""With more primitives in view, bodies are measured by their instances' bounding spheres."""
_SLENDER = 12.0
"""Least ratio of a jump to the line of full width that marks it."""
_JUMP = 4.0
"""Median radii that a surface must stand out for a line of full width: two atoms' diameters."""


def depth_range(frame: Frame) -> tuple[float, float]:
    """Depth (along -z of the view) of the scene's front and back, the same in every tile.

    Clipping planes do not move it: fog must not jump while a plane sweeps through.
    """
    outline = () if frame.outline is None else tuple(map(tuple, frame.outline.tolist()))
    key = (frame.camera, frame.bodies, outline)
    found: tuple[float, float] = frame.targets.table("depth_range", key, lambda: _measured(*key))
    return found


def _measured(
    camera: Camera, bodies: tuple[Body, ...], outline: tuple[tuple[float, ...], ...]
) -> tuple[float, float]:
    exact = sum(len(b.geometry) * b.instances for b in bodies) <= _EXACT_POINTS
    points = np.concatenate(
        [
            np.array([(*point, 0.0) for point in outline]).reshape(-1, 4),
            *(body_points(body, exact, True) for body in bodies),
        ]
    )
    if not len(points):
        return 0.0, 1.0
    row = camera.view_from_world()[2]
    depths, radii = -(points[:, :3] @ row[:3] + row[3]), points[:, 3]
    front, back = float((depths - radii).min()), float((depths + radii).max())
    if not camera.orthographic:
        front = max(front, 0.0)  # what lies behind the eye is not seen
    return front, max(back, front + 1e-6)


def full_jump(frame: Frame, setting: float | None, width: float = 0.0) -> float:
    """Depth jump at which borders and halos are at their strongest, scene units.

    Lines of so many samples' ``width`` mark jumps that are much larger than they are wide: seen
    from afar, atoms lose theirs before molecules do.
    """
    if setting is not None:
        return setting
    radius = frame.accelerator.primitive_radius
    extent = frame.accelerator.extent
    if frame.outline is not None:
        extent = max(extent, float(np.linalg.norm(np.ptp(frame.outline, axis=0))) / 2)
    jump = _JUMP * radius if radius > 0 else 0.05 * extent
    camera, height = frame.camera, frame.resources["view"]["size"][1]
    distance = 1.0 if camera.orthographic else frame.resources["view"]["distance"]
    return max(jump, _SLENDER * width * 2 * camera.half_height() * distance / height)


_FAR = 3e38
"""As in depths.wgsl."""


def fill_depths(frame: Frame) -> None:
    """Fill ``depths``: depth, huge where empty; lines have that of the surface they surround."""
    frame.target("depths", "r32float", clear=(_FAR, 0, 0, 0))
    lines = (frame.settings.borders.width or 0.0) * frame.px
    frame.compute_tiles("passes/post/depths.wgsl", {"lined": {"lines": lines}})
