"""Bonds within residues by their names, from the Chemical Component Dictionary (CCD).

The dictionary is biotite's copy (``components.bcif``), opened with our BinaryCIF reader: importing
``biotite.structure`` costs more than half a second, the file's bond table less.
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_ORDER = {"SING": 1, "DOUB": 2, "TRIP": 3, "AROM": 4, "QUAD": 3, "DELO": 4}

ALIASES = {
    **dict.fromkeys(("HSD", "HSE", "HSP", "HID", "HIE", "HIP", "HISA", "HISB", "HISH"), "HIS"),
    **dict.fromkeys(("CYX", "CYM", "CYS2"), "CYS"),
    **dict.fromkeys(("ASH", "ASPH"), "ASP"),
    **dict.fromkeys(("GLH", "GLUH"), "GLU"),
    **dict.fromkeys(("LYN", "LYSH"), "LYS"),
    **dict.fromkeys(("WAT", "H2O", "DOD", "SOL", "TIP3", "TIP", "TP3", "SPC"), "HOH"),
    **dict.fromkeys(("ADE", "RA"), "A"),
    **dict.fromkeys(("CYT", "RC"), "C"),
    **dict.fromkeys(("GUA", "RG"), "G"),
    **dict.fromkeys(("URA", "RU"), "U"),
    "THY": "DT",
}
"""Names of simulation programs for residues that the CCD calls otherwise."""


@dataclass(frozen=True, eq=False)
class Template:
    """Bonds of one component."""

    atoms: tuple[tuple[str, str], ...]
    """Names of the bonded atoms."""
    order: NDArray[np.uint8]
    """1, 2, 3; 4 aromatic."""


@cache
def templates(names: tuple[str, ...]) -> dict[str, Template]:
    """The templates of these residue names, as far as the CCD has them."""
    comp, starts, columns = _dictionary()
    found = {}
    for name in names:
        row = comp.get(ALIASES.get(name, name))
        if row is None:
            continue
        span = slice(starts[row], starts[row + 1])
        first, second, order, aromatic = (column[span] for column in columns)
        orders = [
            4 if flag == "Y" else _ORDER.get(word, 0)
            for flag, word in zip(aromatic, order, strict=True)
        ]
        pairs = tuple(zip(first.tolist(), second.tolist(), strict=True))
        found[name] = Template(_with_old_names(pairs), np.tile(np.array(orders, np.uint8), 2))
    return found


def _with_old_names(pairs: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
    """Every bond twice: with the CCD's names and with those of old files and force fields."""
    return pairs + tuple((_old(a), _old(b)) for a, b in pairs)


def _old(name: str) -> str:
    return {"OP1": "O1P", "OP2": "O2P", "OP3": "O3P", "C7": "C5M", "H": "HN"}.get(
        name, name.replace("'", "*")
    )


@cache
def _dictionary() -> tuple[dict[str, int], NDArray[np.intp], list[NDArray[np.str_]]]:
    """Component name to group, each group's first row, and the columns of the bond table."""
    from scuro.load.bcif import BinaryCif

    # find_spec of the top package does not import it
    spec = importlib.util.find_spec("biotite")
    assert spec is not None and spec.origin is not None, "biotite is a dependency of scuro"
    path = Path(spec.origin).parent / "structure" / "info" / "components.bcif"
    category = BinaryCif(path.read_bytes()).category("chem_comp_bond")
    index, names = category["comp_id"].coded()
    heads = np.flatnonzero(np.r_[True, index[1:] != index[:-1]])
    comp = {names[i]: row for row, i in enumerate(index[heads].tolist())}
    columns = [
        category[key].text()
        for key in ("atom_id_1", "atom_id_2", "value_order", "pdbx_aromatic_flag")
    ]
    return comp, np.r_[heads, len(index)], columns
