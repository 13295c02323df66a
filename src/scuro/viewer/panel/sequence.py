"""The sequence of a chain as a strip of letters; a click selects a residue."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scuro.scene.items import MoleculeItem
from scuro.scene.molecule import Molecule
from scuro.viewer import navigate
from scuro.viewer.pick import Pick
from scuro.viewer.view import View

_LETTERS = {
    "ALA": "A", "ARG": "R", "ASN": "N", "ASP": "D", "CYS": "C", "GLN": "Q", "GLU": "E", "GLY": "G",
    "HIS": "H", "ILE": "I", "LEU": "L", "LYS": "K", "MET": "M", "PHE": "F", "PRO": "P", "SER": "S",
    "THR": "T", "TRP": "W", "TYR": "Y", "VAL": "V", "MSE": "M", "SEC": "U", "PYL": "O",
    "DA": "A", "DC": "C", "DG": "G", "DT": "T", "A": "A", "C": "C", "G": "G", "U": "U",
}  # fmt: skip
"""One letter for each residue of polymers."""
_ROW = 24
"""Residues a line."""


@lru_cache(maxsize=8)
def sequence(molecule: Molecule, chain: int) -> list[tuple[str, int, int]]:
    """Letter, author's number and one atom (the alpha carbon or phosphorus) of each residue.

    Residues that are no part of a polymer are left out.
    """
    inside = molecule.chain == chain
    residues, firsts = np.unique(molecule.residue[inside], return_index=True)
    atoms = np.flatnonzero(inside)[firsts]
    names = np.char.strip(molecule.atom_name.astype(str))
    traced = np.flatnonzero(inside & ((names == "CA") | (names == "P")))
    anchors = dict(zip(molecule.residue[traced].tolist(), traced.tolist(), strict=True))
    found = []
    for residue, atom in zip(residues.tolist(), atoms.tolist(), strict=True):
        letter = _LETTERS.get(str(molecule.residue_name[residue]).strip())
        if letter is not None:
            number = int(molecule.residue_number[residue])
            found.append((letter, number, anchors.get(residue, atom)))
    return found


class SequenceStrip:
    """The part of the panel with the sequences of the scene's chains."""

    def __init__(self, view: View) -> None:
        self.view = view
        self._chain = 0

    def draw(self) -> None:
        """A choice of chains, and the letters of the one that was chosen."""
        from imgui_bundle import imgui

        items = self.view.model.scene.molecules
        if not items or not imgui.collapsing_header("Sequence"):
            return
        chains = [
            (item, index)
            for item in items
            for index in range(len(item.molecule.chain_names))
            if sequence(item.molecule, index)
        ]
        if not chains:
            imgui.text_disabled("no polymer")
            return
        names = [f"{item.molecule.name} {item.molecule.chain_names[i]}" for item, i in chains]
        self._chain = min(self._chain, len(chains) - 1)
        _, self._chain = imgui.combo("chain", self._chain, names)
        item, index = chains[self._chain]
        selected = {p.element for p in self.view.selection if p.item is item}
        letters = sequence(item.molecule, index)
        for place, (letter, number, atom) in enumerate(letters):
            if place % _ROW:
                imgui.same_line(0, 1)
            pressed, _ = imgui.selectable(
                f"{letter}##{index}.{place}", atom in selected, 0, imgui.ImVec2(10, 14)
            )
            name = item.molecule.residue_name[item.molecule.residue[atom]]
            imgui.set_item_tooltip(f"{name} {number}")
            if pressed:
                self._select(item, atom, imgui.get_io().key_shift)

    def _select(self, item: MoleculeItem, atom: int, add: bool) -> None:
        bodies = item.bodies()
        local = item.molecule.positions[atom].astype(float)
        x, y, z = local.tolist()
        found = Pick(item, bodies[0], 0, 0, atom, (x, y, z))
        self.view.select(found, add)
        if not add:
            self.view.move(navigate.centered(self.view.camera, found.anchor))
