"""Numbers in columns: properties against Python's own conversion."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from structure_files import pdb_atom

from scuro.load.assembly import expand_operators, quaternions
from scuro.load.columns import decimals, fixed_floats, fixed_integers
from scuro.load.pdb import read_table
from scuro.load.source import Source


@given(st.lists(st.tuples(st.floats(-9999, 9999), st.integers(0, 4)), min_size=1, max_size=30))
def test_decimals_are_correctly_rounded(numbers: list[tuple[float, int]]) -> None:
    texts = [f"{value:.{digits}f}"[:12].encode() for value, digits in numbers]
    values, good = decimals(np.array(texts))
    assert good.all()
    assert values.tolist() == [float(text) for text in texts]


@given(st.lists(st.text("0123456789+-. eEnaif", max_size=9), min_size=1, max_size=30))
def test_decimals_never_accept_what_python_refuses(texts: list[str]) -> None:
    encoded = [text.encode() for text in texts]
    values, good = decimals(np.array(encoded, "S9"))
    for text, value, accepted in zip(encoded, values.tolist(), good.tolist(), strict=True):
        if accepted:
            assert value == float(text)


@given(st.lists(st.text("0123456789+-. eEnaif", max_size=9), min_size=1, max_size=30))
def test_fixed_floats_agree_with_python(texts: list[str]) -> None:
    encoded = np.array([text.encode() for text in texts], "S9")
    values = fixed_floats(encoded, default=-1.0)
    for text, value in zip(texts, values.tolist(), strict=True):
        try:
            expected = float(text)
        except ValueError:
            expected = -1.0
        assert value == (expected if np.isfinite(expected) else -1.0)


@given(st.integers(-9999, 43_770_015 + 26 * 36**4 - 1))
def test_hybrid_36(number: int) -> None:
    text = _hybrid_36(number, 5)
    values, bad = fixed_integers(np.array([text.encode()]), hybrid=True)
    assert not bad.any()
    assert values.tolist() == [number]


def _hybrid_36(number: int, width: int) -> str:
    """The encoder, by the paper's definition."""
    if number < 10**width:
        return f"{number:{width}d}"
    rest = number - 10**width
    digits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    lower = rest >= 26 * 36 ** (width - 1)
    rest = rest - (26 * 36 ** (width - 1) if lower else 0) + 10 * 36 ** (width - 1)
    text = ""
    while rest:
        rest, digit = divmod(rest, 36)
        text = digits[digit] + text
    return text.lower() if lower else text


@given(
    st.lists(
        st.tuples(*[st.floats(-999, 9999, width=32)] * 3, st.integers(-999, 9999)),
        min_size=1,
        max_size=20,
    )
)
def test_pdb_coordinates_and_numbers(atoms: list[tuple[float, float, float, int]]) -> None:
    text = "".join(
        pdb_atom(i, number=number, xyz=(x, y, z)) for i, (x, y, z, number) in enumerate(atoms)
    )
    source = Source("made.pdb", None)
    source.__dict__["data"] = text.encode()  # what the cached property would read
    table = read_table(source)
    expected = [[float(f"{c:.3f}") for c in atom[:3]] for atom in atoms]
    assert np.array_equal(table.positions, np.array(expected, np.float32))
    assert table.residue_number.tolist() == [atom[3] for atom in atoms]


def test_operator_expressions() -> None:
    assert expand_operators("1,3-5") == [("1",), ("3",), ("4",), ("5",)]
    assert expand_operators("(1-2)(X0)") == [("1", "X0"), ("2", "X0")]
    assert len(expand_operators("(1-60)(61-62)")) == 120
    assert expand_operators("(46660-46659)") == []


@given(st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_quaternions_give_back_their_rotation(q: tuple[float, ...]) -> None:
    x, y, z, w = np.array(q) / np.linalg.norm(q)
    matrix = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    found = quaternions(matrix[None])[0].astype(np.float64)
    assert abs(abs(found @ [x, y, z, w]) - 1) < 1e-5
