"""Cartoon of nucleic acids: a tube through the phosphates, a slab for every base."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Geometry
from scuro.scene.molecule import POLYMER_NUCLEIC, Molecule
from scuro.style.chains import Trace, atom_of_residue, nucleic_trace
from scuro.style.options import Representation
from scuro.style.ribbon import Rings, ends_of, frames, hermite, sweep
from scuro.style.sticks import balls, unit

RING_ATOMS = ("N1", "C2", "N3", "C4", "C5", "C6", "N7", "C8", "N9")
MARGIN, THICKNESS = 0.45, 0.3
"""Å: a slab reaches this far beyond its ring atoms' centres; half its thickness."""
LINK_RADIUS = 0.3
"""Å: radius of the rod from the tube to a slab, in a tube of the usual radius or thicker."""

# The corners of a box, by the bits x, y, z of their number, around each face from outside.
_FACES = np.array(
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
)
_FACE_NORMALS = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])


def nucleic_cartoon(
    molecule: Molecule,
    atoms: NDArray,
    colors: NDArray[np.uint8],
    segments: int,
    sides: int,
    options: Representation,
) -> list[Geometry]:
    """Tubes, base slabs, and rods that join them, of the nucleic acids among ``atoms``."""
    atoms = atoms[molecule.kind[atoms] == POLYMER_NUCLEIC]
    trace = nucleic_trace(molecule, atoms)
    if len(trace) == 0:
        return []
    sugar = atom_of_residue(molecule, atoms, ("C1'", "C1*"))[trace.residues]
    points, starts, owners, place = _with_three_prime_ends(molecule, atoms, trace)
    guides = molecule.positions[np.maximum(sugar, 0)] - molecule.positions[trace.atoms]
    guides = guides[np.searchsorted(place, np.arange(len(points)), side="right") - 1]

    tube = _tube(points, guides, starts, owners, segments, options.nucleic_radius)
    last = ends_of(starts)
    anchors, _ = hermite(points, starts, place, np.where(last[place], 0.0, 0.5))
    lone = starts & last
    radii = np.full(np.count_nonzero(lone), options.nucleic_radius)
    ball = Geometry(**balls(molecule, owners[lone], colors, radii))
    return [
        sweep(tube, sides, colors),
        ball,
        _bases(molecule, atoms, trace, sugar, anchors, colors),
    ]


def _with_three_prime_ends(
    molecule: Molecule, atoms: NDArray, trace: Trace
) -> tuple[NDArray, NDArray[np.bool_], NDArray[np.intp], NDArray[np.intp]]:
    """The trace's points with O3' after the last residue of every run, whose sugar lies beyond P.

    Returns:
        Points (p, 3), starts (p,), owners (p,) and, for each residue, its place among the points.
    """
    oxygen = atom_of_residue(molecule, atoms, ("O3'", "O3*"))[trace.residues]
    extended = np.flatnonzero(trace.ends & (oxygen >= 0))
    points = molecule.positions[trace.atoms].astype(np.float64)
    points = np.insert(points, extended + 1, molecule.positions[oxygen[extended]], axis=0)
    starts = np.insert(trace.starts, extended + 1, False)
    owners = np.insert(trace.atoms, extended + 1, trace.atoms[extended])
    place = np.arange(len(trace)) + np.searchsorted(extended, np.arange(len(trace)))
    return points, starts, owners, place


def _tube(
    points: NDArray,
    guides: NDArray,
    starts: NDArray[np.bool_],
    owners: NDArray[np.intp],
    segments: int,
    radius: float,
) -> Rings:
    last = ends_of(starts)
    kept = ~(starts & last)
    points, guides, starts, owners = points[kept], guides[kept], starts[kept], owners[kept]
    last = last[kept]
    at = np.repeat(np.arange(len(points)), segments)
    t = np.tile(np.arange(segments) / segments, len(points))
    at, t = at[(t == 0) | ~last[at]], t[(t == 0) | ~last[at]]
    centers, slopes = hermite(points, starts, at, t)
    across, _ = hermite(guides, starts, at, t)
    tangents = unit(slopes)
    return Rings(
        centers,
        tangents,
        frames(tangents, across),
        np.full((len(at), 3), radius),
        starts[at] & (t == 0),
        owners[np.where(t > 0.5, np.minimum(at + 1, len(owners) - 1), at)],
    )


def _bases(
    molecule: Molecule,
    atoms: NDArray,
    trace: Trace,
    sugar: NDArray,
    anchors: NDArray,
    colors: NDArray[np.uint8],
) -> Geometry:
    """Slabs in the bases' planes and the rods that hold them; bases without rings have none."""
    carbons = [
        atom_of_residue(molecule, atoms, (name,))[trace.residues] for name in ("C2", "C4", "C6")
    ]
    whole = (np.array([sugar, *carbons]) >= 0).all(axis=0)
    if not whole.any():
        return Geometry()
    residues, sugar, anchors = trace.residues[whole], sugar[whole], anchors[whole]
    two, four, six = (molecule.positions[c[whole]].astype(np.float64) for c in carbons)
    origin = molecule.positions[sugar].astype(np.float64)
    normal = unit(np.cross(four - two, six - two))
    x = frames(normal, (two + four + six) / 3 - origin)
    axes = np.stack([x, np.cross(normal, x), normal], axis=1)  # (r, 3, 3) rows

    number = np.full(len(molecule.residue_name), -1)
    number[residues] = np.arange(len(residues))
    ring = atoms[np.isin(molecule.atom_name[atoms], RING_ATOMS)]
    ring = ring[number[molecule.residue[ring]] >= 0]
    base = number[molecule.residue[ring]]
    local = np.einsum("aij,aj->ai", axes[base], molecule.positions[ring] - origin[base])
    low, high = np.full((2, len(residues), 3), np.inf) * np.array([1, -1]).reshape(2, 1, 1)
    np.minimum.at(low, base, local)
    np.maximum.at(high, base, local)
    low[:, :2] -= MARGIN
    high[:, :2] += MARGIN
    low[:, 2], high[:, 2] = -THICKNESS, THICKNESS

    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    corners = np.where(bits, high[:, None], low[:, None])  # (r, 8, 3)
    corners = origin[:, None] + corners @ axes
    faces = corners[:, _FACES[:, [0, 1, 2, 0, 2, 3]]].reshape(-1, 3, 3)
    normals = np.repeat((_FACE_NORMALS @ axes), 2, axis=1).reshape(-1, 1, 3).repeat(3, axis=1)
    ids = np.repeat(sugar, 12)[:, None].repeat(3, axis=1).astype(np.int32)

    inside = origin + (low[:, :1] + LINK_RADIUS) * x
    rods = np.empty((len(residues), 2, 4), np.float32)
    rods[:, 0, :3], rods[:, 1, :3] = anchors, inside
    rods[:, :, 3] = LINK_RADIUS
    ends = np.stack([trace.atoms[whole], sugar], axis=1).astype(np.int32)
    return Geometry(
        rods=rods,
        rod_colors=colors[ends],
        rod_ids=ends,
        triangles=faces.astype(np.float32),
        triangle_normals=normals.astype(np.float32),
        triangle_colors=colors[ids],
        triangle_ids=ids,
    )
