"""BinaryCIF of Mol* Mesoscale Explorer: atoms and assembly operators in one file.

``entity.pdbx_description`` is the dotted path of an ingredient; rows of
``pdbx_struct_assembly_gen`` place chains by ranges of operators; ``pdbx_struct_oper_list`` has
their 3×4 matrices (right-handed, ångström, rounded by the file's quantisation). A membrane comes
as patches: one operator places some hundred lipid chains, each of which is an instance here.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.bcif import BinaryCif, Column
from scuro.load.options import LoadOptions
from scuro.load.source import Source
from scuro.load.structure import read_bcif as read_structure
from scuro.scene.geometry import quaternions
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure
from scuro.scene.molecule import Molecule
from scuro.style.elements import NUMBER_OF
from scuro.style.radii import VAN_DER_WAALS

RANGE = re.compile(r"^(\d+)-(\d+)$")


def read_bcif(source: Source, options: LoadOptions) -> MesoscaleModel | Molecule:
    """Read BinaryCIF: a cell-scale model if it is one, else a structure.

    Raises:
        LoadError: The file is damaged.
    """
    if b"root." in source.data:  # else the file need not be decoded to know
        try:
            file = BinaryCif(source.data)
            if is_explorer(file):
                return model_of_bcif(source, file)
        except LoadError:
            raise
        except Exception as error:  # damaged bytes raise whatever the decoders meet first
            said = " ".join(str(error).split())[:120] or type(error).__name__
            raise LoadError(source.name, f"is damaged, or is not BinaryCIF ({said})") from error
    return read_structure(source, options)


def is_explorer(file: BinaryCif) -> bool:
    """Whether a BinaryCIF file is such a model: dotted paths below a common root."""
    column = file.category("entity").get("pdbx_description")
    if column is None or not column.is_text:
        return False
    paths = column.text().tolist()
    return bool(paths) and all(p.startswith("root.") for p in paths)


def model_of_bcif(source: Source, file: BinaryCif) -> MesoscaleModel:
    """Build the model from an opened BinaryCIF file.

    Raises:
        LoadError: A category or column is missing, or nothing is placed.
    """
    try:
        atoms = _atoms(file.category("atom_site"))
        matrices = _operators(file.category("pdbx_struct_oper_list"))
        generators = file.category("pdbx_struct_assembly_gen")
        expressions = generators["oper_expression"].text().tolist()
        chain_lists = generators["asym_id_list"].text().tolist()
        entities = file.category("entity")
        numbers = entities["id"].numbers().astype(int).tolist()
        paths = dict(zip(numbers, entities["pdbx_description"].text().tolist(), strict=True))
    except KeyError as error:
        raise LoadError(
            source.name, f"lacks the column {error}, which a Mesoscale Explorer model has"
        ) from None
    descriptions: dict[int, str] = {}
    if "pdbx_parent_entity_id" in entities:
        texts = entities["pdbx_parent_entity_id"].text().tolist()
        descriptions = dict(zip(numbers, texts, strict=True))
    notes: list[str] = []
    placed = _placed_chains(expressions, chain_lists, notes)
    ingredients = _ingredients(source.stem, atoms, paths, placed, matrices, descriptions, notes)
    if not ingredients:
        raise LoadError(source.name, "places no chain that has atoms")
    return MesoscaleModel(source.stem, tuple(ingredients), source.name, tuple(notes))


class _Atoms:
    """Atoms sorted by chain, with each chain's run and entity."""

    def __init__(
        self,
        positions: NDArray,
        radius: NDArray[np.float32],
        element: NDArray[np.uint8],
        chain: NDArray[np.int64],
        names: list[str],
        entity: NDArray,
    ) -> None:
        order = np.argsort(chain, kind="stable")
        spheres = np.concatenate([positions, radius[:, None]], axis=1)[order]
        self.spheres = spheres.astype(np.float32)
        self.element = element[order]
        starts = np.searchsorted(chain[order], np.arange(len(names) + 1)).tolist()
        filled = [i for i in range(len(names)) if starts[i] < starts[i + 1]]
        self.run = {names[i]: (starts[i], starts[i + 1]) for i in filled}
        self.entity = {names[i]: int(entity[order[starts[i]]]) for i in filled}


def _atoms(site: Mapping[str, Column]) -> _Atoms:
    positions = np.stack([site[f"Cartn_{a}"].numbers() for a in "xyz"], axis=1)
    index, symbols = site["type_symbol"].coded()
    numbers = np.array([NUMBER_OF.get(s.upper(), 0) for s in symbols], np.uint8)[index]
    asym, names = site["label_asym_id"].coded()
    entity = site["label_entity_id"].numbers().astype(int)
    return _Atoms(positions, VAN_DER_WAALS[numbers], numbers, asym, names, entity)


def _operators(table: Mapping[str, Column]) -> dict[int, NDArray[np.float64]]:
    """(3, 4) matrix of each operator id."""
    columns = [
        table[name].numbers()
        for row in "123"
        for name in (*(f"matrix[{row}][{c}]" for c in "123"), f"vector[{row}]")
    ]
    matrices = np.stack(columns, axis=1).reshape(-1, 3, 4).astype(np.float64)
    return dict(zip(table["id"].numbers().astype(int).tolist(), matrices, strict=True))


def expand_operators(expression: str) -> list[int]:
    """Operator ids of ``(a-b)``, ``(n)`` or a list of them; a range written backwards is empty."""
    found: list[int] = []
    for item in expression.strip().strip("()").split(","):
        ends = RANGE.match(item.strip())
        if ends:
            found += range(int(ends[1]), int(ends[2]) + 1)
        elif item.strip().isdigit():
            found.append(int(item))
        elif item.strip():
            raise ValueError(f"operator expression '{expression}'")
    return found


def _placed_chains(
    expressions: list[str], chain_lists: list[str], notes: list[str]
) -> list[tuple[tuple[str, ...], list[int]]]:
    """Chains and operator ids of every generator row that places something."""
    placed, empty = [], 0
    for expression, chains in zip(expressions, chain_lists, strict=True):
        operators = expand_operators(expression)
        if operators:
            placed.append((tuple(chains.split(",")), operators))
        else:
            empty += 1
    if empty:
        notes.append(f"{empty} rows of the assembly name no operator (empty or backward ranges)")
    return placed


def _ingredients(
    root: str,
    atoms: _Atoms,
    paths: dict[int, str],
    placed: list[tuple[tuple[str, ...], list[int]]],
    matrices: dict[int, NDArray],
    descriptions: dict[int, str],
    notes: list[str],
) -> list[Ingredient]:
    """Group chains into instances, and instances into the ingredients of the entities.

    Chains of a row that share an entity move together and are one instance, except in a membrane,
    where every chain is a lipid of its own.
    """
    units: dict[tuple[int, tuple[str, ...]], list[int]] = defaultdict(list)
    bare: set[str] = set()
    unknown = 0
    for chains, operators in placed:
        known = [o for o in operators if o in matrices]
        unknown += len(operators) - len(known)
        groups: dict[int, list[str]] = defaultdict(list)
        for chain in chains:
            if chain in atoms.run:
                groups[atoms.entity[chain]].append(chain)
            else:
                bare.add(chain)
        for entity, members in groups.items():
            if "membrane" in paths.get(entity, ""):
                for chain in members:
                    units[entity, (chain,)] += known
            else:
                units[entity, tuple(members)] += known
    if bare:
        notes.append(f"{len(bare):,} chains are placed but have no atoms; left out")
    if unknown:
        notes.append(f"{unknown:,} placements name operators that are not in the file; left out")
    parts: dict[int, list[Part]] = defaultdict(list)
    for (entity, chains), operators in units.items():
        if operators:
            placements = np.stack([matrices[o] for o in operators])
            structure = _structure(atoms, chains)
            middle = structure.centroid
            parts[entity].append(
                Part(
                    structure.centered,
                    quaternions(placements[:, :, :3]),
                    placements[:, :, :3] @ middle + placements[:, :, 3],
                )
            )
    idle = [paths[e] for e in paths if e not in parts]
    if idle:
        notes.append(f"entities without atoms or places: {', '.join(idle)}")
    return [
        Ingredient(
            (root, *paths.get(e, f"root.entity {e}").split(".")[1:]),
            tuple(parts[e]),
            description=descriptions.get(e, ""),
        )
        for e in sorted(parts, key=lambda e: str(paths.get(e, "")))
    ]


def _structure(atoms: _Atoms, chains: tuple[str, ...]) -> Structure:
    rows = np.concatenate([np.arange(*atoms.run[c]) for c in chains])
    chain = np.repeat(
        np.arange(len(chains), dtype=np.int32), [np.subtract(*atoms.run[c][::-1]) for c in chains]
    )
    return Structure(chains[0], atoms.spheres[rows], atoms.element[rows], chain, chain, chains)
