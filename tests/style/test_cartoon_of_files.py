"""Cartoons of real structures: closed everywhere, every residue in its place."""

from __future__ import annotations

from importlib.resources import as_file, files

import numpy as np
import pytest
from meshes import assert_closed_and_outward

from scuro.load import load
from scuro.scene.molecule import POLYMER_NUCLEIC, STRAND
from scuro.style.chains import nucleic_trace, protein_trace
from scuro.style.color import atom_colors
from scuro.style.options import Representation
from scuro.style.representation import build_geometry


def cartoon(molecule, scheme="chain"):
    everything = np.ones(len(molecule), bool)
    colors = atom_colors(molecule, scheme)
    return build_geometry(molecule, "cartoon", everything, colors, Representation())


def test_protein_is_closed_and_near_its_atoms():
    with as_file(files("scuro") / "data" / "1tii.pdb.gz") as path:
        molecule = load(path)
    geometry = cartoon(molecule)
    assert_closed_and_outward(geometry)
    trace = protein_trace(molecule, np.arange(len(molecule)))
    assert set(geometry.triangle_ids.ravel()) == set(trace.atoms)
    away = geometry.triangles - molecule.positions[geometry.triangle_ids]
    assert np.linalg.norm(away, axis=-1).max() < 5.0
    assert (molecule.secondary == STRAND).any()
    colors = atom_colors(molecule, "chain")
    assert (geometry.triangle_colors == colors[geometry.triangle_ids]).all()


@pytest.mark.parametrize("name", ["1d66.pdb.gz", "1bna.mmtf"])
def test_nucleic_acid_has_a_tube_and_a_slab_for_every_base(shared, name):
    molecule = load(shared / "molecules" / name)
    geometry = cartoon(molecule, "residue")
    assert_closed_and_outward(geometry)
    atoms = np.arange(len(molecule))
    trace = nucleic_trace(molecule, atoms)
    nucleotides = np.unique(molecule.residue[molecule.kind == POLYMER_NUCLEIC])
    assert set(trace.residues) == set(nucleotides)
    assert len(geometry.rods) == len(nucleotides)
    sugars = geometry.rod_ids[:, 1]
    assert set(molecule.atom_name[sugars]) == {"C1'"}
    slabs = np.isin(geometry.triangle_ids, sugars).all(axis=1)
    assert np.count_nonzero(slabs) == 12 * len(nucleotides)
    # a base's own atoms lie within half an ångström of the middle plane of its slab
    sugar = sugars[0]
    corners = geometry.triangles[(geometry.triangle_ids == sugar).all(axis=1)].reshape(-1, 3)
    middle = corners.mean(axis=0)
    normal = np.linalg.svd(np.unique(corners, axis=0) - middle)[2][2]
    ring = (molecule.residue == molecule.residue[sugar]) & np.isin(
        molecule.atom_name, ("N1", "C2", "N3", "C4", "C5", "C6")
    )
    assert np.abs((molecule.positions[ring] - middle) @ normal).max() < 0.2
