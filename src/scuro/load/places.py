"""Finding residues and atoms by the names that files use for them, vectorised."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.load.table import text
from scuro.scene.molecule import Molecule, first_atoms


class Lookup:
    """Rows of an integer table by their key: a sorted array and binary search."""

    def __init__(self, keys: NDArray[np.int64]) -> None:
        self.order = np.argsort(keys, kind="stable")
        self.keys = keys[self.order]

    def find(self, wanted: NDArray[np.int64]) -> NDArray[np.intp]:
        """First row of each wanted key, -1 where there is none."""
        if len(self.keys) == 0:
            return np.full(wanted.shape, -1)
        at = np.minimum(np.searchsorted(self.keys, wanted), len(self.keys) - 1)
        return np.where(self.keys[at] == wanted, self.order[at], -1)


def residue_key(
    chain: NDArray, number: NDArray, insertion: NDArray, model_index: NDArray | int = 0
) -> NDArray[np.int64]:
    """One integer per (model, chain, residue number, insertion code).

    Args:
        chain: Chain indices, below 2^20.
        number: Residue numbers, 24 bits of them.
        insertion: Insertion codes, text of at most one character.
        model_index: Zero-based index of the model, below 2^11.
    """
    if insertion.dtype.kind == "S":
        insertion = text(insertion)
    code = np.zeros(insertion.shape, np.int64)
    if insertion.size and insertion.dtype.itemsize:
        first = np.ascontiguousarray(insertion).view(np.uint32)
        code = first.reshape(*insertion.shape, -1)[..., 0].astype(np.int64) & 0xFF
    low = ((number.astype(np.int64) + (1 << 23)) & 0xFFFFFF) << 8 | code
    return (np.asarray(model_index, np.int64) << 52) | (chain.astype(np.int64) << 32) | low


def residue_keys(molecule: Molecule) -> tuple[NDArray[np.int64], int]:
    """Key of each of a molecule's residues, and the number of models."""
    heads = first_atoms(molecule)
    models, index = np.unique(molecule.model[heads], return_inverse=True)
    keys = residue_key(
        molecule.chain[heads], molecule.residue_number, molecule.insertion_code, index.ravel()
    )
    return keys, len(models)
