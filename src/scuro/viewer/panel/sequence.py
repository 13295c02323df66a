"""The sequence of a chain as a strip of letters; a click selects a residue."""

from __future__ import annotations

import numpy as np

from scuro.kept import kept_with
from scuro.scene.items import MoleculeItem
from scuro.scene.molecule import Molecule
from scuro.viewer import navigate
from scuro.viewer.pick import Pick
from scuro.viewer.theme import ACCENT
from scuro.viewer.view import View

_LETTERS = {
    "ALA": "A", "ARG": "R", "ASN": "N", "ASP": "D", "CYS": "C", "GLN": "Q", "GLU": "E", "GLY": "G",
    "HIS": "H", "ILE": "I", "LEU": "L", "LYS": "K", "MET": "M", "PHE": "F", "PRO": "P", "SER": "S",
    "THR": "T", "TRP": "W", "TYR": "Y", "VAL": "V", "MSE": "M", "SEC": "U", "PYL": "O",
    "DA": "A", "DC": "C", "DG": "G", "DT": "T", "A": "A", "C": "C", "G": "G", "U": "U",
}  # fmt: skip
"""One letter for each residue of polymers."""
_ROW, _GROUP = 20, 10
"""Residues a line, and between gaps."""
_NUMBERS, _CELL, _GAP, _LINE = 40.0, 12.0, 6.0, 17.0
"""Widths of the column of numbers, of a letter and of a gap, and height of a line."""


@kept_with
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
        letters = sequence(item.molecule, index)
        imgui.push_style_var(imgui.StyleVar_.selectable_text_align, imgui.ImVec2(0.5, 0.5))
        imgui.push_style_var(imgui.StyleVar_.item_spacing, imgui.ImVec2(0, 0))
        imgui.push_style_color(imgui.Col_.header, ACCENT)  # as what is selected in the picture
        clipper = imgui.ListClipper()
        clipper.begin(-(-len(letters) // _ROW), _LINE)
        while clipper.step():
            for row in range(clipper.display_start, clipper.display_end):
                self._line(item, letters, row * _ROW)
        imgui.pop_style_color()
        imgui.pop_style_var(2)
        imgui.spacing()

    def _line(self, item: MoleculeItem, letters: list[tuple[str, int, int]], first: int) -> None:
        """The number of a line's first residue, and its letters, each in a cell of its own."""
        from imgui_bundle import imgui

        molecule = item.molecule
        chosen = [p.element for p in self.view.selection if p.item is item and p.element >= 0]
        selected = set(molecule.residue[chosen].tolist()) if chosen else set()
        top, number = imgui.get_cursor_pos(), str(letters[first][1])
        imgui.set_cursor_pos_x(top.x + _NUMBERS - 10 - imgui.calc_text_size(number).x)
        imgui.text_disabled(number)
        for place, (letter, number_here, atom) in enumerate(letters[first : first + _ROW]):
            x = top.x + _NUMBERS + place * _CELL + place // _GROUP * _GAP
            imgui.set_cursor_pos((x, top.y))
            residue = int(molecule.residue[atom])
            pressed, _ = imgui.selectable(
                f"{letter}##{first + place}", residue in selected, 0, imgui.ImVec2(_CELL, _LINE)
            )
            imgui.set_item_tooltip(f"{molecule.residue_name[residue]} {number_here}")
            if pressed:
                self._select(item, atom, imgui.get_io().key_shift)
        imgui.set_cursor_pos((top.x, top.y + _LINE))
        imgui.dummy((0, 0))

    def _select(self, item: MoleculeItem, atom: int, add: bool) -> None:
        bodies = item.bodies()
        local = item.molecule.positions[atom].astype(float)
        x, y, z = local.tolist()
        found = Pick(item, bodies[0], 0, 0, atom, (x, y, z))
        self.view.select(found, add)
        if not add:
            self.view.move(navigate.centered(self.view.camera, found.anchor))
