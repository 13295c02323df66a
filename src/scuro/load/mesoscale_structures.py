"""Finding and reading the ingredient structures that a cell-scale model names.

Models name their structures loosely (``2hhb``, ``igg.pdb``, ``None``) and are passed on without
them. The library looks in the folders that people keep them in, reads each file once, and lets
spheres stand in for what is missing.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scuro.errors import LoadError
from scuro.load.options import LoadOptions
from scuro.load.source import Source, open_source
from scuro.scene.geometry import rotation_matrices
from scuro.scene.model import Structure
from scuro.scene.molecule import Molecule
from scuro.style.radii import atom_radii

FOLDERS = ("", "proteins", "structures", "PDB", "pdb", "Proteins")
"""Looked into, relative to the model's own folder."""
SUFFIXES = (".pdb", ".cif", ".bcif", ".mmtf", ".ent", ".bin")
TRACE_RADIUS = 3.2
"""Ångström: a sphere of a residue's mean volume (135 Å³), for structures of Cα atoms alone."""


class StructureLibrary:
    """Reads structures by the names that models use; remembers them and what went wrong.

    Args:
        source: The model's file; structures are searched beside it.
        options: ``structures`` is a further folder to search first; with ``strict``, a missing
            structure is an error instead of a stand-in.
    """

    def __init__(self, source: Source, options: LoadOptions) -> None:
        self.source = source
        self.strict = options.strict
        self.notes: list[str] = []
        homes = [] if options.structures is None else [Path(options.structures).expanduser()]
        if homes and not homes[0].is_dir():
            raise LoadError(homes[0], "is not a folder of structures")
        if source.path is not None:
            homes += [source.path.parent / name for name in FOLDERS]
        self._files = _index(homes)
        self._read: dict[tuple[Path, bool], Structure] = {}
        self._room: float | None = None

    def find(self, name: str) -> Path | None:
        """The file for a structure's name, with or without its suffix; ``None`` if there is none.

        A name that ends in ``_word`` (a hand-edited copy that was not passed on) falls back to the
        name without it, and a note says so.
        """
        stem = _stem(name)
        if stem in self._files:
            return self._files[stem]
        shorter = re.sub(r"_[a-z]+$", "", stem)
        if shorter != stem and shorter in self._files:
            found = self._files[shorter]
            self._note(f"structure '{name}' is missing: {found.name} taken in its place")
            return found
        return None

    def structure(self, names: tuple[str, ...], copies: bool = False) -> Structure | None:
        """The structure in the first of the files that there is, as the file has it.

        Args:
            names: Names to try, the best first.
            copies: Whether to expand the file's own copies (its first biological assembly).
        """
        for name in names:
            path = self.find(name)
            if path is not None:
                key = path, copies
                if key not in self._read:
                    self._read[key] = read_structure_spheres(path, copies)
                return self._read[key]
        return None

    def stand_in(
        self,
        ingredient: str,
        wanted: str,
        positions: NDArray,
        spheres: NDArray | None = None,
    ) -> Structure:
        """Spheres in place of a structure that is not there, and a note that says so.

        Args:
            ingredient: Name of the ingredient, for the note.
            wanted: Name of the structure that was looked for.
            positions: (k, 3) places of the model's instances: they tell how large it can be.
            spheres: (n, 4) coarse spheres that the model itself gives, if any.

        Raises:
            LoadError: In strict mode.
        """
        if self.strict:
            raise LoadError(
                self.source.name,
                f"the structure '{wanted}' of ingredient '{ingredient}' is missing: put it next to "
                "the model, or name its folder with --structures",
            )
        if spheres is None or len(spheres) == 0:
            if self._room is None:
                self._room = fitting_radius(positions)
            radius = self._room
            spheres = np.array([[0, 0, 0, radius]], np.float32)
            what = f"a sphere of {radius:.0f} Å stands for it"
        else:
            what = f"the model's own {len(spheres)} coarse spheres stand for it"
        self._note(f"structure '{wanted}' of ingredient '{ingredient}' is missing: {what}")
        return Structure.of_spheres(ingredient, spheres, stand_in=True)

    def _note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)


def read_structure_spheres(path: Path, copies: bool = False) -> Structure:
    """Read one structure file into spheres; ``.bin`` is the list of spheres of EM densities."""
    if _suffix(path.name) == ".bin":
        return read_sphere_file(path)
    from scuro.load import load

    # all alternate locations: packings are counted, and their clashes judged, by whole files
    return structure_of_molecule(load(path, altloc="all"), copies)


def read_sphere_file(path: Path) -> Structure:
    """Little-endian float32 x, y, z, radius for every sphere; already centred."""
    data = open_source(path).data
    if not data or len(data) % 16:
        raise LoadError(path, "is not a sphere file: its size is not a multiple of 16 bytes")
    spheres = np.frombuffer(data, "<f4").reshape(-1, 4)
    if not np.isfinite(spheres).all() or (spheres[:, 3] <= 0).any():
        raise LoadError(path, "holds spheres without a finite place and a positive radius")
    return Structure.of_spheres(path.stem, spheres, str(path))


def structure_of_molecule(molecule: Molecule, copies: bool = False) -> Structure:
    """Spheres of a molecule's atoms; with ``copies``, of its first assembly.

    Structures that hold Cα atoms alone get spheres of a residue's size.
    """
    trace = len(molecule) > 0 and bool((molecule.atom_name == "CA").all())
    radius = np.full(len(molecule), TRACE_RADIUS) if trace else atom_radii(molecule)
    spheres = np.concatenate([molecule.positions, np.reshape(radius, (-1, 1))], axis=1)
    base = Structure(
        molecule.name,
        spheres.astype(np.float32),
        np.asarray(molecule.element, np.uint8),
        np.asarray(molecule.residue, np.int32),
        np.asarray(molecule.chain, np.int32),
        tuple(map(str, molecule.chain_names)) or ("",),
        molecule.source,
    )
    if not copies or not molecule.assemblies:
        return base
    return _expanded(base, next(iter(molecule.assemblies.values())))


def _expanded(base: Structure, assembly: tuple) -> Structure:
    """All copies of an assembly as atoms of one structure, each with chains of its own."""
    spheres: list[NDArray] = []
    source: list[NDArray] = []
    chains: list[NDArray] = []
    residues: list[NDArray] = []
    names: list[str] = []
    for part in assembly:
        atoms = np.flatnonzero(np.isin(base.chain, part.chains))
        matrices = rotation_matrices(part.rotations)
        for copy, (matrix, offset) in enumerate(zip(matrices, part.positions, strict=True)):
            moved = base.spheres[atoms].copy()
            moved[:, :3] = moved[:, :3].astype(np.float64) @ matrix.T + offset
            spheres.append(moved)
            source.append(atoms)
            chains.append(base.chain[atoms] + len(names))
            residues.append(base.residue[atoms] + len(residues) * (base.residue.max() + 1))
            names += [f"{name}-{copy + 1}" for name in base.chain_names]
    return Structure(
        base.name,
        np.concatenate(spheres),
        base.element[np.concatenate(source)],
        np.concatenate(residues).astype(np.int32),
        np.concatenate(chains).astype(np.int32),
        tuple(names),
        base.source,
    )


def fitting_radius(positions: NDArray, smallest: float = 10.0, largest: float = 60.0) -> float:
    """Half the median distance between an instance and its nearest neighbour, within bounds.

    At most 300 of the positions (k, 3), evenly spread over the list, are compared with all.
    """
    points = np.asarray(positions, np.float64).reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) < 2:
        return 25.0
    some = points[:: -(-len(points) // 300)]
    squares = (some**2).sum(axis=1)[:, None] + (points**2).sum(axis=1) - 2 * some @ points.T
    # the second smallest: the smallest is the point itself
    nearest = np.sqrt(np.maximum(np.partition(squares, 1, axis=1)[:, 1], 0))
    return float(np.clip(np.median(nearest) / 2, smallest, largest))


def unit_quaternions(quaternions: NDArray, notes: list[str], what: str) -> NDArray[np.float32]:
    """Quaternions (k, 4) normalised; those that were not unit, or were nothing, are counted.

    A quaternion without length or with numbers that are not finite becomes no rotation.
    """
    q = np.asarray(quaternions, np.float64).reshape(-1, 4)
    norms = np.linalg.norm(q, axis=1)
    broken = ~np.isfinite(norms) | (norms < 1e-6)
    counts = Counter(broken=int(broken.sum()), bent=int((np.abs(norms[~broken] - 1) > 1e-3).sum()))
    if counts["bent"]:
        notes.append(f"{what}: {counts['bent']:,} quaternions were not of unit length; normalised")
    if counts["broken"]:
        notes.append(
            f"{what}: {counts['broken']:,} quaternions were zero or not finite: not turned"
        )
    q[broken] = 0, 0, 0, 1
    norms[broken] = 1
    return (q / norms[:, None]).astype(np.float32)


def finite_places(positions: NDArray, notes: list[str], what: str) -> NDArray[np.bool_]:
    """(k,) which positions (k, 3) are finite; the others are counted in a note."""
    good = np.isfinite(positions).all(axis=1)
    if not good.all():
        notes.append(f"{what}: {int((~good).sum()):,} instances have no finite position; dropped")
    return good


def _index(folders: list[Path]) -> dict[str, Path]:
    """Structure files by lower-case stem; earlier folders and suffixes win."""
    found: dict[str, tuple[int, int, Path]] = {}
    for order, folder in enumerate(folders):
        for path in sorted(folder.iterdir()) if folder.is_dir() else ():
            suffix = _suffix(path.name)
            if suffix in SUFFIXES:
                entry = order, SUFFIXES.index(suffix), path
                stem = _stem(path.name)
                if stem not in found or entry[:2] < found[stem][:2]:
                    found[stem] = entry
    return {stem: path for stem, (_, _, path) in found.items()}


def _suffix(name: str) -> str:
    return Path(name.lower().removesuffix(".gz")).suffix


def _stem(name: str) -> str:
    """Lower-case name without folder, compression and a structure's suffix (dots stay)."""
    base = re.split(r"[\\/]", name)[-1].lower().removesuffix(".gz")
    return base.removesuffix(_suffix(base)) if _suffix(base) in SUFFIXES else base
