"""Regions of a molecule by a tree of selections."""

from itertools import pairwise

import numpy as np
import pytest

from scuro.errors import SettingsError
from scuro.load import load
from scuro.scene.scene import Scene
from scuro.scene.selection_tree import divisions, parse_tree

PROTEASE = "protease=chain A+B; protease/A=chain A; protease/A/flap=resi 43-58; drug=resn VX4"


def test_a_tree_becomes_ever_finer_levels():
    molecule = load("sample:1hpv")
    found = divisions(molecule, parse_tree(PROTEASE))
    assert [d.name for d in found] == ["part 1", "part 2", "part 3", "chain", "residue"]
    assert set(found[0].names) == {"rest", "protease", "drug"}
    for coarse, fine in pairwise(found):
        pairs = np.unique(np.stack([fine.group, coarse.group], 1), axis=0)
        assert len(pairs) == len(np.unique(fine.group)), "each part lies in one coarser part"
    flap = found[2].group == found[2].names.index("flap")
    residues = molecule.residue_number[molecule.residue[flap]]
    assert flap.any() and residues.min() == 43 and residues.max() == 58
    chains = {molecule.chain_names[c] for c in np.unique(molecule.chain[flap])}
    assert chains == {"A"}, "an inner part lies in its outer one"


def test_the_scenes_levels_begin_with_the_parts():
    scene = Scene().add(load("sample:1hpv"))
    hierarchy = scene.hierarchy(PROTEASE)
    assert [level.name for level in hierarchy.levels][:2] == ["part 1", "part 2"]
    assert scene.hierarchy(PROTEASE) is hierarchy
    assert [level.name for level in scene.hierarchy().levels] == ["chain", "residue"]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("flap", "is no part: write NAME=SELECTION"),
        ("a=chain A; a=chain B", "given twice"),
        ("a/b=chain A", "part of 'a', which is not given"),
        ("a=chian A", "chian"),
    ],
)
def test_what_is_wrong_with_a_tree_is_said(text, says):
    with pytest.raises(SettingsError, match=says):
        divisions(load("sample:1hpv"), parse_tree(text))
