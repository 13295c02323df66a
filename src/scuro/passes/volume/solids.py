"""Where the scene's surfaces fill space inside a volume, so that cones through it meet them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Body, rotation_matrices

MOST_TEXELS = 128**3
"""Texels of the texture of solids, at most: cones soon read coarser levels than that anyway."""

ROD_BALLS = 6
"""Balls that stand for a rod."""

CHUNK = 1 << 22
"""Pairs of a ball and a texel that are tested at a time."""


def solid_fraction(
    bodies: Sequence[Body], texture_from_world: NDArray, size: Sequence[int]
) -> NDArray[np.float16]:
    """Share of every texel that spheres, rods and triangles fill.

    Args:
        bodies: The surfaces. Rods and triangles are taken as balls along them.
        texture_from_world: (4, 4) to coordinates 0…1 over the volume.
        size: Texels along x, y, z.

    Returns:
        (nz, ny, nx), 0 to 1: 1 where a texel's middle is inside a ball; balls smaller than a texel
        add their share of its space.
    """
    extent = np.asarray(size)
    texel_from_world = np.diag([*extent, 1.0]) @ texture_from_world
    out = np.zeros(tuple(extent[::-1]), np.float32)
    for body in bodies:
        balls = _balls(body)
        local = balls[:, :3] @ texel_from_world[:3, :3].T + texel_from_world[:3, 3]
        # a ball in the world is an ellipsoid in texels: its reach along each texel axis
        stretch = np.linalg.norm(texel_from_world[:3, :3], axis=1)
        reach = balls[:, 3:] * stretch
        near = ((local + reach > 0) & (local - reach < extent)).all(axis=1)
        _fill(out, local[near], balls[near, 3], reach[near], texel_from_world[:3, :3])
    return np.minimum(out, 1.0).astype(np.float16)


def _balls(body: Body) -> NDArray[np.float64]:
    """(n, 4) world centres and radii of what stands for the body's primitives."""
    geometry = body.geometry
    rods = geometry.rods.astype(np.float64)
    along = np.linspace(0, 1, ROD_BALLS)[:, None, None]
    on_rods = ((1 - along) * rods[None, :, 0] + along * rods[None, :, 1]).reshape(-1, 4)
    corners = geometry.triangles.astype(np.float64)
    centers = corners.mean(axis=1)
    radii = np.linalg.norm(corners - centers[:, None], axis=2).max(axis=1, initial=0)
    on_triangles = np.column_stack([centers, 0.5 * radii])
    local = np.concatenate([geometry.spheres.astype(np.float64), on_rods, on_triangles])
    turned = np.einsum("kij,nj->kni", rotation_matrices(body.rotations), local[:, :3])
    placed = turned + body.positions[:, None, :]
    wide = np.broadcast_to(local[None, :, 3:], (*placed.shape[:2], 1))
    return np.concatenate([placed, wide], axis=-1).reshape(-1, 4)


def _fill(
    out: NDArray[np.float32],
    local: NDArray,
    radii: NDArray,
    reach: NDArray,
    texel_from_world: NDArray,
) -> None:
    """Mark the texels whose middles lie inside balls; small balls add their volume instead."""
    if not len(local):
        return
    world_from_texel = np.linalg.inv(texel_from_world)
    size = np.array(out.shape[::-1])
    small = (reach < 0.75).all(axis=1)
    at = np.clip(local[small].astype(int), 0, size - 1)
    texel = abs(np.linalg.det(world_from_texel))
    np.add.at(out, tuple(at.T[::-1]), 4 / 3 * np.pi * radii[small] ** 3 / texel)
    local, radii, reach = local[~small], radii[~small], reach[~small]
    if not len(local):
        return
    half = np.ceil(reach.max(axis=0)).astype(int)
    offsets = np.stack(np.meshgrid(*[np.arange(-h, h + 1) for h in half], indexing="ij"), -1)
    offsets = offsets.reshape(-1, 3)
    for start in range(0, len(local), max(1, CHUNK // len(offsets))):
        part = slice(start, start + max(1, CHUNK // len(offsets)))
        texels = local[part].astype(int)[:, None] + offsets
        away = (texels + 0.5 - local[part][:, None]) @ world_from_texel.T
        inside = (away**2).sum(-1) < radii[part][:, None] ** 2
        inside &= ((texels >= 0) & (texels < size)).all(-1)
        out[tuple(texels[inside].T[::-1])] = 1.0


def texels_for(size: Sequence[int]) -> tuple[int, int, int]:
    """Texels for a volume of so many voxels: as many, or fewer in the same proportion."""
    share = min(1.0, (MOST_TEXELS / float(np.prod(size))) ** (1 / 3))
    x, y, z = (max(1, round(n * share)) for n in size)
    return x, y, z
