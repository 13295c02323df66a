"""Chemical elements: from symbols, and inferred from atom names where a file has none."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from scuro.style.elements import SYMBOLS

_NUMBER = {symbol.upper().encode(): z for z, symbol in enumerate(SYMBOLS) if z} | {b"D": 1, b"T": 1}

_ION_NAMES = {b"SOD": 11, b"POT": 19, b"CLA": 17, b"CAL": 20, b"CES": 55, b"LIT": 3, b"RUB": 37}
"""CHARMM's names of ions, whose letters say another element."""

_LIKELY = frozenset(b"FE ZN MG MN CU CO NI CL BR NA HG CD SE LI PT AU".split())
"""Two-letter elements that a left-aligned name may stand for outside polymers."""


def atomic_numbers(symbols: NDArray[np.bytes_]) -> NDArray[np.uint8]:
    """Atomic numbers of element symbols in any case; 0 for blanks and unknown ones."""
    distinct, inverse = np.unique(symbols, return_inverse=True)
    numbers = [_NUMBER.get(s.strip().upper(), 0) for s in distinct.tolist()]
    return np.array(numbers, np.uint8)[inverse.ravel()]


@cache
def infer(name: bytes, residue: bytes, polymer: bool) -> int:
    """Atomic number from an atom's name.

    Args:
        name: The name; four characters wide from a PDB file, whose second column then is where
            one-letter elements begin (`` CA `` is carbon, ``CA  `` calcium).
        residue: The residue's name (an ion's residue is named like its atom).
        polymer: Whether the residue is an amino acid or a nucleotide: these hold no metals.
    """
    bare = name.strip().upper()
    letters = bare.lstrip(b"0123456789'\"*")
    stem = letters.rstrip(b"0123456789+-")
    if not letters:
        return 0
    if bare == residue.upper() and bare in _ION_NAMES:
        return _ION_NAMES[bare]
    if bare == residue.upper().rstrip(b"0123456789+-") and stem in _NUMBER:
        return _NUMBER[stem]
    aligned = len(name) == 4
    two = letters[:2]
    if polymer:
        if two == b"SE" and residue.upper() in (b"MSE", b"SEC", b"CSE"):
            return 34
        return _NUMBER.get(letters[:1], 0)
    if aligned and name[:1].isalpha() and two in _NUMBER and not _is_hydrogen(name):
        return _NUMBER[two]
    if not aligned and (two in _LIKELY and stem == two):
        return _NUMBER[two]
    return _NUMBER.get(letters[:1], _NUMBER.get(two, 0))


def _is_hydrogen(name: bytes) -> bool:
    """A four-character hydrogen name that fills the element's column, such as ``HG11``."""
    return name[:1] in b"Hh" and len(name.strip()) == 4
