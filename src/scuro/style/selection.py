"""Atom selections: ``chain A and resi 10-40``, ``byres (polymer within 5 of organic)``, ...

The words and their precedence are PyMOL's; ``selection.lark`` is the grammar. Names of chains keep
their case, all other names do not. ``*`` stands for any characters in a name, ``+`` or ``,``
separate alternatives, quotes protect them. ``segi`` means the chain, ``index`` counts atoms from 1.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.molecule import Molecule
from scuro.style.bath import bath
from scuro.style.selection_words import BY, FLAGS, NUMBERS, POSTFIX, PROPERTIES, WITHIN, macro

if TYPE_CHECKING:
    from lark import Lark, Token, Tree
    from lark.exceptions import UnexpectedInput

Mask = NDArray[np.bool_]


def select(molecule: Molecule, text: str) -> Mask:
    """Which atoms (n,) a selection takes; ``auto`` is all but water about it.

    Raises:
        SettingsError: The text is not a selection; names the column and what was expected there.
    """
    if text.strip().lower() in ("all", "*"):
        return np.ones(len(molecule), bool)
    if text.strip().lower() == "auto":
        return ~bath(molecule)
    try:
        return _evaluate(_parse(text), molecule, text)
    except RecursionError:
        raise SettingsError(f"{_quote(text)} is nested too deeply") from None


@cache
def _parser() -> Lark:
    from importlib.resources import files

    from lark import Lark

    grammar = (files("scuro.style") / "selection.lark").read_text("utf-8")
    terminals: dict[str, tuple[Iterable[str], str]] = {
        "FLAG": (FLAGS, r"(?![\w.*'+-])"),
        "PROPERTY": (PROPERTIES, r"""(?=[\s"']|$)"""),
        "NUMERIC": (NUMBERS, r"(?=\s*[<>=!\d.+-])"),
        "BY": (BY, r"(?![\w.])"),
        "POSTFIX": (POSTFIX, r"(?![\w.])"),
        "WITHIN": (WITHIN, r"(?![\w.])"),
    }
    for name, (words, end) in terminals.items():
        options = "|".join(re.escape(w) for w in sorted(words, key=len, reverse=True))
        grammar += f"\n{name}: /({options}){end}/i"
    return Lark(grammar, parser="lalr", propagate_positions=False, maybe_placeholders=False)


@cache
def _parse(text: str) -> Tree[Token]:
    from lark.exceptions import UnexpectedInput

    try:
        return _parser().parse(text)
    except UnexpectedInput as error:
        raise SettingsError(_complaint(text, error)) from None


def _evaluate(tree: Tree[Token], molecule: Molecule, text: str) -> Mask:
    """Mask of one node of the parsed selection; the rules are those of ``selection.lark``."""

    def inner(node: Any) -> Mask:
        return _evaluate(node, molecule, text)

    parts: list[Any] = tree.children
    match tree.data:
        case "and_":
            return inner(parts[0]) & inner(parts[1])
        case "or_":
            return inner(parts[0]) | inner(parts[1])
        case "not_":
            return ~inner(parts[0])
        case "by":
            return BY[parts[0].lower()](molecule, inner(parts[1]))
        case "postfix":
            return POSTFIX[parts[1].lower()](molecule, inner(parts[0]), _number(parts[2]))
        case "within":
            near = WITHIN[parts[1].lower()](molecule, inner(parts[3]), _number(parts[2]))
            return inner(parts[0]) & near
        case "all_within":
            return WITHIN[parts[0].lower()](molecule, inner(parts[2]), _number(parts[1]))
        case "flag":
            return FLAGS[parts[0].lower()](molecule)
        case "compare":
            compare = _COMPARISONS[str(parts[1])]
            return compare(NUMBERS[parts[0].lower()](molecule), _number(parts[2]))
    try:  # the two that read what the user wrote further
        if tree.data == "macro":
            return macro(molecule, str(parts[0]))
        return PROPERTIES[parts[0].lower()](molecule, str(parts[1]))
    except ValueError as error:
        column = parts[-1].start_pos + 1
        raise SettingsError(f"{_quote(text)}, column {column}: {error}") from None


_COMPARISONS = {
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
    "=": np.equal, "==": np.equal, "!=": np.not_equal,
}  # fmt: skip


def _number(tree: Tree[Token]) -> float:
    return float(tree.children[0])  # type: ignore[arg-type]


_EXPECTED = {
    "FLAG": "a selection such as 'chain A', 'polymer' or '('",
    "VALUES": "a name or a list of names (quoted if it is a word of the language)",
    "SIGNED_NUMBER": "a number",
    "COMPARISON": "a comparison such as '>'",
    "_OF": "'of'",
    "_AND": "'and', 'or' or a distance such as 'around 5'",
    "RPAR": "')'",
    "$END": "the end",
}
"""What to call the grammar's terminals, most telling first."""


def _complaint(text: str, error: UnexpectedInput) -> str:
    """The sentence for a selection that is not one."""
    # A token that does not fit comes with the terminals that do; characters that make no token
    # at all come with those that were tried.
    fitting = getattr(error, "accepts", None) or getattr(error, "allowed", None) or ()
    expected = " or ".join(words for terminal, words in _EXPECTED.items() if terminal in fitting)
    ended = getattr(getattr(error, "token", None), "type", "") == "$END"
    column = len(text) if ended else error.pos_in_stream or 0
    rest = text[column:].split(maxsplit=1)
    where = f"{_quote(text)}, column {column + 1}: expected {expected}"
    if not rest:
        return f"{where}, but it ends"
    hint = ""
    if "FLAG" in fitting:
        words = [*FLAGS, *PROPERTIES, *BY, *WITHIN, "not"]
        near = difflib.get_close_matches(rest[0].strip("()").lower(), words, n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
    return f"{where}, not '{rest[0][:40]}'{hint}"


def _quote(text: str) -> str:
    return f"selection '{text if len(text) <= 120 else text[:117] + '...'}'"
