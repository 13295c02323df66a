"""The solvent-excluded surface: what a ball of solvent that rolls over the atoms cannot enter.

Richards, Annu. Rev. Biophys. Bioeng. 6 (1977) 151; Connolly, J. Appl. Cryst. 16 (1983) 548. The
ball's centre stays outside the atoms grown by its radius p; the surface lies where the distance to
that outside is p. Distances are found on a grid (as EDTSurf does: Xu & Zhang, PLoS ONE 4 (2009)
e8140), but to the grown atoms themselves, not to voxels: a point outside them, s away from them,
is the centre of an empty ball, so that |x - o| - s bounds the distance from x. Where one atom is
nearest the surface is exact; in the saddle between two it is off by up to 0.4 of the spacing, and
in the corner of three by up to one, outwards: few points of the grid are empty there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import MissingExtraError, SettingsError
from scuro.scene.geometry import Geometry
from scuro.scene.molecule import Molecule
from scuro.style.options import Representation
from scuro.style.radii import atom_radii

FINEST, COARSEST = 0.4, 1.2
"""Spacings of the grid (Å) that are taken unasked: by the number of atoms."""
FINE_ATOMS = 8000
"""Atoms up to which it is the finest."""
MOST_VOXELS = 150_000_000
_SMOOTHING = 0.6
"""Voxels, width of the Gaussian over the distances: creases of grown atoms fall between voxels."""
_STEPS = 65536.0
"""Distances are compared as whole numbers of 1/65536 Å, with the atom in the lower bits."""


def surface(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], options: Representation
) -> Geometry:
    """The solvent-excluded surface of the atoms, each part in its nearest atom's colour.

    Raises:
        MissingExtraError: scikit-image is not installed.
        SettingsError: The grid asked for is too fine for the molecule's size.
    """
    if len(atoms) == 0:
        return Geometry()
    centers = molecule.positions[atoms].astype(np.float64)
    radii = atom_radii(molecule)[atoms].astype(np.float64) * options.sphere_scale
    spacing = options.surface_spacing or usual_spacing(len(atoms))
    probe = options.surface_probe
    grid = _grown(centers, radii, probe, spacing)
    vertices, faces, normals = _contour(_depth(grid, probe) - np.float32(probe), grid)
    nearest, above = _nearest(vertices, grid, centers, radii)
    # where the surface is an atom's own it is known exactly
    outward = (vertices - centers[nearest]) / (above + radii[nearest])[:, None]
    exact = np.clip(2 - np.abs(above) / (0.25 * spacing), 0, 1)[:, None]
    vertices = vertices - exact * above[:, None] * outward
    normals = normals + exact * (outward - normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    owners = atoms[nearest]
    return Geometry(
        triangles=vertices[faces].astype(np.float32),
        triangle_normals=normals[faces].astype(np.float32),
        triangle_colors=colors[owners][faces],
        triangle_ids=owners[faces].astype(np.int32),
    )


def usual_spacing(atoms: int) -> float:
    """Spacing of the grid in Å: triangles grow more slowly than atoms."""
    return float(np.clip(FINEST * (atoms / FINE_ATOMS) ** (1 / 3), FINEST, COARSEST))


@dataclass(frozen=True)
class _Grid:
    """Distance to the grown atoms, and which of them is nearest, around their surface."""

    low: NDArray[np.float64]
    """(3,) position of the first voxel."""
    spacing: float
    distance: NDArray[np.float32]
    """(x, y, z): negative inside; no more than two spacings, up to which it is known."""
    owner: NDArray[np.int32]
    """(x, y, z): index among the atoms; -1 where the distance is not known."""


def _grown(centers: NDArray, radii: NDArray, probe: float, spacing: float) -> _Grid:
    """Distances to the atoms grown by the probe's radius."""
    grown = radii + probe
    reach = float(grown.max()) + 2 * spacing
    low = centers.min(axis=0) - reach - 2 * spacing
    shape = np.ceil((centers.max(axis=0) + reach + 2 * spacing - low) / spacing).astype(int) + 1
    if np.prod(shape, dtype=float) > MOST_VOXELS:
        least = spacing * (np.prod(shape, dtype=float) / MOST_VOXELS) ** (1 / 3)
        raise SettingsError(
            f"a surface on a grid of {spacing:g} Å takes {np.prod(shape, dtype=float):.2g} voxels: "
            f"set surface_spacing to {least:.2g} Å or more"
        )
    best = np.full(int(np.prod(shape)), np.iinfo(np.int64).max)
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    base = np.rint((centers - low) / spacing).astype(np.int64)
    within = centers - (low + base * spacing)  # from the nearest voxel to the atom
    start = base @ strides
    number = np.arange(len(centers))
    around = reach + 0.87 * spacing  # of the voxel, from which the atom is half a diagonal away
    steps = int(around / spacing)
    ball = np.stack(np.meshgrid(*[np.arange(-steps, steps + 1)] * 3, indexing="ij"), -1)
    ball = ball.reshape(-1, 3)
    for offset in ball[np.linalg.norm(ball, axis=1) * spacing <= around]:
        apart = offset * spacing - within
        away = np.sqrt(np.einsum("ij,ij->i", apart, apart)) - grown
        key = (np.rint((away + 64) * _STEPS).astype(np.int64) << 32) | number
        np.minimum.at(best, start + offset @ strides, key)
    known = best != np.iinfo(np.int64).max
    distance = np.where(known, (best >> 32) / _STEPS - 64, np.inf).astype(np.float32)
    np.minimum(distance, 2 * spacing, out=distance)
    owner = np.where(known, best & 0xFFFFFFFF, -1).astype(np.int32)
    return _Grid(low, spacing, distance.reshape(shape), owner.reshape(shape))


def _depth(grid: _Grid, probe: float) -> NDArray[np.float32]:
    """How deep each voxel lies below the grown atoms' surface, exact around depth ``probe``."""
    from scipy.ndimage import distance_transform_edt

    outside, h = grid.distance >= 0, grid.spacing
    steps, places = distance_transform_edt(~outside, return_indices=True)
    depth = np.where(outside, -grid.distance, steps * h).astype(np.float32)
    around = np.flatnonzero(~outside & (np.abs(depth - probe) < 4 * h))
    here = np.stack(np.unravel_index(around, outside.shape)).astype(np.int32)
    nearest = places.reshape(3, -1)[:, around]
    flat, strides = grid.distance.ravel(), np.array(outside.strides)
    place = np.tensordot(strides, nearest, 1)
    apart = (nearest - here).astype(np.float32)
    square = (apart * apart).sum(axis=0)
    best = np.full(len(around), np.inf, np.float32)
    for offset in np.array(list(np.ndindex(3, 3, 3)), np.float32) - 1:
        away = flat[place + int(offset @ strides)]
        bound = square + 2 * (offset @ apart) + offset @ offset
        bound = np.float32(h) * np.sqrt(np.maximum(bound, 0)) - away
        np.minimum(best, bound, out=best, where=away >= 0)
    depth.ravel()[around] = best
    return depth


def _contour(field: NDArray[np.float32], grid: _Grid) -> tuple[NDArray, NDArray, NDArray]:
    """Vertices (v, 3), faces (f, 3), counter-clockwise from outside, and normals (v, 3)."""
    from scipy.ndimage import gaussian_filter

    try:
        from skimage.measure import marching_cubes
    except ImportError:
        raise MissingExtraError("molecular surfaces", "surface") from None
    field = gaussian_filter(field, _SMOOTHING)
    if field.max() <= 0:
        return np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros((0, 3))
    mesh: tuple[Any, ...] = marching_cubes(
        field, 0.0, spacing=(grid.spacing,) * 3, allow_degenerate=False
    )
    vertices, faces, normals = (np.asarray(part) for part in mesh[:3])
    corners = vertices[faces].astype(np.float64)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if np.einsum("ij,ij->", corners[:, 0], across) < 0:  # six times the volume that they enclose
        faces, across = faces[:, ::-1], -across
    if np.einsum("ij,ij->", across, normals[faces[:, 0]]) < 0:
        normals = -normals
    return vertices + grid.low, faces, normals


def _nearest(
    vertices: NDArray, grid: _Grid, centers: NDArray, radii: NDArray
) -> tuple[NDArray[np.intp], NDArray]:
    """The nearest atom (v,) of those that the voxels around know, and the height (v,) above it."""
    corner = np.floor((vertices - grid.low) / grid.spacing).astype(int)
    nearest = np.zeros(len(vertices), np.intp)
    above = np.full(len(vertices), np.inf)
    for offset in np.ndindex(2, 2, 2):
        owner = grid.owner[tuple((corner + offset).T)]
        height = np.linalg.norm(vertices - centers[owner], axis=1) - radii[owner]
        closer = (owner >= 0) & (height < above)
        nearest, above = np.where(closer, owner, nearest), np.where(closer, height, above)
    return nearest, above
