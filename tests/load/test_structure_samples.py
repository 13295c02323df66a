"""Every structure of the sample data against counts that other readers gave for it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scuro.load import load
from scuro.load.trajectory import open_trajectory
from scuro.scene.molecule import HELIX, STRAND

ATOMS = {
    "1crn.pdb": 327,
    "1crn.cif.gz": 327,
    "1crn.mmtf": 327,
    "1aon.pdb.gz": 58_870,
    "4v5a.mmtf": 290_487,
    "hiv-capsid-3j3q-biomt.pdb.gz": 1_800,
    "3j6r.pdb.gz": 17_214,
    "2buk.pdb.gz": 1_588,
    "1xnr.cif.gz": 43_833,
    "1d66.pdb.gz": 1_762,
    "1bna.mmtf": 566,
    "porin.pdb.gz": 2_325,
    "2vts-protein.pdb.gz": 2_277,
    "2vts-docking.sdf": 47,
    "adrenalin.sdf": 26,
    "adrenalin.mol2": 26,
    "benzene.sdf": 12,
    "md/md.gro.gz": 17_411,
    "md/bace1-trimer-in-dppc.gro.gz": 52_661,
}
BONDS = {"4v5a.mmtf": 313_693, "2vts-docking.sdf": 49, "adrenalin.sdf": 26}
OPERATORS = {"hiv-capsid-3j3q-biomt.pdb.gz": 1_356, "3j6r.pdb.gz": 60, "2buk.pdb.gz": 60}


@pytest.mark.parametrize("name", ATOMS)
def test_counts(shared: Path, name: str) -> None:
    molecule = load(shared / "molecules" / name)
    assert len(molecule) == ATOMS[name]
    assert molecule.element.all(), "an element is unknown"
    if name in BONDS:
        assert len(molecule.bonds) == BONDS[name]
    if name in OPERATORS:
        (part,) = molecule.assemblies["1"]
        assert len(part.rotations) == OPERATORS[name]


def test_chains_and_residues(shared: Path) -> None:
    folder = shared / "molecules"
    assert len(load(folder / "1aon.pdb.gz").chain_names) == 21
    assert len(load(folder / "1d66.pdb.gz").chain_names) == 4
    assert len(load(folder / "4v5a.mmtf").chain_names) == 1_598
    assert len(load(folder / "4v5a.mmtf").assemblies) == 2
    assert len(load(folder / "1xnr.cif.gz").residue_name) == 1_494
    assert len(load(folder / "1xnr.cif.gz", hydrogens=False)) == 27_626
    assert len(set(load(folder / "2vts-docking.sdf", model="all").model.tolist())) == 9


def test_capsid_extent(shared: Path) -> None:
    """3J3Q's matrices, read on white space: the extent that the data's README states."""
    molecule = load(shared / "molecules" / "hiv-capsid-3j3q-biomt.pdb.gz")
    (part,) = molecule.assembly("1")
    x, y, z, w = part.rotations.astype(np.float64).T
    assert np.allclose(x * x + y * y + z * z + w * w, 1, atol=1e-6)
    vector = np.stack([x, y, z], 1)[:, None]
    alpha = molecule.atom_name == "CA"
    p = molecule.positions[alpha][None].astype(np.float64)
    cross = np.cross(vector, p)
    placed = p + 2 * (w[:, None, None] * cross + np.cross(vector, cross)) + part.positions[:, None]
    extent = np.ptp(placed.reshape(-1, 3), axis=0)
    assert np.allclose(extent, [765, 1072, 793], atol=1)


def test_one_entry_in_three_formats(shared: Path) -> None:
    pdb, cif, mmtf = (load(shared / "molecules" / f"1crn.{s}") for s in ("pdb", "cif.gz", "mmtf"))
    for other in (cif, mmtf):
        assert np.array_equal(pdb.positions, other.positions)
        assert np.array_equal(pdb.atom_name, other.atom_name)
        assert np.array_equal(pdb.element, other.element)
        assert np.array_equal(pdb.residue_number, other.residue_number)
        assert np.array_equal(pdb.bonds, other.bonds)
    assert np.array_equal(pdb.secondary, cif.secondary)
    assert (pdb.secondary == HELIX).sum() > 10 < (pdb.secondary == STRAND).sum() + 10


def test_order_and_numbers_as_gemmi_reads_them(shared: Path) -> None:
    import gemmi

    for name in ("1aon.pdb.gz", "1d66.pdb.gz", "2buk.pdb.gz"):
        path = shared / "molecules" / name
        flat = gemmi.FlatStructure(gemmi.read_pdb(str(path)))
        ours = load(path, altloc="all")
        assert np.allclose(flat.pos, ours.positions, atol=1e-4)
        assert np.array_equal(flat.serials, ours.serial)
        assert np.array_equal(flat.elements, ours.element)
        assert np.allclose(flat.b_iso, ours.b_factor)


def test_trajectory_frames(shared: Path) -> None:
    folder = shared / "molecules" / "md"
    water = open_trajectory(folder / "md.gro.gz", folder / "md.xtc", waters=False)
    assert len(water) == 51
    assert len(water.molecule) == 215
    assert not np.array_equal(water.positions(0), water.positions(50))
    adk = open_trajectory(folder / "adk.psf.gz", folder / "adk_dims.dcd")
    assert (len(adk), len(adk.molecule), len(adk.molecule.bonds)) == (98, 3_341, 3_365)
    assert adk.at(97).bonds is adk.molecule.bonds
    assert np.array_equal(
        load(folder / "adk.psf.gz", trajectory=str(folder / "adk_dims.dcd"), frame=-1).positions,
        adk.positions(97),
    )


def test_assigned_secondary_structure_resembles_the_files(shared: Path) -> None:
    """P-SEA sees alpha carbons only; it should agree with the depositors on most residues."""
    from scuro.load import secondary

    molecule = load(shared / "molecules" / "1aon.pdb.gz")
    protein = np.unique(molecule.residue[molecule.kind == 0])
    agree = (secondary.assign(molecule) == molecule.secondary)[protein].mean()
    assert agree > 0.7
