"""Backbone trace: rods from CA to CA and from P to P."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.geometry import Geometry
from scuro.scene.molecule import Molecule
from scuro.style.chains import nucleic_trace, protein_trace
from scuro.style.options import Representation
from scuro.style.sticks import balls


def backbone(
    molecule: Molecule, atoms: NDArray, colors: NDArray[np.uint8], options: Representation
) -> Geometry:
    """Rods along the chains, rounded at the joints; gaps in a chain stay open."""
    traces = (protein_trace(molecule, atoms), nucleic_trace(molecule, atoms))
    joints = np.concatenate([trace.atoms for trace in traces])
    pairs = [np.stack([t.atoms[t.joined], t.atoms[t.joined + 1]], axis=1) for t in traces]
    ends = np.concatenate(pairs)
    rods = np.empty((len(ends), 2, 4), np.float32)
    rods[:, :, :3] = molecule.positions[ends]
    rods[:, :, 3] = options.backbone_radius
    radii = np.full(len(joints), options.backbone_radius, np.float32)
    return Geometry(
        **balls(molecule, joints, colors, radii),
        rods=rods,
        rod_colors=colors[ends],
        rod_ids=ends.astype(np.int32),
    )
