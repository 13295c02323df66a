"""cellPACK's serialized pair: a tree of compartments in JSON, the placements in a binary file.

The binary file is little-endian float32. With N instances: first N × (x, y, z, ingredient id),
then N × quaternion (x, y, z, w). Files whose name ends in ``LH`` are left-handed (Unity): position
(x, y, z) becomes (-x, y, z), quaternion (x, y, z, w) becomes (x, -y, -z, w). Every structure is
centred on its centroid, and ``source.transform.offset`` is already in the positions.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.mesoscale_cellpack import coarse_spheres
from scuro.load.mesoscale_structures import StructureLibrary, finite_places, unit_quaternions
from scuro.load.source import Source, open_source
from scuro.scene.model import Ingredient, MesoscaleModel, Part

DEEPEST = 64
"""Compartments deeper than this are taken for a tree that contains itself."""


def model_of_serialized(
    source: Source, content: dict[str, Any], library: StructureLibrary
) -> MesoscaleModel:
    """Build the model from the parsed JSON and the binary file beside it.

    Raises:
        LoadError: The binary file is missing or does not fit the JSON, or an ingredient's number
            appears twice.
    """
    root = str(content.get("name") or source.stem)
    entries = list(_entries(source, content, (root,)))
    binary = _binary_beside(source)
    positions, quaternions, numbers = _placements(binary)
    by_number: dict[int, tuple[tuple[str, ...], dict]] = {}
    for place, entry in entries:
        number = entry.get("ingredient_id")
        if not isinstance(number, int) or number in by_number:
            raise LoadError(
                source.name, f"ingredient '{place[-1]}' has no ingredient_id of its own"
            )
        by_number[number] = place, entry
    notes: list[str] = []
    strangers = ~np.isin(numbers, list(by_number))
    if strangers.any():
        notes.append(f"{int(strangers.sum()):,} instances name no ingredient of the tree; dropped")
    ingredients = []
    for number, (place, entry) in by_number.items():
        mine = np.flatnonzero(numbers == number)
        mine = mine[finite_places(positions[mine], notes, place[-1])]
        stated = entry.get("nbMol")
        if isinstance(stated, int) and stated != len(mine):
            notes.append(f"{place[-1]}: {stated:,} instances stated, {len(mine):,} found")
        if len(mine) == 0:
            continue
        origin = entry.get("source") or {}
        given = origin.get("pdb")
        wanted = str(given) if given and str(given) != "None" else place[-1]
        structure = library.structure(
            (wanted, place[-1], place[-1].split("__")[-1]), copies=bool(origin.get("biomt"))
        )
        if structure is None:
            structure = library.stand_in(place[-1], wanted, positions, coarse_spheres(entry))
        rotations = unit_quaternions(quaternions[mine], notes, place[-1])
        part = Part(structure.centered, rotations, positions[mine])
        ingredients.append(Ingredient(place, (part,)))
    if not ingredients:
        raise LoadError(binary, f"places none of the ingredients of {source.name}")
    return MesoscaleModel(root, tuple(ingredients), source.name, (*notes, *library.notes))


def _entries(
    source: Source, node: dict[str, Any], above: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], dict[str, Any]]]:
    """Path and entry of every ingredient below a compartment."""
    if len(above) > DEEPEST:
        raise LoadError(
            source.name, f"has compartments nested deeper than {DEEPEST}: '{above[-1]}'"
        )
    for group in node.get("IngredientGroups") or ():
        name = str(group.get("name") or "ingredients")
        for entry in group.get("Ingredients") or ():
            yield (*above, name, str(entry.get("name") or "unnamed")), entry
    for child in node.get("Compartments") or ():
        name = str(child.get("name") or "compartment")
        yield from _entries(source, child, (*above, name))


def _binary_beside(source: Source) -> Path:
    folder = source.path.parent if source.path else Path()
    for name in (f"{source.stem}LH.bin", f"{source.stem}.bin"):
        if (folder / name).is_file():
            return folder / name
    raise LoadError(
        source.name,
        f"is the tree of a serialized model without its placements: {source.stem}LH.bin or "
        f"{source.stem}.bin must lie beside it",
    )


def _placements(binary: Path) -> tuple[NDArray, NDArray, NDArray[np.int64]]:
    """Right-handed positions (N, 3), quaternions (N, 4) x, y, z, w and ingredient ids (N,)."""
    data = open_source(binary).data
    if not data or len(data) % 32:
        raise LoadError(
            binary, "does not hold placements: its size is not a multiple of 32 bytes an instance"
        )
    first, second = np.frombuffer(data, "<f4").reshape(2, -1, 4).astype(np.float64)
    numbers = np.where(np.isfinite(first[:, 3]), first[:, 3], -1).astype(np.int64)
    if binary.stem.endswith("LH"):
        first *= [-1, 1, 1, 1]
        second = second * [1, -1, -1, 1]
    return first[:, :3], second, numbers
