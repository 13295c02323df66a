"""Bonds: from the file, from residue templates, and by distance where neither knows.

Worked out when first asked for: :func:`deferred` makes the two fields of a molecule.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.load.neighbors import close_pairs
from scuro.load.places import Lookup, residue_key, residue_keys
from scuro.load.radii import COVALENT
from scuro.load.table import FileBonds, Links, first_seen
from scuro.load.templates import templates
from scuro.scene.molecule import (
    ION,
    POLYMER_NUCLEIC,
    POLYMER_PROTEIN,
    SOLVENT,
    Molecule,
    first_atoms,
)

TOLERANCE = 0.45
"""Å that a bond may be longer than the sum of covalent radii (as in Open Babel and Jmol)."""
PEPTIDE_LIMIT, PHOSPHODIESTER_LIMIT = 2.0, 2.4
"""Å: longer C-N and O3'-P distances are gaps in the model, not bonds."""

Bonds = tuple[NDArray[np.int32], NDArray[np.uint8]]


def deferred(given: FileBonds) -> dict[str, Callable[[Molecule], Any]]:
    """The fields ``bonds`` and ``bond_order`` of a molecule, as functions that run at most once."""
    shared = _Deferred(given)
    return {"bonds": shared.bonds, "bond_order": shared.order}


class _Deferred:
    def __init__(self, given: FileBonds) -> None:
        self.given = given
        self.found: Bonds | None = None

    def _find(self, molecule: Molecule) -> Bonds:
        if self.found is None:
            self.found = find_bonds(molecule, self.given)
        return self.found

    def bonds(self, molecule: Molecule) -> NDArray[np.int32]:
        return self._find(molecule)[0]

    def order(self, molecule: Molecule) -> NDArray[np.uint8]:
        return self._find(molecule)[1]


def find_bonds(molecule: Molecule, given: FileBonds) -> Bonds:
    """All bonds of a molecule.

    Args:
        molecule: The atoms.
        given: What the file says; nothing is added to it where it is complete.

    Returns:
        (m, 2) atom indices, lower first and each once, and (m,) orders.
    """
    parts = [_by_serial(molecule, given)]
    if given.links is not None:
        parts.append(_by_name(molecule, given.links))
    if not given.complete:
        pairs, orders, known = _from_templates(molecule)
        parts.append((pairs, orders))
        parts.append(_unknown_order(_polymer_links(molecule)))
        parts.append(_unknown_order(_by_distance(molecule, known)))
    return _merged(np.concatenate([p for p, _ in parts]), np.concatenate([o for _, o in parts]))


def _unknown_order(pairs: NDArray) -> tuple[NDArray, NDArray[np.uint8]]:
    return pairs, np.zeros(len(pairs), np.uint8)


def _merged(pairs: NDArray, order: NDArray[np.uint8]) -> Bonds:
    """Each bond once, the best-known order kept."""
    good = (pairs >= 0).all(axis=1) & (pairs[:, 0] != pairs[:, 1])
    pairs, order = np.sort(pairs[good], axis=1).astype(np.int64), order[good]
    if len(pairs) == 0:
        return np.zeros((0, 2), np.int32), np.zeros(0, np.uint8)
    key = pairs[:, 0] << 32 | pairs[:, 1]
    by = np.lexsort((order, key))
    key, order = key[by], order[by]
    last = np.r_[key[1:] != key[:-1], True]
    kept = key[last]
    return np.stack([kept >> 32, kept & 0xFFFFFFFF], 1).astype(np.int32), order[last]


def _by_serial(molecule: Molecule, given: FileBonds) -> tuple[NDArray, NDArray[np.uint8]]:
    """Bonds between serial numbers, in every model; serials that repeat within one bond nothing."""
    if len(given.serials) == 0:
        return _unknown_order(np.zeros((0, 2), np.int64))
    models, index = np.unique(molecule.model, return_inverse=True)
    base = np.int64(1) << 33
    keys = index.ravel() * base + molecule.serial
    ordered = np.sort(keys)
    repeated = ordered[1:][ordered[1:] == ordered[:-1]]
    lookup = Lookup(keys)
    wanted = np.arange(len(models))[:, None, None] * base + given.serials
    found = np.where(np.isin(wanted, repeated), -1, lookup.find(wanted))
    return found.reshape(-1, 2), np.tile(given.order, len(models))


def _by_name(molecule: Molecule, links: Links) -> tuple[NDArray, NDArray[np.uint8]]:
    keys, models = residue_keys(molecule)
    residues = Lookup(keys)
    names, known = first_seen(molecule.atom_name)
    atoms = _atom_lookup(molecule, names, len(known))
    codes = {name: i for i, name in enumerate(known.tolist())}
    code = np.array([codes.get(n.decode("latin-1"), -1) for n in links.atom.ravel().tolist()])
    code = code.reshape(-1, 2)
    found = []
    for model in range(models):
        key = residue_key(np.maximum(links.chain, 0), links.number, links.insertion, model)
        residue = np.where(links.chain >= 0, residues.find(key), -1)
        atom = atoms.find(residue.astype(np.int64) * len(known) + code)
        found.append(np.where((residue >= 0) & (code >= 0), atom, -1))
    return _unknown_order(np.concatenate(found))


def _atom_lookup(molecule: Molecule, names: NDArray[np.int32], count: int) -> Lookup:
    """Atoms by residue and (number of) name."""
    return Lookup(molecule.residue.astype(np.int64) * count + names)


def _from_templates(molecule: Molecule) -> tuple[NDArray, NDArray[np.uint8], NDArray[np.bool_]]:
    """Bonds within residues whose names the CCD knows.

    Returns:
        Pairs, orders, and for each atom whether its residue's template knows it.
    """
    names, known_names = first_seen(molecule.atom_name)
    residues, residue_names = first_seen(molecule.residue_name)
    codes = {name: i for i, name in enumerate(known_names.tolist())}
    atoms = _atom_lookup(molecule, names, len(known_names))
    pairs, orders = [np.zeros((0, 2), np.int64)], [np.zeros(0, np.uint8)]
    by_type = np.argsort(residues, kind="stable")
    bounds = np.searchsorted(residues[by_type], np.arange(len(residue_names) + 1))
    covered = np.zeros(len(molecule), bool)
    covered[molecule.element == 0] = True  # dummies bond to nothing
    wanted = templates(tuple(residue_names.tolist()))
    for i, residue_name in enumerate(residue_names.tolist()):
        template = wanted.get(residue_name)
        if template is None:
            continue
        mine = by_type[bounds[i] : bounds[i + 1]].astype(np.int64)
        ends = [[codes.get(a, -1), codes.get(b, -1)] for a, b in template.atoms]
        code = np.array(ends, np.int64).reshape(-1, 2)
        there = (code >= 0).all(axis=1)
        found = atoms.find(mine[:, None, None] * len(known_names) + code[there])
        pairs.append(found.reshape(-1, 2))
        orders.append(np.tile(template.order[there], len(mine)))
    joined = np.concatenate(pairs)
    good = (joined >= 0).all(axis=1)
    joined, order = joined[good], np.concatenate(orders)[good]
    covered[joined.ravel()] = True
    return joined, order, covered


def _polymer_links(molecule: Molecule) -> NDArray[np.int64]:
    """C-N bonds between neighbouring amino acids and O3'-P bonds between nucleotides."""
    heads = first_atoms(molecule)
    chain, model = molecule.chain[heads], molecule.model[heads]
    kind = molecule.kind[heads]
    joined = (chain[1:] == chain[:-1]) & (model[1:] == model[:-1])
    found = []
    for polymer, before, after, limit in (
        (POLYMER_PROTEIN, ("C",), ("N",), PEPTIDE_LIMIT),
        (POLYMER_NUCLEIC, ("O3'", "O3*"), ("P",), PHOSPHODIESTER_LIMIT),
    ):
        ends = np.full((len(heads), 2), -1, np.int64)
        for column, names in enumerate((before, after)):
            atoms = np.flatnonzero(np.isin(molecule.atom_name, names))
            ends[molecule.residue[atoms], column] = atoms
        of_kind = kind == polymer
        pairs = np.stack([ends[:-1, 0], ends[1:, 1]], 1)
        pairs = pairs[joined & of_kind[:-1] & of_kind[1:] & (pairs >= 0).all(axis=1)]
        gap = molecule.positions[pairs[:, 0]] - molecule.positions[pairs[:, 1]]
        found.append(pairs[np.einsum("ij,ij->i", gap, gap) < limit**2])
    return np.concatenate(found)


def _by_distance(molecule: Molecule, known: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Bonds of the atoms that no template knows, by distance and covalent radii.

    Never between two hydrogens, across models or alternate locations, nor from an ion or a water
    to anything else; hydrogens bond within their residue only.
    """
    if known.all():
        return np.zeros((0, 2), np.int64)
    loose = ~known
    radius = COVALENT[molecule.element]
    reach = float(2 * radius[loose].max() + TOLERANCE)
    # neighbours of loose atoms only: take what lies in their box
    low = molecule.positions[loose].min(axis=0) - reach
    high = molecule.positions[loose].max(axis=0) + reach
    rows = np.flatnonzero(((molecule.positions >= low) & (molecule.positions <= high)).all(axis=1))
    reach = float(radius[loose].max() + radius[rows].max() + TOLERANCE)
    pairs, squared = close_pairs(molecule.positions[rows], loose[rows], reach)
    pairs = rows[pairs]
    a, b = pairs[:, 0], pairs[:, 1]
    limit = radius[a] + radius[b] + TOLERANCE
    good = (squared < limit**2) & (squared > 0.16)
    hydrogen = molecule.element == 1
    good &= ~(hydrogen[a] & hydrogen[b])
    same = molecule.residue[a] == molecule.residue[b]
    lonely = (molecule.kind == ION) | (molecule.kind == SOLVENT)
    good &= same | ~(lonely[a] | lonely[b] | hydrogen[a] | hydrogen[b])
    good &= (molecule.model[a] == molecule.model[b]) & (
        molecule.element[a] * molecule.element[b] > 0
    )
    alternate = (molecule.altloc[a] != "") & (molecule.altloc[b] != "")
    good &= ~(alternate & (molecule.altloc[a] != molecule.altloc[b]))
    return pairs[good].astype(np.int64)
