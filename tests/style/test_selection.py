"""Selections: PyMOL's words, its precedence, and errors that point at the column."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scuro import Scene
from scuro.errors import SettingsError
from scuro.scene.molecule import ION, LIGAND, SOLVENT, AssemblyPart
from scuro.style.selection import select

# The atoms of the fixture, by index: MET 0-4, ALA 5-9, GLY 10-14, DA 15-18, HEM 19-21, SO4 22-23,
# ZN 24, HOH 25; x = 2 Å times the index.
CASES = {
    "all": range(26),
    "*": range(26),
    "auto": range(25),
    "auto and not protein": range(15, 25),
    "none": [],
    "chain A": range(15),
    "chain a": [],
    "c. A+b": range(26),
    "segi b": range(15, 26),
    "resi 10": range(5, 10),
    "resi 10A": range(10, 15),
    "resi -5-4": range(5),
    "i. -1": range(5),
    r"resi \-1": range(5),
    "resi 5,301-303": range(15, 25),
    "resn ala+met": range(10),
    "r. *A": [*range(5, 10), *range(15, 19)],
    "name CA": [1, 6, 11],
    "name ca+CB": [1, 6, 9, 11],
    "name C*": [1, 2, 6, 7, 9, 11, 12, 17, 20],
    "name O5' or name C1'": [16, 17],
    "name 'CA'+\"CB\"": [1, 6, 9, 11],
    "elem fe+Zn": [19, 24],
    "e. d": [14],
    "index 1-3": [0, 1, 2],
    "id 101+126": [0, 25],
    "model 1": range(26),
    "model 2": [],
    "alt B": [4],
    "alt ''": [i for i in range(26) if i != 4],
    "polymer": range(19),
    "protein": range(15),
    "polymer.protein": range(15),
    "nucleic": range(15, 19),
    "organic": [19, 20, 21],
    "inorganic": [22, 23, 24],
    "solvent": [25],
    "water": [25],
    "metals": [19, 24],
    "hetatm": range(19, 26),
    "h.": [14],
    "hydrogens": [14],
    "backbone": [0, 1, 2, 3, 5, 6, 7, 8, 10, 11, 12, 13, 14, 15, 16, 17],
    "sidechain": [4, 9, 18],
    "ss h": range(5, 10),
    "ss s+l": [*range(5), *range(10, 15)],
    "b > 95": [24, 25],
    "b<=4": [0, 1],
    "q < 1": [4],
    "x >= 48": [24, 25],
    "byres name SD": range(5),
    "bychain name FE": range(15, 26),
    "bm. name FE": [19, 20, 21],
    "neighbor name FE": [20],
    "first name CA": [1],
    "last chain A": [14],
    "name FE extend 1": [19, 20],
    "/mix//b/301/FE": [19],
    "/other//b": [],
    "///A/10A/CA": [11],
    "////MET": range(5),
    "////ALA`10": range(5, 10),
    "within 2 of name FE": [18, 19, 20],
    "polymer within 2 of name FE": [18],
    "name FE around 2": [18, 20],
    "name FE expand 2": [18, 19, 20],
    "polymer beyond 30 of name FE": range(4),
    "not polymer and not solvent": range(19, 25),
    "chain A & (name CA | name CB)": [1, 6, 9, 11],
    "!chain A & elem O": [16, 23, 25],
    # and before or; distances after both, byres last: as PyMOL does it.
    "name FE or chain A and name CA": [1, 6, 11, 19],
    "name CHA or name FE around 2": [18, 21],
    "byres name FE around 2": [*range(15, 22)],
    "name FE around 2 and nucleic": [18],
    "polymer and byres name FE around 2": range(15, 19),
    "not name FE and byres name FE": [20, 21],
    "name FE around 2 or name CA and chain A": [1, 6, 11, 18, 20],
    "CHAIN A AND NAME CA": [1, 6, 11],
}


@pytest.mark.parametrize("text", CASES)
def test_takes_the_atoms(mixture, text):
    assert np.flatnonzero(select(mixture, text)).tolist() == list(CASES[text])


WRONG = {
    "": (1, "chain A"),
    "chain": (6, "a name"),
    "chain and resi 5": (7, "a name"),
    "chain A or B": (12, "'polymer'"),
    "chian A": (1, "did you mean 'chain'"),
    "chain A and": (12, "it ends"),
    "(chain A": (9, "')'"),
    "chain A)": (8, "the end"),
    "polymer chain A": (9, "'and'"),
    "b 50": (3, "a comparison"),
    "b > x": (5, "a number"),
    "elem C+Xq": (6, "chemical symbol"),
    "resi 5-b": (6, "a residue number"),
    "within 5 chain A": (10, "'of'"),
    "chain A around": (15, "a number"),
    "ss q": (4, "h (helix)"),
    "/a/b/c/d/e/f": (1, "at most"),
}


@pytest.mark.parametrize("text", WRONG)
def test_errors_point_at_the_column(mixture, text):
    column, expected = WRONG[text]
    with pytest.raises(SettingsError) as error:
        select(mixture, text)
    message = str(error.value)
    assert re.search(rf"column {column}\b", message), message
    assert expected in message
    assert "\n" not in message


def test_chains_of_one_name_belong_together(mixture):
    twin = replace(mixture, chain_names=("A", "A"))
    assert select(twin, "bychain name FE").all()


def test_deep_nesting_is_refused_not_crashed(mixture):
    with pytest.raises(SettingsError, match="nested too deeply"):
        select(mixture, "not " * 5000 + "all")


atoms = st.sampled_from(["name CA", "chain A", "polymer", "b > 40", "resi 5-301", "elem O", "none"])


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(a=atoms, b=atoms, c=atoms)
def test_boolean_laws(mixture, a, b, c):
    def take(text):
        return select(mixture, text)

    assert (take(f"not ({a} and {b})") == take(f"not ({a}) or not ({b})")).all()
    assert (take(f"{a} or {b} and {c}") == (take(a) | (take(b) & take(c)))).all()
    assert (take(f"({a} or {b}) and {c}") == ((take(a) | take(b)) & take(c))).all()
    wider = take(f"({a}) expand 3")
    assert (wider | take(a) == wider).all()
    assert (take(f"({a}) around 3") == (wider & ~take(a))).all()


@settings(
    max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(text=st.text(alphabet="chain A resi10-+*()\"'&|!<>/.of within", max_size=30))
def test_any_text_selects_or_complains(mixture, text):
    try:
        assert select(mixture, text).shape == (len(mixture),)
    except SettingsError as error:
        assert "\n" not in str(error).replace(text, "")


def test_auto_leaves_out_the_bath_of_a_simulation_and_its_salt(mixture):
    count = len(mixture)
    kind = np.full(count, SOLVENT, mixture.kind.dtype)
    kind[:5], kind[24:26] = LIGAND, ION
    element = mixture.element.copy()
    element[24:26] = 30, 17
    bathed = replace(mixture, kind=kind, element=element)
    assert np.flatnonzero(select(bathed, "auto")).tolist() == [0, 1, 2, 3, 4, 24]
    assert Scene().add(bathed).molecules[0].left_out == 20
    assert Scene().add(bathed).show(select="all").molecules[0].left_out == 0
    only = replace(mixture, kind=np.full(count, SOLVENT, mixture.kind.dtype))
    assert select(only, "auto").all()  # a box of water is about water


def test_auto_keeps_water_where_there_is_no_polymer(mixture):
    kind = np.full(len(mixture), LIGAND, mixture.kind.dtype)
    kind[25] = SOLVENT
    assert select(replace(mixture, kind=kind), "auto").all()


def test_copies_of_an_assembly_that_are_not_shown_are_told(mixture):
    turns = np.tile(np.float32([0, 0, 0, 1]), (60, 1))
    whole = AssemblyPart((0,), turns, np.zeros((60, 3)))
    once = replace(whole, rotations=whole.rotations[:1], positions=whole.positions[:1])
    virus = replace(mixture, assemblies={"1": (once,), "2": (whole, once)})
    item = Scene().add(virus).molecules[0]
    assert item.unassembled == ("2", 60)
    item.assembly = "1"
    assert item.unassembled == ("", 1)
    flat = replace(mixture, assemblies={"1": (once,)})
    assert Scene().add(flat).molecules[0].unassembled == ("", 1)
    assert Scene().add(mixture).molecules[0].unassembled == ("", 1)
