"""Periodic boxes of simulations: molecules put together again, and held where they were.

A simulation keeps atoms in a box whose opposite walls are one: what leaves through a wall comes in
at the other, so that a molecule may lie in the file in pieces, and leap from frame to frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import (
    OTHER_POLYMER,
    POLYMER_NUCLEIC,
    POLYMER_PROTEIN,
    Molecule,
)

HOLDS = ("auto", "none", "place", "pose")
"""What stays from frame to frame: see :class:`Holder`."""
_POLYMERS = (POLYMER_PROTEIN, POLYMER_NUCLEIC, OTHER_POLYMER)
_APART = 12.0
"""Å between neighbours in the file, of one polymer, beyond which another molecule begins."""
_TRACE = ("CA", "P", "BB")
"""Names of the atoms that poses are fitted to, where there are some: carbon α, phosphorus, and
the backbone beads of coarse grains."""


def box_of(vectors: NDArray | None) -> NDArray[np.float64] | None:
    """Rows of a box's (3, 3) vectors; ``None`` where they span nothing: there is no box."""
    if vectors is None:
        return None
    box = np.asarray(vectors, np.float64).reshape(3, 3)
    if not np.isfinite(box).all() or abs(np.linalg.det(box)) < 1e-6:
        return None
    return box


def shortest_height(box: NDArray[np.float64]) -> float:
    """Distance of the nearest two opposite walls."""
    return float(1 / np.linalg.norm(np.linalg.inv(box), axis=0).max())


class Holder:
    """Puts each frame of a trajectory together, by itself: no frame depends on the one before.

    Whole molecules: atoms follow their neighbour in the file by the nearest image, within a
    polymer's chain or another residue. Polymers keep the images in which they lay in the first
    frame; what is about them is taken where it is nearest to them.

    Held in place, the polymers' middle stays where it was in the first frame; held in pose, they
    are also turned to fit it best (least squares over the trace: Kabsch 1976).

    Args:
        molecule: Of the frames; its positions do not matter.
        first: (n, 3) positions of the first frame, Å.
        box: Its box, (3, 3) rows, or None.
        whole: Put molecules together where frames have a box.
        hold: One of :data:`HOLDS`; auto is place where the first frame has a box and is put
            together, else none.
    """

    def __init__(
        self,
        molecule: Molecule,
        first: NDArray[np.float32],
        box: NDArray[np.float64] | None,
        whole: bool = True,
        hold: str = "auto",
    ) -> None:
        self._whole = whole
        if hold == "auto":
            hold = "place" if whole and box is not None else "none"
        self._hold = hold
        polymer = np.isin(molecule.kind, _POLYMERS)
        self._held = polymer if polymer.any() else np.ones(len(molecule), bool)
        self._starts = _unit_starts(molecule, polymer, first, box)
        self._sizes = np.diff(np.r_[self._starts, len(molecule)])
        self._polymer = polymer[self._starts]
        trace = self._held & np.isin(molecule.atom_name, _TRACE)
        self._fitted = np.flatnonzero(trace if trace.sum() >= 3 else self._held)
        self._offsets: NDArray[np.float64] | None = None
        if whole and box is not None:
            first = self._together(first, box)
        self._middle = first[self._held].mean(axis=0, dtype=np.float64)
        self._reference = first[self._fitted].astype(np.float64)

    def __call__(
        self, positions: NDArray[np.float32], box: NDArray[np.float64] | None
    ) -> NDArray[np.float32]:
        """(n, 3) positions of a frame, put together and held."""
        if self._whole and box is not None:
            positions = self._together(positions, box)
        if self._hold == "place":
            shift = self._middle - positions[self._held].mean(axis=0, dtype=np.float64)
            positions = (positions + shift).astype(np.float32)
        elif self._hold == "pose":
            positions = self._posed(positions)
        return positions

    def _together(
        self, positions: NDArray[np.float32], box: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        inverse = np.linalg.inv(box).astype(np.float64)
        shift = _unwrapped(positions, self._starts, inverse)
        middles = np.add.reduceat(positions + shift @ box, self._starts) / self._sizes[:, None]
        images = np.zeros((len(self._starts), 3))
        polymers = np.flatnonzero(self._polymer)
        if len(polymers):
            self._place_polymers(middles, images, polymers, box, inverse)
            weights = self._sizes[polymers, None]
            middle = ((middles + images @ box)[polymers] * weights).sum(axis=0) / weights.sum()
            about = ~self._polymer
            images[about] = -np.round((middles[about] - middle) @ inverse)
        shift += np.repeat(images, self._sizes, axis=0)
        return (positions + shift @ box).astype(np.float32)

    def _place_polymers(
        self,
        middles: NDArray[np.float64],
        images: NDArray[np.float64],
        polymers: NDArray[np.intp],
        box: NDArray[np.float64],
        inverse: NDArray[np.float64],
    ) -> None:
        """Write the images of the polymers: as in the first frame, or each near those before it."""
        largest = polymers[np.argmax(self._sizes[polymers])]
        if self._offsets is not None:
            wanted = middles[largest] + self._offsets
            images[polymers] = np.round((wanted - middles[polymers]) @ inverse)
            return
        total, count = middles[largest] * self._sizes[largest], self._sizes[largest]
        for unit in polymers[polymers != largest]:
            images[unit] = np.round((total / count - middles[unit]) @ inverse)
            total = total + (middles[unit] + images[unit] @ box) * self._sizes[unit]
            count += self._sizes[unit]
        self._offsets = (middles + images @ box)[polymers] - middles[largest]

    def _posed(self, positions: NDArray[np.float32]) -> NDArray[np.float32]:
        from scipy.spatial.transform import Rotation

        now = positions[self._fitted].astype(np.float64)
        here, there = now.mean(axis=0), self._reference.mean(axis=0)
        if len(now) < 3:
            return (positions + (there - here)).astype(np.float32)
        # no rotation is nearest where all atoms lie on one line: any of the best will do
        turn = Rotation.align_vectors(self._reference - there, now - here)[0].as_matrix()
        return ((positions - here) @ turn.T + there).astype(np.float32)


def put_together(molecule: Molecule, box: NDArray[np.float64] | None) -> None:
    """Move the atoms of a molecule that was just read so that what a box cut is whole.

    Before its bonds and secondary structure are worked out.
    """
    if box is not None:
        molecule.positions[:] = Holder(molecule, molecule.positions, box)(molecule.positions, box)


def _unit_starts(
    molecule: Molecule,
    polymer: NDArray[np.bool_],
    first: NDArray[np.float32],
    box: NDArray[np.float64] | None,
) -> NDArray[np.intp]:
    """First atoms of what is put together by itself: parts of polymers, and other residues."""
    new = np.ones(len(molecule), bool)
    other_residue = molecule.residue[1:] != molecule.residue[:-1]
    both = polymer[1:] & polymer[:-1]
    step = np.diff(first.astype(np.float64), axis=0)
    if box is not None:
        step -= np.round(step @ np.linalg.inv(box)) @ box
    apart = np.linalg.norm(step, axis=1) > _APART
    chain = molecule.chain[1:] != molecule.chain[:-1]
    new[1:] = other_residue & (~both | chain | apart)
    return np.flatnonzero(new)


def _unwrapped(
    positions: NDArray[np.float32], starts: NDArray[np.intp], inverse: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n, 3) whole boxes to add to each atom, so that each is near the one before it."""
    step = np.diff(positions.astype(np.float64), axis=0, prepend=positions[:1])
    crossed = -np.round(step @ inverse)
    crossed[starts] = 0
    total = np.cumsum(crossed, axis=0)
    sizes = np.diff(np.r_[starts, len(positions)])
    return total - np.repeat(total[starts], sizes, axis=0)
