"""Cartoon: bands for helices, arrows for strands, tubes for coils and nucleic acids, base slabs.

After Richardson (1981) and Carson & Bugg (J. Mol. Graph. 4 (1986) 121): a curve through the CA
atoms, a band that lies in the plane of the peptides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Geometry
from scuro.scene.molecule import COIL, HELIX, STRAND, Molecule
from scuro.style.chains import Trace, atom_of_residue, protein_trace
from scuro.style.nucleic import nucleic_cartoon
from scuro.style.options import Representation
from scuro.style.ribbon import Rings, frames, hermite, sweep
from scuro.style.sticks import balls, unit

FINE, MEDIUM = 1500, 6000
"""Residues up to which a cartoon is drawn with the finest, and the middle, subdivision."""
ARROW_LENGTH = 1.5
"""Residues that an arrow head takes, a multiple of one half."""


def cartoon(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], options: Representation
) -> Geometry:
    """Proteins and nucleic acids as cartoons; other atoms are not shown."""
    residues = int(np.count_nonzero(np.bincount(molecule.residue[atoms])))
    segments, sides = subdivision(residues, options)
    trace = protein_trace(molecule, atoms)
    protein = sweep(protein_rings(molecule, atoms, trace, segments, options), sides, colors)
    alone = trace.atoms[trace.starts & trace.ends]
    radii = np.full(len(alone), options.tube_radius, np.float32)
    nucleic = nucleic_cartoon(molecule, atoms, colors, segments, sides, options)
    spheres = balls(molecule, alone, colors, radii)
    return join(Geometry(**spheres), protein, *nucleic)


def subdivision(residues: int, options: Representation) -> tuple[int, int]:
    """Pieces per residue (even) and points around a cross-section (a multiple of four)."""
    usual = (8, 12) if residues <= FINE else (6, 8) if residues <= MEDIUM else (4, 8)
    segments, sides = options.segments or usual[0], options.sides or usual[1]
    return segments + segments % 2, -(-sides // 4) * 4


def join(*parts: Geometry) -> Geometry:
    """One geometry of several in the same frame, without their coarser levels."""
    joined: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in Geometry.__dataclass_fields__
        if name != "levels"
    }
    return Geometry(**joined)


def protein_rings(
    molecule: Molecule, atoms: NDArray, trace: Trace, segments: int, options: Representation
) -> Rings:
    """Cross-sections along all protein chains of two residues or more."""
    single = trace.starts & trace.ends
    trace = Trace(trace.atoms[~single], trace.residues[~single], trace.starts[~single])
    kind = molecule.secondary[trace.residues]
    points = molecule.positions[trace.atoms].astype(np.float64)
    guides = _guides(molecule, atoms, trace, points, kind)
    points = _smooth(points, trace, kind == STRAND, passes=2)

    places = _places(trace, kind, segments, options)
    centers, slopes = hermite(points, trace.starts, places.residue, places.way)
    across, _ = hermite(guides, trace.starts, places.residue, places.way)
    tangents = unit(slopes)
    return Rings(
        centers=centers,
        tangents=tangents,
        sides=frames(tangents, across),
        shapes=places.shapes,
        starts=places.starts,
        owners=trace.atoms[places.owner],
    )


def _guides(
    molecule: Molecule, atoms: NDArray, trace: Trace, points: NDArray, kind: NDArray
) -> NDArray:
    """Direction of the width (k, 3) at each residue, without sudden turns along the chain.

    Strands and coils lie in the peptide plane, D = (A × B) × A with A from CA to CA and B from CA
    to O (Carson & Bugg). Helices, and residues without O, take the curve's binormal, which on a
    helix is its axis tilted to stand on the tangent.
    """
    index = np.arange(len(trace))
    before, after = np.where(trace.starts, index, index - 1), np.where(trace.ends, index, index + 1)
    along = points[after] - points[before]
    binormal = np.cross(points - points[before], points[after] - points)

    oxygen = atom_of_residue(molecule, atoms, ("O", "OT1", "O1", "OXT"))[trace.residues]
    toward = molecule.positions[np.maximum(oxygen, 0)] - points
    forward = points[after] - np.where(trace.ends[:, None], points[before], points)
    planar = np.cross(np.cross(forward, toward), forward)

    use_binormal = (kind == HELIX) | (oxygen < 0)
    guide = np.where(use_binormal[:, None], unit(binormal), unit(planar))
    # The ends of a chain have half a neighbourhood and often no order: they follow the next. So do
    # residues beside a strand, or they would twist its arrow head.
    beside = (kind != STRAND) & (kind[np.stack([before, after])] == STRAND)
    follows = np.where(beside[0], before, np.where(beside[1], after, index))
    follows = np.where(trace.starts, after, np.where(trace.ends, before, follows))
    guide = frames(unit(along), guide[follows])
    # Neighbouring peptides of a strand point opposite ways: turn every one to agree with the last.
    opposite = (guide[1:] * guide[:-1]).sum(-1) < 0
    turns = np.cumprod(np.append(1.0, np.where(opposite, -1.0, 1.0))[: len(guide)])
    return unit(_smooth(guide * turns[:, None], trace, kind != COIL, passes=2))


def _smooth(values: NDArray, trace: Trace, where: NDArray, passes: int) -> NDArray:
    """Binomial filter (1 2 1)/4 along the chains; ends of chains stay."""
    if len(values) == 0:
        return values
    where = (where & ~trace.starts & ~trace.ends)[:, None]
    for _ in range(passes):
        mean = (np.roll(values, 1, axis=0) + 2 * values + np.roll(values, -1, axis=0)) / 4
        values = np.where(where, mean, values)
    return values


@dataclass(frozen=True)
class _Places:
    """Where the rings stand along the chains, s of them, and their shapes."""

    residue: NDArray[np.intp]
    way: NDArray
    """(s,) 0 to 1, from that residue to the next."""
    owner: NDArray[np.intp]
    """(s,) the residue that a ring belongs to."""
    starts: NDArray[np.bool_]
    """(s,) the first ring of every closed piece."""
    shapes: NDArray
    """(s, 3), see :class:`Rings`."""


def _places(trace: Trace, kind: NDArray, segments: int, options: Representation) -> _Places:
    """Rings for residues of each kind: COIL, HELIX or STRAND (k,).

    Residue i owns the chain from i - 1/2 to i + 1/2. Bands flare out of coils smoothly. Strands
    begin, and arrow heads widen, in a step: one closed piece ends where the next begins.
    """
    k = len(trace)
    index = np.arange(k)
    after = np.where(trace.ends, index, index + 1)
    strand = kind == STRAND
    arrow_from, arrow_to = _arrows(trace, strand)

    # A template of places for every residue; the second of two equal places is the step's far side.
    way = np.arange(segments) / segments
    way = np.sort(np.append(way, [0.0, 0.5]))
    far = np.append(False, way[1:] == way[:-1])
    at, t = np.repeat(index, len(way)), np.tile(way, k)
    far = np.tile(far, k)
    widens = (at + t == arrow_from[at]) & ~trace.starts[at]
    into = kind[after[at]]
    begins = (t == 0.5) & ((into == STRAND) & ~strand[at] | (into == HELIX) & strand[at])
    step = widens | begins
    kept = np.where(trace.ends[at], t == 0, True) & (~far | step)
    first = (step & far) | ((t == 0) & ~far & trace.starts[at])
    near = step & ~far
    at, t, near, first = at[kept], t[kept], near[kept], first[kept]

    half = options.ribbon_thickness / 2
    tube = np.full(3, options.tube_radius)
    band = np.array([options.ribbon_width / 2, half, half])
    bar = np.array([options.ribbon_width / 2, half, 0.2 * half])
    head = bar * [options.arrow_width, 1, 1]
    usual = np.array([tube, band, bar])  # COIL, HELIX, STRAND

    own, next_ = kind[at], kind[after[at]]
    owner = np.where((t > 0.5) | ((t == 0.5) & ~near), after[at], at)
    shapes = usual[kind[owner]]
    flare = ((own != next_) & (own != STRAND) & (next_ != STRAND))[:, None]
    ease = (t * t * (3 - 2 * t))[:, None]
    shapes = np.where(flare, usual[own] + ease * (usual[next_] - usual[own]), shapes)

    place = at + t
    begin, end = arrow_from[owner], arrow_to[owner]
    pointed = strand[owner] & ((place > begin) | ((place == begin) & ~near))
    share = np.clip((place - begin) / np.maximum(end - begin, 0.25), 0, 1)[:, None]
    shapes = np.where(pointed[:, None], head + share * (tube - head), shapes)
    return _Places(at, t, owner, first, shapes)


def _arrows(trace: Trace, strand: NDArray[np.bool_]) -> tuple[NDArray, NDArray]:
    """For residues of strands, where the arrow head begins and ends, in residues (k,)."""
    k = len(trace)
    index = np.arange(k)
    first = strand & (trace.starts | ~np.append(False, strand[:-1])[:k])
    last = strand & (trace.ends | ~np.append(strand[1:], False)[:k])
    starts, ends = np.flatnonzero(first), np.flatnonzero(last)
    which = np.clip(np.cumsum(first) - 1, 0, None)
    if len(starts) == 0:
        return np.full(k, -1.0), np.full(k, -1.0)
    head_end = np.where(trace.ends[ends], ends, ends + 0.5)
    tail = np.where(trace.starts[starts], starts, starts - 0.5)
    head_begin = head_end - ARROW_LENGTH
    head_begin = np.where(head_begin - tail > 0.5, head_begin, tail)  # short strands: all head
    begin, end = head_begin[which], head_end[which]
    return np.where(strand, begin, -1.0), np.where(strand, end, index)
