"""cellPACK result JSON: a recipe with the position and rotation of every instance.

Ångström, right-handed. Quaternions are (w, x, y, z) and turn column vectors:
``world = R(q) · local + position``. What *local* is depends on the ingredient's ``source``, see
:func:`_local_structure`. The file lists compartments side by side; which lies in which is worked
out from where their instances are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.mesoscale_structures import StructureLibrary, finite_places, unit_quaternions
from scuro.load.source import Source
from scuro.scene.geometry import rotation_matrices
from scuro.scene.model import Ingredient, MesoscaleModel, Part, Structure

VERSIONS = ("1.",)
"""Beginnings of the recipe versions whose form is known."""
CURVE = "curve"


def model_of_recipe(
    source: Source, content: dict[str, Any], library: StructureLibrary
) -> MesoscaleModel:
    """Build the model from a parsed result file.

    Raises:
        LoadError: Unknown version, or entries that are not of the form.
    """
    recipe = content["recipe"]
    version = str(recipe.get("version", "")) if isinstance(recipe, dict) else ""
    if not version.startswith(VERSIONS):
        raise LoadError(
            source.name,
            f"has recipe version '{version}': versions 1.x of cellPACK results are read",
        )
    root = str(recipe.get("name") or source.stem)
    notes: list[str] = []
    places = list(_places(source, content))
    everywhere = np.concatenate(
        [_all_positions(groups) for _, groups in places] or [np.zeros((0, 3))]
    )
    # (compartment, group or "", ingredient) in the file's order
    found: list[tuple[str, str, Ingredient]] = []
    for compartment, groups in places:
        for group, entries in groups.items():
            for name, entry in entries.items():
                where = f"{compartment or 'outside'}, {name}"
                made = _ingredient(source, name, entry, library, notes, where, everywhere)
                if made.instances:
                    found.append((compartment, group, made))
    if not found:
        raise LoadError(source.name, "places no ingredient: it is a recipe, not a packing result")
    parents = _nesting(found)
    grouped = {c for c in parents.values()} | {c for c, groups in places if c and len(groups) > 1}
    ingredients = [
        replace(
            ingredient,
            path=(
                root,
                *_lineage(compartment, parents),
                *((group,) if compartment in grouped else ()),
                ingredient.name,
            ),
        )
        for compartment, group, ingredient in found
    ]
    return MesoscaleModel(root, tuple(ingredients), source.name, (*notes, *library.notes))


def _places(
    source: Source, content: dict[str, Any]
) -> Iterator[tuple[str, dict[str, dict[str, dict]]]]:
    """Compartment name (empty outside all of them) and its groups of ingredients."""
    outside = content.get("cytoplasme") or content.get("cytoplasm") or {}
    compartments = content.get("compartments") or {}
    if not isinstance(outside, dict) or not isinstance(compartments, dict):
        raise LoadError(source.name, "has compartments that are not objects")
    if outside.get("ingredients"):
        yield "", {"": _entries(source, outside, "cytoplasme")}
    for name, compartment in compartments.items():
        if not isinstance(compartment, dict):
            raise LoadError(source.name, f"has a compartment '{name}' that is not an object")
        groups = {
            group: entries
            for group in ("surface", "interior")
            if (entries := _entries(source, compartment.get(group) or {}, f"{name}, {group}"))
        }
        if groups:
            yield name, groups


def _entries(source: Source, group: Any, where: str) -> dict[str, dict]:
    entries = group.get("ingredients") or {} if isinstance(group, dict) else None
    if not isinstance(entries, dict) or not all(isinstance(e, dict) for e in entries.values()):
        raise LoadError(source.name, f"{where}: its ingredients are not an object of objects")
    return entries


def _all_positions(groups: dict[str, dict[str, dict]]) -> NDArray[np.float64]:
    """(n, 3) places of all instances of a compartment that can be read."""
    found = []
    for entries in groups.values():
        for entry in entries.values():
            found += [r[0] for r in entry.get("results") or () if _is_placement(r)]
            for curve in _curve_names(entry):
                found += [p for p in entry[curve] if len(p) == 3]
    try:
        return np.array(found, np.float64).reshape(-1, 3)
    except (TypeError, ValueError):  # said properly when the ingredient is read
        return np.zeros((0, 3))


def _is_placement(result: Any) -> bool:
    return (
        isinstance(result, list)
        and len(result) >= 2
        and all(isinstance(part, list) for part in result[:2])
        and (len(result[0]), len(result[1])) == (3, 4)
    )


def _nesting(found: list[tuple[str, str, Ingredient]]) -> dict[str, str]:
    """Parent compartment of each compartment that lies within another.

    A compartment is inside another when 95 % of its instances lie within the other's 95th
    percentile of distances from its own middle, and it is the smaller one; its parent is the
    smallest that it is inside of.
    """
    centers: dict[str, list[NDArray]] = {}
    for compartment, _, ingredient in found:
        if compartment:
            centers.setdefault(compartment, []).extend(_centers(ingredient))
    points = {name: np.concatenate(parts) for name, parts in centers.items()}
    spheres = {}
    for name, here in points.items():
        middle = (here.min(axis=0) + here.max(axis=0)) / 2
        spheres[name] = middle, np.percentile(np.linalg.norm(here - middle, axis=1), 95)
    parents = {}
    for name in spheres:
        outer = [
            (radius, other)
            for other, (middle, radius) in spheres.items()
            if radius > spheres[name][1]
            and np.mean(np.linalg.norm(points[name] - middle, axis=1) <= radius) >= 0.95
        ]
        if outer:
            parents[name] = min(outer)[1]
    return parents


def _centers(ingredient: Ingredient) -> list[NDArray[np.float64]]:
    """Where the instances' atoms are: a structure's own origin may lie far from them."""
    return [
        rotation_matrices(part.rotations) @ part.structure.centroid + part.positions
        for part in ingredient.parts
    ] + [np.asarray(curve, np.float64) for curve in ingredient.curves]


def _lineage(compartment: str, parents: dict[str, str]) -> tuple[str, ...]:
    """From the outermost compartment to this one; ``("exterior",)`` outside all.

    Radii shrink from parent to child, so the walk ends.
    """
    if not compartment:
        return ("exterior",)
    chain = [compartment]
    while chain[-1] in parents:
        chain.append(parents[chain[-1]])
    return tuple(reversed(chain))


def _ingredient(
    source: Source,
    name: str,
    entry: dict[str, Any],
    library: StructureLibrary,
    notes: list[str],
    where: str,
    everywhere: NDArray[np.float64],
) -> Ingredient:
    """One ingredient, not yet in its place in the tree; ``everywhere`` is (n, 3), all instances."""
    results = entry.get("results") or []
    if not isinstance(results, list) or not all(map(_is_placement, results)):
        raise LoadError(source.name, f"{where}: results must be pairs [[x, y, z], [w, x, y, z]]")
    try:
        positions = np.array([r[0] for r in results], np.float64).reshape(-1, 3)
        wxyz = np.array([r[1] for r in results], np.float64).reshape(-1, 4)
        curves = tuple(
            np.array(entry[c], np.float32).reshape(-1, 3) for c in _curve_names(entry) if entry[c]
        )
    except (TypeError, ValueError):
        raise LoadError(source.name, f"{where}: holds placements that are not numbers") from None
    parts: tuple[Part, ...] = ()
    good = finite_places(positions, notes, where)
    if good.any():
        local = _local_structure(source, name, entry, everywhere, library, where)
        rotations = unit_quaternions(np.roll(wxyz[good], -1, axis=1), notes, where)
        parts = (Part(local, rotations, positions[good]),)
    if curves:
        notes.append(f"{where}: {len(curves):,} fibres are drawn as tubes")
    return Ingredient((name,), parts, tuple(c for c in curves if np.isfinite(c).all()))


def _curve_names(entry: dict[str, Any]) -> list[str]:
    count = int(entry.get("nbCurve") or 0)
    return [f"{CURVE}{i}" for i in range(count) if isinstance(entry.get(f"{CURVE}{i}"), list)]


def _local_structure(
    source: Source,
    name: str,
    entry: dict[str, Any],
    everywhere: NDArray[np.float64],
    library: StructureLibrary,
    where: str,
) -> Structure:
    """The structure in the frame that the placements refer to.

    The file's own copies first (``biomt``); then either the centroid goes to the origin
    (``center``), or the file's coordinates are kept and ``rotate`` and ``translate`` applied.
    """
    origin = entry.get("source") or {}
    transform = origin.get("transform") or {}
    given = origin.get("pdb")
    file_name = str(given) if given and str(given) != "None" else name
    structure = library.structure((file_name, name), copies=bool(origin.get("biomt")))
    if structure is None:
        return library.stand_in(name, file_name, everywhere, coarse_spheres(entry))
    if transform.get("center"):
        return structure.centered
    try:
        turn = _turn(transform.get("rotate"))
        shift = np.array(transform.get("translate") or [0, 0, 0], np.float64).reshape(3)
    except (TypeError, ValueError):
        raise LoadError(
            source.name, f"{where}: 'rotate' needs 4 numbers, 'translate' needs 3"
        ) from None
    if turn is None and not shift.any():
        return structure
    return structure.moved(np.eye(3) if turn is None else turn, shift)


def _turn(rotate: list[float] | None) -> NDArray[np.float64] | None:
    """Matrix of a ``rotate`` entry: a quaternion (w, x, y, z), or degrees about x, then y, then z.

    The angles' order is undocumented; this is the usual one.
    """
    if not rotate:
        return None
    if len(rotate) == 3:
        x, y, z = np.radians(np.asarray(rotate, np.float64))
        about = np.array(
            [
                [np.sin(x / 2), 0, 0, np.cos(x / 2)],
                [0, np.sin(y / 2), 0, np.cos(y / 2)],
                [0, 0, np.sin(z / 2), np.cos(z / 2)],
            ]
        )
        turn_x, turn_y, turn_z = rotation_matrices(about)
        return turn_z @ turn_y @ turn_x
    w, x, y, z = map(float, rotate)
    q = np.array([[x, y, z, w]]) / np.linalg.norm(rotate)
    return rotation_matrices(q)[0]


def coarse_spheres(entry: dict[str, Any]) -> NDArray[np.float32] | None:
    """(n, 4) the finest level of the sphere tree that some models carry; ``None`` without one."""
    positions, radii = entry.get("positions"), entry.get("radii")
    if not positions or not radii:
        return None
    try:
        centers = np.array(positions[-1], np.float32).reshape(-1, 3)
        sizes = np.array(radii[-1], np.float32).reshape(-1, 1)
        spheres = np.concatenate([centers, sizes], axis=1)
    except (TypeError, ValueError):
        return None
    return spheres if np.isfinite(spheres).all() and (sizes > 0).all() else None
