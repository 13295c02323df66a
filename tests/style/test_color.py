"""Colour schemes and radii."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scuro.errors import SettingsError
from scuro.scene.molecule import LIGAND
from scuro.style import palettes
from scuro.style.color import (
    ALIASES,
    CATEGORIES,
    VALUES,
    atom_colors,
    parse_color,
    parse_scheme,
    scheme_names,
)
from scuro.style.color_by import polymer_atoms
from scuro.style.elements import NUMBER_OF, SYMBOLS
from scuro.style.radii import VAN_DER_WAALS, atom_radii

FE, CARBON = 19, 20


def test_symbols_are_in_order_of_atomic_number():
    known = dict(H=1, C=6, Fe=26, Br=35, I=53, W=74, Au=79, U=92, Lr=103, Og=118)
    assert {symbol: SYMBOLS.index(symbol) for symbol in known} == known


@pytest.mark.parametrize("scheme", [*scheme_names(), *ALIASES, "tomato", "#abc", "chain+element"])
def test_every_scheme_colours_every_atom(mixture, scheme):
    colors = atom_colors(mixture, scheme)
    assert colors.shape == (len(mixture), 4)
    assert colors.dtype == np.uint8
    assert (colors[:, 3] == 255).all()


@pytest.mark.parametrize("scheme", scheme_names())
def test_no_atoms_no_colours(mixture, scheme):
    assert atom_colors(nothing(mixture), scheme).shape == (0, 4)


def nothing(molecule):
    """The molecule without its atoms."""
    per_atom = {
        name: value[:0]
        for name, value in vars(molecule).items()
        if isinstance(value, np.ndarray) and len(value) == len(molecule)
    }
    return replace(
        molecule, **per_atom, bonds=molecule.bonds[:0], bond_order=molecule.bond_order[:0]
    )


@pytest.mark.parametrize(
    ("scheme", "color"),
    [("element", (224, 102, 51)), ("cpk", (255, 165, 0)), ("Tomato", (255, 99, 71))],
)
def test_iron(mixture, scheme, color):
    assert tuple(atom_colors(mixture, scheme)[FE, :3]) == color


def test_added_elements_leave_carbon_to_the_scheme(mixture):
    plain, mixed = atom_colors(mixture, "chain"), atom_colors(mixture, "chain+element")
    carbon = mixture.element == 6
    assert (plain[carbon] == mixed[carbon]).all()
    assert (mixed[~carbon] == atom_colors(mixture, "element")[~carbon]).all()
    assert (atom_colors(mixture, "byhet") == mixed).all()


def test_colour_map_runs_from_end_to_end(mixture):
    colors = atom_colors(mixture, "bfactor:bids:viridis:0:100")
    assert tuple(colors[0, :3]) == (0x44, 0x01, 0x54)
    assert tuple(colors[-1, :3]) == (0xFD, 0xE7, 0x25)
    flipped = atom_colors(mixture, "bfactor:viridis:100:0")
    assert (flipped[0] == colors[-1]).all()


def test_equal_values_still_have_a_colour(mixture):
    same = replace(mixture, b_factor=np.full(len(mixture), 20, np.float32))
    assert len(np.unique(atom_colors(same, "bfactor"), axis=0)) == 1


def test_plddt_has_alphafolds_bands(mixture):
    bands = replace(mixture, b_factor=np.resize([49.9, 50, 70, 90], len(mixture)))
    assert (atom_colors(bands, "plddt")[:4, :3] == palettes.PLDDT).all()


def test_chains_of_one_name_agree_and_chains_differ(mixture):
    colors = atom_colors(mixture, "chain")
    assert len(np.unique(colors[mixture.chain == 0], axis=0)) == 1
    twin = replace(mixture, chain_names=("A", "A"))
    assert len(np.unique(atom_colors(twin, "chain"), axis=0)) == 1


def test_palette_keeps_its_colours_apart():
    colors = palettes.distinct(12).astype(float)
    gaps = np.linalg.norm(colors[:, None] - colors[None], axis=-1)[~np.eye(12, dtype=bool)]
    assert gaps.min() > 25
    assert (palettes.distinct(3) == palettes.distinct(12)[:3]).all()


def test_carbons_of_a_single_chain_are_no_other_element():
    carbon, others = palettes.distinct(1), palettes.jmol()[[7, 8, 15, 16]]
    hues = palettes.lch_of(others)[:, 2] - palettes.lch_of(carbon)[:, 2]
    assert (np.abs((hues + 180) % 360 - 180) > 50).all()
    # eyes without red or green cones (Machado, Oliveira and Fernandes 2009) tell them apart, too
    for seen in (
        [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
        [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    ):
        linear = (np.concatenate([carbon, others]) / 255) ** 2.2 @ np.transpose(seen)
        light, chroma, hue = palettes.lch_of(255 * linear.clip(0, 1) ** (1 / 2.2)).T
        lab = np.stack([light, chroma * np.cos(np.radians(hue)), chroma * np.sin(np.radians(hue))])
        assert (np.linalg.norm(lab[:, 1:] - lab[:, :1], axis=0) > 0.1).all()


def test_oklch_of_white_and_of_pure_red():
    assert palettes.oklch(np.ones(1), 0.0, np.zeros(1)).tolist() == [[255, 255, 255]]
    red = palettes.oklch(np.array([0.62796]), 0.25768, np.array([29.2339]))
    assert np.abs(red[0].astype(int) - [255, 0, 0]).max() <= 1


def test_transparency_of_a_colour_is_kept():
    assert parse_color("#ff880080") == (255, 136, 0, 128)


@pytest.mark.parametrize(
    ("scheme", "says"),
    [
        ("oragne", "did you mean 'orange'"),
        ("chian", "did you mean 'chain'"),
        ("bfactor:virids", "did you mean viridis"),
        ("chain:viridis", "take a colour map"),
        ("chain+size", r"only '\+element'"),
        ("b:viridis:low:high", "must be numbers"),
        ("b:viridis:5:5", "two finite numbers"),
        ("", "unknown colour"),
    ],
)
def test_wrong_colours_are_explained(scheme, says):
    with pytest.raises(SettingsError, match=says):
        parse_scheme(scheme)


def test_scheme_tables_do_not_overlap():
    assert not set(CATEGORIES) & set(VALUES)
    assert not (set(CATEGORIES) | set(VALUES)) & set(ALIASES)
    assert set(ALIASES.values()) <= set(scheme_names())


def test_radii_are_bondis(mixture):
    bondi = dict(H=1.20, C=1.70, N=1.55, O=1.52, F=1.47, P=1.80, S=1.80, Cl=1.75, Zn=1.39)
    for symbol, radius in bondi.items():
        assert VAN_DER_WAALS[NUMBER_OF[symbol.upper()]] == np.float32(radius)
    assert (VAN_DER_WAALS > 1).all()
    assert (VAN_DER_WAALS < 3.6).all()
    assert (atom_radii(mixture) == VAN_DER_WAALS[mixture.element]).all()


def test_radii_of_the_file_come_first(mixture):
    own = np.full(len(mixture), 5.0, np.float32)
    assert (atom_radii(replace(mixture, radius=own)) == own).all()


def test_auto_paints_copies_of_one_chain_as_a_complex(mixture):
    one = replace(mixture, kind=np.where(mixture.chain == 1, LIGAND, mixture.kind).astype(np.uint8))
    auto = atom_colors(one, "auto", copies=60)
    polymer = polymer_atoms(one)
    assert (auto[polymer] == atom_colors(one, "chain")[polymer]).all()
    assert (auto[~polymer] == atom_colors(one, "element")[~polymer]).all()


def test_auto_shows_chains_of_a_complex_and_elements_of_all_else(mixture):
    auto, chains = atom_colors(mixture, "auto"), atom_colors(mixture, "chain")
    elements, polymer = atom_colors(mixture, "element"), polymer_atoms(mixture)
    assert (auto[polymer] == chains[polymer]).all() and (auto[~polymer] == elements[~polymer]).all()
    one = replace(mixture, kind=np.where(mixture.chain == 1, LIGAND, mixture.kind).astype(np.uint8))
    auto, by_chain = atom_colors(one, "auto"), polymer_atoms(one) & (one.element == 6)
    assert (auto[by_chain] == chains[by_chain]).all()
    assert (auto[~by_chain] == elements[~by_chain]).all()


def test_auto_paints_one_large_polymer_in_the_color_of_its_chain(mixture, monkeypatch):
    one = replace(mixture, kind=np.where(mixture.chain == 1, LIGAND, mixture.kind).astype(np.uint8))
    polymer = polymer_atoms(one)
    assert not (atom_colors(one, "auto")[polymer] == atom_colors(one, "chain")[polymer]).all()
    monkeypatch.setattr("scuro.style.color_by.MANY", int(polymer.sum()) - 1)
    assert (atom_colors(one, "auto")[polymer] == atom_colors(one, "chain")[polymer]).all()


def test_a_palette_colors_the_outer_compartments_and_spreads_below_them():
    from scuro.style.hierarchy import hierarchy_colors, palette_colors
    from scuro.style.palettes import lch_of, oklch

    paths = [("root", "plasma", "a"), ("root", "plasma", "b"), ("root", "virus", "c")]
    palette = palette_colors("#4477aa, orange")
    assert hierarchy_colors(paths, 1, palette).tolist() == [
        [68, 119, 170], [68, 119, 170], [255, 165, 0],
    ]  # fmt: skip
    leaves = hierarchy_colors(paths, None, palette)
    hues = lch_of(leaves)[:, 2]
    assert leaves[0].tolist() != leaves[1].tolist()
    assert np.abs(hues[:2] - lch_of(palette)[0, 2]).max() <= 26
    rgb = np.array([[10, 200, 90], [255, 255, 255], [3, 3, 3]], np.uint8)
    lightness, chroma, hue = lch_of(rgb).T
    np.testing.assert_allclose(oklch(lightness, chroma, hue).astype(int), rgb, atol=1)
    assert len(palette_colors("tab10")) == 10 and len(palette_colors("viridis")) == 8
    with pytest.raises(SettingsError, match="nonsense"):
        palette_colors("nonsense")
