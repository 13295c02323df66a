"""Van der Waals radii.

Bondi, J. Phys. Chem. 68 (1964) 441, where he gives one; the remaining main-group elements from
Mantina et al., J. Phys. Chem. A 113 (2009) 5806, who continued his scale consistently.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.scene.molecule import Molecule
from scuro.style.elements import NUMBER_OF, SYMBOLS

UNKNOWN_RADIUS = 1.7
"""Å, for atoms without an element: most often carbon or a united atom of its size."""
METAL_RADIUS = 2.0
"""Å, for elements that neither paper lists: all of them are metals."""

_BONDI = """H 1.20 He 1.40 Li 1.82 C 1.70 N 1.55 O 1.52 F 1.47 Ne 1.54 Na 2.27 Mg 1.73 Si 2.10
P 1.80 S 1.80 Cl 1.75 Ar 1.88 K 2.75 Ni 1.63 Cu 1.40 Zn 1.39 Ga 1.87 As 1.85 Se 1.90 Br 1.85
Kr 2.02 Pd 1.63 Ag 1.72 Cd 1.58 In 1.93 Sn 2.17 Te 2.06 I 1.98 Xe 2.16 Pt 1.75 Au 1.66 Hg 1.55
Tl 1.96 Pb 2.02 U 1.86"""
_MANTINA = """Be 1.53 B 1.92 Al 1.84 Ca 2.31 Ge 2.11 Rb 3.03 Sr 2.49 Sb 2.06 Cs 3.43 Ba 2.68
Bi 2.07 Po 1.97 At 2.02 Rn 2.20 Fr 3.48 Ra 2.83"""


def _table() -> NDArray[np.float32]:
    table = np.full(256, METAL_RADIUS, np.float32)
    table[0] = table[len(SYMBOLS) :] = UNKNOWN_RADIUS
    words = f"{_BONDI} {_MANTINA}".split()
    for symbol, radius in zip(words[::2], words[1::2], strict=True):
        table[NUMBER_OF[symbol.upper()]] = float(radius)
    return table


VAN_DER_WAALS = _table()
"""(256,) Å, by atomic number."""


def atom_radii(molecule: Molecule) -> NDArray[np.float32]:
    """Radius (n,) in Å of each atom: the file's own where it gives them, else van der Waals."""
    if molecule.radius is not None:
        return np.asarray(molecule.radius, np.float32)
    return VAN_DER_WAALS[molecule.element]
