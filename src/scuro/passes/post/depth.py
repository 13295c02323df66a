"""Depth for post passes: by itself in a texture, and how far the scene reaches along it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.passes.frame import Frame
from scuro.scene.geometry import Body, rotation_matrices

_EXACT_CLUSTERS = 1 << 18
"""Bodies with more clusters than this are measured by their instances' bounding spheres."""
_JUMP = 4.0
"""Median radii that a surface must stand out for a line of full width: two atoms' diameters."""


def depth_range(frame: Frame) -> tuple[float, float]:
    """Depth (along -z of the view) of the scene's front and back, the same in every tile.

    Bounding spheres of clusters are used, and clipping planes do not move it: fog must not jump
    while a plane sweeps through.
    """
    back = frame.camera.view_from_world()[2]
    spans = [_body_span(frame, body, back) for body in frame.accelerator.bodies]
    spans = [span for span in spans if span is not None]
    if not spans:
        middle, extent = frame.resources["view"]["distance"], frame.accelerator.extent
        return middle - extent, middle + extent
    front, rear = np.min([s[0] for s in spans]), np.max([s[1] for s in spans])
    if not frame.camera.orthographic:
        front = max(front, 0.0)  # what lies behind the eye is not seen
    return float(front), float(max(rear, front + 1e-6))


def _body_span(frame: Frame, body: Body, back: NDArray) -> tuple[float, float] | None:
    packed = frame.accelerator.packed[id(body.geometry)]
    clusters = packed.clusters
    if not len(clusters) or not len(body.positions):
        return None
    matrices = rotation_matrices(body.rotations)
    origins = body.positions + matrices @ packed.middle.astype(np.float64)
    depths = -(origins @ back[:3] + back[3])
    if len(clusters) * len(depths) > _EXACT_CLUSTERS:
        return float(depths.min() - packed.radius), float(depths.max() + packed.radius)
    local = np.einsum("i,kij,nj->kn", -back[:3], matrices, clusters[:, :3].astype(np.float64))
    depths = depths[:, None] + local
    return float((depths - clusters[:, 3]).min()), float((depths + clusters[:, 3]).max())


def full_jump(frame: Frame, setting: float | None) -> float:
    """Depth jump at which borders and halos are at their strongest, scene units."""
    if setting is not None:
        return setting
    radius = frame.accelerator.primitive_radius
    return _JUMP * radius if radius > 0 else 0.05 * frame.accelerator.extent


_FAR = 3e38
"""As in depths.wgsl."""


def fill_depths(frame: Frame) -> None:
    """Fill ``depths``: the G-buffer's depth, huge where empty; cheap to read many times."""
    frame.target("depths", "r32float", clear=(_FAR, 0, 0, 0))
    frame.compute_tiles("passes/post/depths.wgsl")
