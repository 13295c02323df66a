"""Regions of a molecule by a tree of selections: domains, subunits, whatever has a name.

Written as ``NAME=SELECTION; NAME/INNER=SELECTION; …``: an inner part holds those atoms of its outer
part that its selection matches. Later parts take atoms from earlier ones beside them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.molecule import Molecule
from scuro.scene.regions import Division

REST = "rest"
"""What no part holds."""
Path = tuple[str, ...]


def parse_tree(text: str) -> dict[Path, str]:
    """Selection of each part, by path, outer parts first.

    Raises:
        SettingsError: An entry has no name or selection, a name appears twice, or an inner part's
            outer one is missing.
    """
    found: dict[Path, str] = {}
    for entry in filter(str.strip, text.split(";")):
        name, equals, selection = entry.partition("=")
        path = tuple(part.strip() for part in name.split("/"))
        if not equals or not all(path) or not selection.strip():
            raise SettingsError(f"'{entry.strip()}' is no part: write NAME=SELECTION; NAME=…")
        if path in found:
            raise SettingsError(f"the part '{'/'.join(path)}' is given twice")
        found[path] = selection.strip()
    for path in found:
        if len(path) > 1 and path[:-1] not in found:
            raise SettingsError(
                f"'{'/'.join(path)}' is part of '{'/'.join(path[:-1])}', which is not given"
            )
    return dict(sorted(found.items(), key=lambda item: len(item[0])))


def divisions(molecule: Molecule, tree: dict[Path, str]) -> list[Division]:
    """Ever finer divisions of a molecule: the levels of the tree, then chains, then residues.

    Raises:
        SettingsError: A selection is not understood.
    """
    from scuro.style.selection import select

    place: NDArray[np.int32] = np.zeros(len(molecule), np.int32)
    paths: list[Path] = [(REST,)]
    for path, selection in tree.items():
        mask = select(molecule, selection)
        if len(path) > 1:
            outer = np.flatnonzero([p[: len(path) - 1] == path[:-1] for p in paths])
            mask = mask & np.isin(place, outer)
        place[mask] = len(paths)
        paths.append(path)
    found: list[Division] = []
    for depth in range(1, max((len(p) for p in tree), default=0) + 1):
        cut = [p[:depth] for p in paths]
        names = list(dict.fromkeys(cut))
        number = np.array([names.index(c) for c in cut], np.int32)
        labels = tuple(name[-1] for name in names)
        found.append(Division(f"part {depth}", number[place], labels))
    chains = tuple(map(str, molecule.chain_names))
    found.append(_finer(found, Division("chain", molecule.chain, chains)))
    residues = tuple(
        f"{name} {number}"
        for name, number in zip(molecule.residue_name, molecule.residue_number, strict=True)
    )
    found.append(_finer(found, Division("residue", molecule.residue, residues)))
    return found


def _finer(above: list[Division], division: Division) -> Division:
    """The division within the last one above it: every level refines the one before."""
    if not above:
        return division
    pairs = np.stack([above[-1].group, division.group], axis=1)
    kinds, group = np.unique(pairs, axis=0, return_inverse=True)
    names = tuple(division.names[k] for k in kinds[:, 1].tolist())
    return Division(division.name, group.reshape(-1).astype(np.int32), names)
