"""Broken files: one clear sentence, never another exception."""

from __future__ import annotations

import gzip
import os
import random
from pathlib import Path

import pytest
from structure_files import GRO, MMCIF, MOL, MOL2, PQR, XYZ, pdb_atom

from scuro.errors import LoadError, SettingsError
from scuro.load import load
from scuro.load.source import open_source
from scuro.scene.molecule import Molecule

SMALL = {
    "a.pdb": pdb_atom() + pdb_atom(2, number=2) + "CONECT    1    2\n",
    "a.cif": MMCIF,
    "a.sdf": MOL,
    "a.mol2": MOL2,
    "a.xyz": XYZ,
    "a.gro": GRO,
    "a.pqr": PQR,
}


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.pdb", b"", "is empty"),
        ("a.pdb", b" \n\n", "is empty"),
        ("a.pdb.gz", gzip.compress(b"ATOM" * 1000)[:-20], "cut off"),
        ("a.pdb.gz", gzip.compress(b"x")[:8] + b"\xff" * 30, "gzip is damaged"),
        ("a.pdb", b"hello\n", "no atoms"),
        ("a.cif", b"hello\n", "not an mmCIF file"),
        ("a.cif", b"data_x\n_cell.length_a 5\n", "no atoms"),
        ("a.bcif", b"hello\n", "not a BinaryCIF file"),
        ("a.mmtf", b"\x81\xa1a\x01", "not an MMTF file"),
        ("a.sdf", b"a\nb\nc\nnonsense\n", "not an SD file"),
        ("a.mol2", b"hello\n", "no atoms"),
        ("a.xyz", b"hello\n", "number of atoms"),
        ("a.xyz", b"5\n\nC 0 0 0\n", "ends before"),
        ("a.xyz", b"0\n\n", "no atoms"),
        ("a.gro", b"title\n7\n    1SOL     OW    1   0.000   0.000   0.000\n", "ends before"),
        ("a.psf", b"PSF\n\n", "no section NATOM"),
        ("a.txt", b"Dear reader,\n", "known endings"),
        ("a.pdb", pdb_atom(xyz=("nan", 1.0, 2.0)).encode(), "line 1: the atom's coordinate"),
        ("a.pdb", (pdb_atom() + pdb_atom(xyz=(1.0, "1.0x", 2.0))).encode(), "line 2"),
        ("a.cif", MMCIF.replace("2.5  2", "nan  2").encode(), "1 atoms have coordinates"),
        ("a.xyz", XYZ.replace("0.96", "inf").encode(), "atom 2 cannot be read"),
    ],
)
def test_one_sentence(tmp_path: Path, name: str, content: bytes, said: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(LoadError) as caught:
        load(path)
    text = str(caught.value)
    assert said in text
    assert text.startswith(str(path))
    assert "\n" not in text


def test_folders_missing_and_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(LoadError, match="is a folder"):
        load(tmp_path)
    with pytest.raises(LoadError, match="no such file, and it is not a PDB ID"):
        load("9zzz9")
    with pytest.raises(LoadError, match=r"there is no such file$"):
        load(tmp_path / "missing.pdb")
    with pytest.raises(LoadError, match="no such sample; there are 1hpv, 1tii"):
        load("sample:9xyz")
    with pytest.raises(LoadError, match="no such file"):
        load("a\0b")
    with pytest.raises(LoadError, match="cannot be read"):
        load("a" * 5000)
    secret = tmp_path / "secret.pdb"
    secret.write_text(pdb_atom())
    secret.chmod(0)
    if not os.access(secret, os.R_OK):  # root may read everything
        with pytest.raises(LoadError, match="cannot be read"):
            load(secret)


def test_wrong_options() -> None:
    for options in ({"model": "x"}, {"altloc": "AB"}, {"nonsense": 1}, {"format": "docx"}):
        with pytest.raises(SettingsError):
            load("sample:1hpv", **options)


def test_nothing_left(tmp_path: Path) -> None:
    path = tmp_path / "water.xyz"
    path.write_text(XYZ.replace("O ", "H "))
    with pytest.raises(LoadError, match="the options drop all of its atoms"):
        load(path, hydrogens=False)


def _damaged(content: bytes, rng: random.Random) -> bytes:
    """Cut off, bytes flipped, a piece lost, or nonsense put in."""
    data = bytearray(content)
    at = rng.randrange(len(data))
    match rng.randrange(4):
        case 0:
            del data[at:]
        case 1:
            for _ in range(rng.choice([1, 3, 30])):
                data[rng.randrange(len(data))] = rng.randrange(256)
        case 2:
            del data[at : at + rng.randrange(1, 100)]
        case _:
            data[at:at] = bytes(rng.randrange(32, 127) for _ in range(rng.randrange(1, 40)))
    return bytes(data)


def _load_all(path: Path) -> None:
    try:
        molecule = load(path)
    except LoadError as error:
        assert "\n" not in str(error)
        return
    assert isinstance(molecule, Molecule)
    assert len(molecule.bonds) == len(molecule.bond_order)
    assert len(molecule.bonds) == 0 or molecule.bonds.max() < len(molecule)
    assert len(molecule.secondary) == len(molecule.residue_name)


@pytest.mark.parametrize("name", SMALL)
def test_damaged_small_files(tmp_path: Path, name: str) -> None:
    rng = random.Random(name)
    path = tmp_path / name
    for _ in range(60):
        path.write_bytes(_damaged(SMALL[name].encode(), rng))
        _load_all(path)


@pytest.mark.parametrize(
    "name", ["1crn.pdb", "1crn.cif.gz", "1crn.mmtf", "adrenalin.sdf", "md/adk.psf.gz"]
)
def test_damaged_real_files(shared: Path, tmp_path: Path, name: str) -> None:
    rng = random.Random(name)
    content = open_source(shared / "molecules" / name).data
    path = tmp_path / Path(name).name.removesuffix(".gz")
    for _ in range(25):
        path.write_bytes(_damaged(content, rng))
        _load_all(path)


def test_damaged_binary_cif(shared: Path, tmp_path: Path) -> None:
    rng = random.Random(1)
    content = (shared / "mesoscale" / "bcif" / "HIV_atom_instances.bcif").read_bytes()
    path = tmp_path / "a.bcif"
    for _ in range(4):
        path.write_bytes(_damaged(content, rng))
        try:
            load(path)
        except LoadError as error:
            assert "\n" not in str(error)
