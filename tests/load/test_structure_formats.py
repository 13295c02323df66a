"""Formats and options on small files made here."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from structure_files import GRO, MMCIF, MOL, MOL2, MOL_V3000, PQR, XYZ, pdb_atom

from scuro.errors import LoadError
from scuro.load import load
from scuro.scene.describe import describe
from scuro.scene.molecule import HELIX, ION, LIGAND, POLYMER_PROTEIN, SOLVENT, STRAND


@pytest.fixture
def write(tmp_path: Path):
    def write(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


def test_mol(write) -> None:
    molecule = load(write("a.mol", MOL))
    assert molecule.name == "ethanol"
    assert molecule.element.tolist() == [6, 6, 8]
    assert molecule.formal_charge.tolist() == [0, 0, -1]
    assert molecule.bonds.tolist() == [[0, 1], [1, 2]]
    assert molecule.bond_order.tolist() == [1, 2]


def test_mol_v3000_with_a_continued_line(write) -> None:
    molecule = load(write("a.mol", MOL_V3000))
    assert molecule.element.tolist() == [6, 8]
    assert molecule.formal_charge.tolist() == [0, -1]
    assert (molecule.bonds.tolist(), molecule.bond_order.tolist()) == ([[0, 1]], [2])


def test_sdf_records(write) -> None:
    path = write("a.sdf", f"{MOL}$$$$\n{MOL.replace('2.2000', '9.0000')}$$$$\n")
    assert len(load(path)) == 3
    assert load(path, model=2).positions[2, 0] == 9
    both = load(path, model="all")
    assert both.model.tolist() == [1, 1, 1, 2, 2, 2]
    assert both.bonds.tolist() == [[0, 1], [1, 2], [3, 4], [4, 5]]
    with pytest.raises(LoadError, match="no model 3; it has 2: 1 to 2"):
        load(path, model=3)


def test_mol2(write) -> None:
    molecule = load(write("a.mol2", MOL2))
    assert molecule.element.tolist() == [6, 6]
    assert molecule.bond_order.tolist() == [4]
    assert molecule.residue_number.tolist() == [7]


def test_xyz_with_an_atomic_number_and_frames(write) -> None:
    molecule = load(write("a.xyz", XYZ * 2), model="all")
    assert molecule.element.tolist() == [8, 1, 1] * 2
    assert molecule.bonds.tolist() == [[0, 1], [0, 2], [3, 4], [3, 5]]


def test_gro_is_in_nanometres(write) -> None:
    molecule = load(write("a.gro", GRO))
    assert np.allclose(molecule.positions[1], [0.96, 0, 0])
    assert (molecule.kind == SOLVENT).all()
    assert molecule.bonds.tolist() == [[0, 1], [0, 2]]


def test_pqr_radii(write) -> None:
    molecule = load(write("a.pqr", PQR))
    assert np.allclose(molecule.radius, [1.824, 1.908])
    assert molecule.residue_number.tolist() == [10]


def test_mmcif(write) -> None:
    molecule = load(write("a.cif", MMCIF))
    assert molecule.positions[0].tolist() == [1.5, 2, -3]
    assert molecule.atom_name.tolist() == ["CA", "O5'", "MG"]
    assert molecule.residue_number.tolist() == [10, 1]
    assert molecule.insertion_code.tolist() == ["", "A"]
    assert molecule.chain_names == ("X", "X")
    assert molecule.kind.tolist() == [POLYMER_PROTEIN, POLYMER_PROTEIN, ION]


def test_mmcif_that_only_gemmi_can_split(write) -> None:
    """A quoted value with a blank inside takes the slow way to the same molecule."""
    odd = load(write("a.cif", MMCIF.replace('"O5\'"', '"O 5"')))
    assert odd.atom_name.tolist() == ["CA", "O 5", "MG"]
    assert np.array_equal(odd.positions, load(write("b.cif", MMCIF)).positions)


def test_assembly_operators_are_products(write) -> None:
    """(1,2)(3): operator 3 is applied first, as the dictionary says."""
    molecule = load(write("a.cif", MMCIF))
    (part,) = molecule.assembly("1")
    assert part.chains == (0,)
    # operator 2 after 3: x -> R2 (R3 x + (0,0,7)) + (5,1,0)
    assert np.allclose(part.positions, [[0, 0, 7], [5, 1, 7]])
    half = np.sqrt(0.5)
    assert np.allclose(np.abs(part.rotations), [[1, 0, 0, 0], [half, half, 0, 0]], atol=1e-6)
    assert molecule.assembly("2")[0].chains == (0, 1)
    with pytest.raises(LoadError, match="no assembly '7'; it has 1, 2"):
        molecule.assembly("7")


def test_alternate_locations(write) -> None:
    atoms = [
        pdb_atom(1, " CA ", altloc="A", occupancy=0.3),
        pdb_atom(2, " CA ", altloc="B", occupancy=0.7, xyz=(5.0, 5.0, 5.0)),
        pdb_atom(3, " N  ", element="N"),
        # another residue at the same place: only one of the two is kept
        pdb_atom(4, " CA ", "SER", number=2, altloc="A", occupancy=0.6),
        pdb_atom(5, " CA ", "THR", number=2, altloc="B", occupancy=0.4),
    ]
    path = write("a.pdb", "".join(atoms))
    highest = load(path)
    assert highest.serial.tolist() == [2, 3, 4]
    assert highest.notes == ("2 atoms at other alternate locations were left out",)
    assert load(path, altloc="A").serial.tolist() == [1, 3, 4]
    assert load(path, altloc="all").serial.tolist() == [1, 2, 3, 4, 5]


def test_what_to_keep(write) -> None:
    atoms = [
        pdb_atom(1, " CA "),
        pdb_atom(2, " HA ", element="H"),
        "TER\n",
        pdb_atom(3, " O  ", "HOH", number=2, element="O", record="HETATM"),
        pdb_atom(4, " C1 ", "XYZ", number=3, record="HETATM"),
        pdb_atom(5, "ZN  ", " ZN", number=4, element="ZN", record="HETATM"),
    ]
    path = write("a.pdb", "".join(atoms))
    assert load(path).kind.tolist() == [POLYMER_PROTEIN, POLYMER_PROTEIN, SOLVENT, LIGAND, ION]
    assert load(path, hydrogens=False).serial.tolist() == [1, 3, 4, 5]
    assert load(path, waters=False).serial.tolist() == [1, 2, 4, 5]
    assert load(path, ligands=False).serial.tolist() == [1, 2, 3]
    assert describe(load(path))["ligands"] == {"XYZ": 1}


def test_models(write) -> None:
    model = "MODEL     {:4d}\n" + pdb_atom() + pdb_atom(2, number=2) + "ENDMDL\n"
    path = write("a.pdb", model.format(3) + model.format(5))
    assert load(path).model.tolist() == [3, 3]
    assert load(path, model=5).model.tolist() == [5, 5]
    assert len(load(path, model="all").residue_name) == 4
    with pytest.raises(LoadError, match="no model 4"):
        load(path, model=4)


def test_conect_repeated_means_double(write) -> None:
    atoms = "".join(
        pdb_atom(i, f" X{i} ", "XYZ", number=1, xyz=(20.0 * i, 0.0, 0.0), record="HETATM")
        for i in (1, 2, 3)
    )
    conect = "CONECT    1    2    2\nCONECT    2    1    1    3\nCONECT    3    2\n"
    molecule = load(write("a.pdb", atoms + conect))
    assert molecule.bonds.tolist() == [[0, 1], [1, 2]]
    assert molecule.bond_order.tolist() == [2, 0]


@pytest.mark.parametrize(
    ("serials", "expected"),
    [
        (("99999", "A0000", "A0001"), [99_999, 100_000, 100_001]),
        (("99998", "99999", "*****"), [99_998, 99_999, 3]),
    ],
)
def test_more_atoms_than_the_columns_hold(write, serials, expected) -> None:
    text = "".join(pdb_atom(s, number=i) for i, s in enumerate(serials))
    assert load(write("a.pdb", text)).serial.tolist() == expected


def test_serials_that_take_a_sixth_column(write) -> None:
    left = pdb_atom(0).replace("ATOM      0", "ATOM 100000")
    right = pdb_atom(0, record="HETATM", number=2).replace("HETATM    0 ", "HETATM100001")
    assert load(write("a.pdb", left + right)).serial.tolist() == [100_000, 100_001]


@pytest.mark.parametrize(
    ("name", "residue", "expected"),
    [
        (" CA ", "ALA", 6),
        ("CA  ", " CA", 20),
        ("HG11", "VAL", 1),
        ("1HB ", "ALA", 1),
        ("HG  ", " HG", 80),
        ("FE  ", "HEM", 26),
        (" C1'", " DA", 6),
        ("SE  ", "MSE", 34),
        ("CL  ", " CL", 17),
        ("BR1 ", "LIG", 35),
        (" N1 ", "LIG", 7),
    ],
)
def test_missing_elements_are_inferred(write, name, residue, expected) -> None:
    text = pdb_atom(1, name, residue, element="  ")
    assert load(write("a.pdb", text)).element.tolist() == [expected]


def test_wrong_ending_is_read_by_its_content(write) -> None:
    assert len(load(write("a.pdb", MMCIF))) == 3
    assert len(load(write("a.cif", pdb_atom()))) == 1
    assert len(load(write("a.txt", XYZ))) == 3
    assert len(load(write("b.pdb", gzip.compress(pdb_atom().encode())))) == 1


def test_line_ends_of_other_systems(write) -> None:
    for end in ("\r\n", "\r"):
        assert len(load(write("a.pdb", (pdb_atom() * 3).replace("\n", end)))) == 3
        assert len(load(write("a.cif", MMCIF.replace("\n", end)))) == 3
        assert len(load(write("a.xyz", XYZ.replace("\n", end)))) == 3
        assert len(load(write("a.sdf", MOL.replace("\n", end)))) == 3


def test_secondary_structure_ranges_end_where_the_file_says(write) -> None:
    helix = "HELIX    1   1 ALA A    2  ALA A    3A 1                                   2\n"
    sheet = "SHEET    1   A 1 ALA A   4  ALA A   5  0\n"
    numbers = [(1, " "), (2, " "), (3, " "), (3, "A"), (3, "B"), (4, " "), (5, " "), (6, " ")]
    atoms = "".join(
        pdb_atom(i, number=number, insertion=code) for i, (number, code) in enumerate(numbers)
    )
    molecule = load(write("a.pdb", helix + sheet + atoms))
    assert molecule.secondary_from == "file"
    assert molecule.secondary.tolist() == [0, HELIX, HELIX, HELIX, 0, STRAND, STRAND, 0]
