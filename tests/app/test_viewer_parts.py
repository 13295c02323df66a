"""Small parts of the viewer against closed forms."""

import numpy as np
import pytest

from scuro.load import load
from scuro.style.gauges import nice_length
from scuro.style.labels import placed
from scuro.viewer.measure import angle, dihedral, distance, measures
from scuro.viewer.panel.sequence import sequence


def test_measures_have_their_closed_forms():
    assert distance((0, 0, 0), (1, 2, 2)) == 3
    assert angle((1, 0, 0), (0, 0, 0), (0, 5, 0)) == pytest.approx(90)
    assert angle((1, 0, 0), (0, 0, 0), (-2, 0, 0)) == pytest.approx(180)
    # seen along the axis, the far end is turned clockwise by 60 degrees
    turned = (np.cos(np.radians(60)), -np.sin(np.radians(60)), 1)
    far = (turned[0], turned[1], -1.0)
    assert dihedral((1, 0, 0), (0, 0, 0), (0, 0, -1), far) == pytest.approx(60)
    assert dihedral((1, 0, 0), (0, 0, 0), (0, 0, -1), (1, 0, -1)) == pytest.approx(0)
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1)]
    texts = [m.text for n in (1, 2, 3, 4) for m in measures(points[:n])]
    assert texts == ["1.00 Å", "90.0°", "90.0°"]


def test_scale_bars_are_round_and_fit():
    assert nice_length(7.3, "Å") == (5.0, "5 Å")
    assert nice_length(36.0, "Å") == (20.0, "2 nm")
    assert nice_length(0.13, "Å") == (0.1, "0.1 Å")
    assert nice_length(4.2e4, "Å") == (2e4, "2 µm")
    assert nice_length(1500, "mm") == (1000, "1 m")
    assert nice_length(99, "") == (50, "50")


def test_labels_do_not_overlap_and_the_nearest_win():
    places = np.array([[50, 50, 9.0], [52, 51, 3.0], [51, 52, 5.0], [50, 50, -1.0], [990, 5, 1]])
    found = placed(places, [(40, 12)] * 5, (200, 100))
    assert found[0][0] == 1 and 3 not in [i for i, _ in found]
    assert 4 not in [i for i, _ in found], "a label outside the picture"
    boxes = [(x, y, x + 40, y + 12) for _, (x, y) in found]
    for i, a in enumerate(boxes):
        for b in boxes[i + 1 :]:
            assert a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3]


def test_the_sequence_is_the_protease_and_each_letter_has_its_alpha_carbon():
    molecule = load("sample:1hpv")
    letters = sequence(molecule, 0)
    assert "".join(letter for letter, _, _ in letters).startswith("PQITLWQRPLVTIKIGGQ")
    assert len(letters) == 99 and [n for _, n, _ in letters[:3]] == [1, 2, 3]
    for _, number, atom in letters:
        assert str(molecule.atom_name[atom]).strip() == "CA"
        assert molecule.residue_number[molecule.residue[atom]] == number


def test_listed_files_have_the_names_below_their_folder():
    from scuro.viewer.panel.files import short_names

    assert short_names([]) == {}
    assert short_names(["/a/b/1.pdb"]) == {"1.pdb": "/a/b/1.pdb"}
    names = short_names(["/a/b/1.pdb", "/a/b/c/2.mrc"])
    assert names == {"1.pdb": "/a/b/1.pdb", "c/2.mrc": "/a/b/c/2.mrc"}
