"""scuro's own form of a cell-scale model: a table with one row an instance.

As text (``.csv``, ``.tsv``; comma, tab or semicolon), with a header line that names the columns in
any order::

    ingredient,compartment,structure,x,y,z,qx,qy,qz,qw
    albumin,plasma,1e7i.pdb,10.5,-3,88,0,0,0,1
    CA,envelope/capsid/surface,capsid.cif,…

``ingredient``, ``x``, ``y`` and ``z`` (ångström) are needed. ``compartment`` is a path with ``/``
between its parts, empty for the root. ``structure`` is a file name, looked for beside the table
and in ``--structures``; without it the ingredient's name is looked for. It is centred on its
centroid. The quaternion (x, y, z, w) turns column vectors, right-handed; without it nothing is
turned. Lines that begin with ``#`` are skipped.

``structure`` may also be another table: its instances are then placed as a whole (a virus in a
cell), below the ingredient's name.

As ``.meso`` (a NumPy archive), the same in arrays: ``ingredients`` (m, 3) text (name, compartment,
structure), ``ingredient`` (n,) row numbers into it, ``positions`` (n, 3), ``rotations`` (n, 4).
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError, SaveError
from scuro.load.mesoscale_structures import StructureLibrary, finite_places, unit_quaternions
from scuro.load.options import LoadOptions
from scuro.load.source import Source, open_source
from scuro.scene.geometry import Frames
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure

TABLES = (".csv", ".tsv", ".meso")
NEEDED = ("ingredient", "x", "y", "z")
TURN = ("qx", "qy", "qz", "qw")
KNOWN = (*NEEDED, "compartment", "structure", *TURN)
MOST_SINGLE = 100_000
"""Instances up to which a nested table is placed instance by instance."""
MOST_FRAMES = 50_000_000
"""Places of a model within models; more would not fit into memory."""


@dataclass(frozen=True, eq=False)
class _Table:
    """A table as arrays: (name, compartment, structure) of each ingredient, rows by ingredient."""

    ingredients: list[tuple[str, str, str]]
    ingredient: NDArray[np.int64]
    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]


def read_table(source: Source, options: LoadOptions) -> MesoscaleModel:
    """Read a table of instances, text or ``.meso``, with the tables it names.

    Raises:
        LoadError: The table is damaged, a column is missing, or tables contain each other.
    """
    return _read(source, options, ())


def _read(source: Source, options: LoadOptions, above: tuple[Path, ...]) -> MesoscaleModel:
    here = (source.path or Path(source.name)).resolve()
    if here in above:
        chain = " → ".join(p.name for p in (*above[above.index(here) :], here))
        raise LoadError(source.name, f"contains itself: {chain}; break the circle")
    table = _read_npz(source) if source.suffix == ".meso" else _read_text(source)
    library = StructureLibrary(source, options)
    notes: list[str] = []
    ingredients: list[Ingredient] = []
    root = source.stem
    for number, (name, compartment, structure) in enumerate(table.ingredients):
        mine = np.flatnonzero(table.ingredient == number)
        mine = mine[finite_places(table.positions[mine], notes, name)]
        if len(mine) == 0:
            continue
        positions = table.positions[mine]
        rotations = unit_quaternions(table.rotations[mine], notes, name)
        path = (root, *(p for p in compartment.split("/") if p), name)
        if structure.lower().endswith(TABLES):
            inner_path = here.parent / structure
            inner = _read(open_source(inner_path), options, (*above, here))
            ingredients += _nested(source, inner, path, rotations, positions)
            notes += inner.notes
            continue
        wanted = structure or name
        found = library.structure((wanted,))
        if found is None:
            found = library.stand_in(name, wanted, table.positions)
        ingredients.append(Ingredient(path, (Part(found.centered, rotations, positions),)))
    if not ingredients:
        raise LoadError(source.name, "places no instance")
    return MesoscaleModel(root, tuple(ingredients), source.name, (*notes, *library.notes))


def _nested(
    source: Source,
    inner: MesoscaleModel,
    path: tuple[str, ...],
    rotations: NDArray[np.float32],
    positions: NDArray[np.float64],
) -> Iterator[Ingredient]:
    """The ingredients of a model that is itself placed many times.

    Few instances are placed one by one, which traces fastest; many stay a model with its places.
    """
    outer = Frames(rotations, positions)
    # one object for all ingredients of an assembly, at every depth: it is what tells them apart
    composed: dict[int, Frames] = {}
    few = inner.instances * len(outer) <= MOST_SINGLE
    for ingredient in inner.ingredients:
        placed = replace(ingredient, path=(*path, *ingredient.path[1:]))
        if ingredient.frames is not None:
            if len(ingredient.frames) * len(outer) > MOST_FRAMES:
                raise LoadError(
                    source.name,
                    f"'{path[-1]}' places {len(outer):,} copies of what holds "
                    f"{len(ingredient.frames):,} models: more than {MOST_FRAMES:,} do not fit "
                    "into memory",
                )
            key = id(ingredient.frames)
            if key not in composed:
                composed[key] = outer.placing(ingredient.frames)
            yield replace(placed, frames=composed[key])
        elif few and not ingredient.curves:
            singles = [
                (part.structure, outer.placing(Frames(part.rotations, part.positions)))
                for part in ingredient.parts
            ]
            yield replace(
                placed, parts=tuple(Part(s, at.rotations, at.positions) for s, at in singles)
            )
        else:
            yield replace(placed, frames=outer)


def _read_text(source: Source) -> _Table:
    lines = [
        (number, line)
        for number, line in enumerate(source.text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise LoadError(source.name, "is an empty table")
    head = lines[0][1]
    separator = next((s for s in ("\t", ";", ",") if s in head), ",")
    columns = [c.strip().lower() for c in head.split(separator)]
    missing = [c for c in NEEDED if c not in columns]
    if missing:
        raise LoadError(
            source.name,
            f"has no column '{missing[0]}': a table of instances has {', '.join(KNOWN)} "
            "(the last six may be left out)",
            lines[0][0],
        )
    turned = all(c in columns for c in TURN)
    if not turned and any(c in columns for c in TURN):
        raise LoadError(source.name, "needs all of qx, qy, qz, qw or none", lines[0][0])
    fields = [(f"c{i}", "U128" if c not in (*NEEDED[1:], *TURN) else "f8")
              for i, c in enumerate(columns)]  # fmt: skip
    try:
        rows = np.loadtxt(
            io.StringIO("\n".join(line for _, line in lines[1:])),
            dtype=fields, delimiter=separator, comments=None, ndmin=1,
        )  # fmt: skip
    except ValueError:
        raise _bad_row(source, lines[1:], separator, columns) from None

    def text(column: str) -> NDArray[np.str_]:
        if column not in columns:
            return np.full(len(rows), "")
        return np.char.strip(rows[f"c{columns.index(column)}"])

    def numbers(names: tuple[str, ...]) -> NDArray[np.float64]:
        return np.stack([rows[f"c{columns.index(c)}"] for c in names], axis=-1)

    keys = np.stack([text("ingredient"), text("compartment"), text("structure")], axis=-1)
    kinds, which = np.unique(keys, axis=0, return_inverse=True)
    rotations = numbers(TURN) if turned else np.tile([0.0, 0, 0, 1], (len(rows), 1))
    names = [(str(a), str(b), str(c)) for a, b, c in kinds]
    return _Table(names, which.reshape(-1), numbers(("x", "y", "z")), rotations)


def _bad_row(
    source: Source, lines: list[tuple[int, str]], separator: str, columns: list[str]
) -> LoadError:
    """What is wrong with the first row that cannot be read."""
    for number, line in lines:
        cells = line.split(separator)
        if len(cells) != len(columns):
            why = f"has {len(cells)} values where the header has {len(columns)} columns"
            return LoadError(source.name, why, number)
        for cell, column in zip(cells, columns, strict=True):
            if column in (*NEEDED[1:], *TURN):
                try:
                    float(cell)
                except ValueError:
                    why = f"'{cell.strip()}' in column {column} is not a number"
                    return LoadError(source.name, why, number)
    return LoadError(source.name, "is not a readable table")


def _read_npz(source: Source) -> _Table:
    try:
        with np.load(io.BytesIO(source.data), allow_pickle=False) as file:
            kinds = file["ingredients"].astype(str).reshape(-1, 3)
            which = file["ingredient"].astype(np.int64).reshape(-1)
            positions = file["positions"].astype(np.float64).reshape(-1, 3)
            rotations = file["rotations"].astype(np.float64).reshape(-1, 4)
    except KeyError as error:
        raise LoadError(source.name, f"is not a table of instances: {error.args[0]}") from None
    except (ValueError, OSError, EOFError, zipfile.BadZipFile):
        raise LoadError(source.name, "is damaged, or not a archive of instances") from None
    if not len(which) == len(positions) == len(rotations):
        raise LoadError(source.name, "has arrays of different lengths")
    if len(which) and not (which.min() >= 0 and which.max() < len(kinds)):
        raise LoadError(source.name, "has instances of ingredients that it does not list")
    return _Table([(str(a), str(b), str(c)) for a, b, c in kinds], which, positions, rotations)


def save_table(path: Path, model: MesoscaleModel) -> None:
    """Write a model as a table: ``.meso``, ``.csv`` or ``.tsv``.

    Every structure is written beside it as a list of spheres (``.bin``). Curves have no rows.

    Raises:
        SaveError: The ending is none of these, the model has curves, or a file cannot be written.
    """
    if any(i.curves for i in model.ingredients):
        raise SaveError(path, "cannot hold the model's curves: tables have instances only")
    if any(i.frames for i in model.ingredients):
        raise SaveError(path, "cannot hold models within models: save each and name its table")
    kinds, which, positions, rotations = [], [], [], []
    spheres: dict[str, Structure] = {}
    for ingredient in model.ingredients:
        for part in ingredient.parts:
            base = re.sub(r"[^A-Za-z0-9]+", "-", part.structure.name).strip("-") or "structure"
            file_name = f"{path.stem}-{base}.bin"
            if spheres.setdefault(file_name, part.structure) is not part.structure:
                file_name = f"{path.stem}-{base}-{len(spheres) + 1}.bin"
                spheres[file_name] = part.structure
            kinds.append((ingredient.name, "/".join(ingredient.path[1:-1]), file_name))
            which.append(np.full(len(part), len(kinds) - 1))
            positions.append(part.positions)
            rotations.append(part.rotations)
    arrays = {
        "ingredients": np.array(kinds),
        "ingredient": np.concatenate(which),
        "positions": np.concatenate(positions),
        "rotations": np.concatenate(rotations),
    }
    suffix = path.suffix.lower()
    if suffix not in TABLES:
        raise SaveError(path, f"has an ending that is not one of {', '.join(TABLES)}")
    try:
        for file_name, structure in spheres.items():
            path.with_name(file_name).write_bytes(structure.spheres.astype("<f4").tobytes())
        beside = path.with_name(f".{path.name}.part")
        with open(beside, "wb") as file:
            if suffix == ".meso":
                np.savez_compressed(file, allow_pickle=False, **arrays)
            else:
                _write_text(file, arrays, "," if suffix == ".csv" else "\t")
        beside.replace(path)
    except OSError as error:
        raise SaveError(path, f"cannot be written ({error.strerror})") from None


def _write_text(file: io.BufferedWriter, arrays: dict[str, NDArray], separator: str) -> None:
    columns = ("ingredient", "compartment", "structure", "x", "y", "z", *TURN)
    file.write((separator.join(columns) + "\n").encode())
    heads = [separator.join(kind) for kind in arrays["ingredients"].tolist()]
    rows = np.concatenate([arrays["positions"], arrays["rotations"]], axis=1)
    for number, row in zip(arrays["ingredient"].tolist(), rows.tolist(), strict=True):
        numbers = separator.join(f"{value:.6g}" for value in row)
        file.write(f"{heads[number]}{separator}{numbers}\n".encode())
