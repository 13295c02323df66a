"""Colour schemes: what is said of an atom becomes its base colour.

A scheme is written ``NAME``, ``NAME:MAP`` or ``NAME:MAP:LOW:HIGH`` (colour map and the values at
its ends), each optionally followed by ``+element``, which leaves the scheme on carbon and gives
every other element its own colour, as chemists like it: ``chain+element``, ``bfactor:viridis``,
``bfactor:magma:10:80``, ``tomato``, ``#7fc97f+element``.
"""

from __future__ import annotations

import difflib
import logging
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.scene.molecule import Molecule
from scuro.style.color_by import (
    CARBON,
    UNKNOWN_ELEMENT,
    by_chain,
    by_complex,
    by_content,
    by_cpk,
    by_element,
    by_entity,
    by_illustration,
    by_model,
    by_plddt,
    by_residue,
    by_secondary,
    hydropathy,
    residue_rank,
)


def atom_colors(molecule: Molecule, scheme: str = "auto", copies: int = 1) -> NDArray[np.uint8]:
    """Base colour (n, 4) of every atom, sRGB with full alpha, by a scheme (see the module).

    Args:
        molecule: n atoms.
        scheme: As users write it.
        copies: How often a biological assembly places parts of the molecule: ``auto`` paints a
            complex of several like one of several chains.

    Raises:
        SettingsError: The scheme, the colour or the colour map is not known.
    """
    if copies > 1 and scheme.strip().lower() == "auto":
        scheme = "complex"
    wanted = parse_scheme(scheme)
    rgb = wanted.paint(molecule)
    if wanted.hetero_by_element:
        hetero = (molecule.element != CARBON) & (molecule.element != UNKNOWN_ELEMENT)
        rgb = np.where(hetero[:, None], by_element(molecule), rgb)
    return np.concatenate([rgb, np.full((len(molecule), 1), 255, np.uint8)], axis=1)


@dataclass(frozen=True)
class Scheme:
    """A colour scheme ready for use; ``paint`` gives sRGB (n, 3)."""

    paint: Callable[[Molecule], NDArray[np.uint8]]
    hetero_by_element: bool = False


def parse_scheme(text: str) -> Scheme:
    """Read a scheme as users write it.

    Raises:
        SettingsError: It is not known; the nearest known name is suggested.
    """
    body, plus, extra = text.strip().partition("+")
    if plus and extra.strip().lower() not in ("element", "byelement"):
        raise SettingsError(f"colour '{text}': only '+element' can be added to a scheme")
    name, *rest = body.strip().split(":")
    key = name.strip().lower()
    if key in HETERO_ALIASES:
        key, plus = HETERO_ALIASES[key], "+"
    key = ALIASES.get(key, key)
    if key in VALUES:
        return Scheme(_mapped(text, VALUES[key], rest), bool(plus))
    if rest:
        raise SettingsError(
            f"colour '{text}': only {', '.join(VALUES)} take a colour map, not '{name}'"
        )
    if key in CATEGORIES:
        return Scheme(CATEGORIES[key], bool(plus))
    fixed = np.array(parse_color(name)[:3], np.uint8)
    return Scheme(lambda molecule: np.tile(fixed, (len(molecule), 1)), bool(plus))


def parse_color(text: str) -> tuple[int, int, int, int]:
    """sRGB and alpha, 0 to 255, of a CSS colour name, ``#rgb``, ``#rrggbb`` or ``rgb(r, g, b)``."""
    import cmap

    try:
        color = cmap.Color(text.strip()).rgba8
    except (ValueError, TypeError):
        raise SettingsError(_unknown_color(text)) from None
    return color.r, color.g, color.b, round(255 * color.a)


def color_map(name: str) -> Callable[[NDArray], NDArray[np.uint8]]:
    """A colour map of the ``cmap`` catalogue, from values 0 to 1 (n,) to sRGB (n, 3)."""
    import cmap

    logging.getLogger("cmap").setLevel(logging.ERROR)  # it warns of names in two catalogues
    try:
        found = cmap.Colormap(name)
    except (ValueError, TypeError):
        near = difflib.get_close_matches(name, cmap.Catalog().short_keys(), n=3)
        hint = f"did you mean {' or '.join(near)}? " if near else ""
        raise SettingsError(
            f"unknown colour map '{name}': {hint}any map of the cmap library will do,"
            " such as viridis, magma, cividis, turbo or crameri:batlow"
        ) from None
    return lambda values: np.round(255 * np.asarray(found(values))[..., :3]).astype(np.uint8)


@dataclass(frozen=True)
class _Quantity:
    """A number per atom (n,), its usual colour map, and the range that it has by itself."""

    values: Callable[[Molecule], NDArray]
    map: str
    low: float = math.nan
    high: float = math.nan


VALUES: dict[str, _Quantity] = {
    "bfactor": _Quantity(lambda m: m.b_factor, "colorbrewer:RdYlBu_r"),
    "occupancy": _Quantity(lambda m: m.occupancy, "bids:viridis", 0.0, 1.0),
    "charge": _Quantity(lambda m: m.formal_charge.astype(np.float32), "colorbrewer:RdBu", -2, 2),
    "sequence": _Quantity(residue_rank, "google:turbo", -0.06, 1.05),  # without turbo's dark ends
    "hydrophobicity": _Quantity(hydropathy, "colorbrewer:BrBG_r", -4.5, 4.5),
}
"""Schemes that go through a colour map. Atoms without a value are coloured by element."""

CATEGORIES: dict[str, Callable[[Molecule], NDArray[np.uint8]]] = {
    "auto": by_content,
    "complex": by_complex,
    "element": by_element,
    "cpk": by_cpk,
    "chain": by_chain,
    "entity": by_entity,
    "model": by_model,
    "residue": by_residue,
    "secondary": by_secondary,
    "illustrative": by_illustration,
    "plddt": by_plddt,
}

ALIASES = {
    "byelement": "element", "element-symbol": "element", "jmol": "element", "elem": "element",
    "bychain": "chain", "chain-id": "chain", "chainbow": "sequence", "bypolymer": "entity",
    "entity-id": "entity", "bymodel": "model", "bynucleotide": "residue", "byresidue": "residue",
    "residue-name": "residue", "resn": "residue", "ss": "secondary", "structure": "secondary",
    "secondary-structure": "secondary", "b": "bfactor", "b-factor": "bfactor",
    "uncertainty": "bfactor", "confidence": "plddt", "rainbow": "sequence",
    "sequence-id": "sequence", "kyte-doolittle": "hydrophobicity", "formal-charge": "charge",
}  # fmt: skip
"""Names that other programs give the same schemes."""
HETERO_ALIASES = {"byhet": "chain", "byhetero": "chain"}


def scheme_names() -> tuple[str, ...]:
    """All schemes by their own names."""
    return (*CATEGORIES, *VALUES)


def scale_of(
    scheme: str, molecule: Molecule
) -> tuple[str, Callable[[NDArray], NDArray[np.uint8]], float, float] | None:
    """How a scheme goes through a colour map: its name, the map, and the values at its ends.

    ``None`` for schemes that do not, and where no atom has a value.
    """
    name, *rest = scheme.strip().partition("+")[0].split(":")
    key = ALIASES.get(name.strip().lower(), name.strip().lower())
    if key not in VALUES:
        return None
    look_up, ends = _scale(scheme, VALUES[key], rest)
    values = VALUES[key].values(molecule)
    known = values[np.isfinite(values)]
    return (key, look_up, *(ends or _spread(known))) if len(known) else None


def _scale(
    text: str, quantity: _Quantity, options: list[str]
) -> tuple[Callable[[NDArray], NDArray[np.uint8]], tuple[float, float] | None]:
    """Colour map and ends from the options written after a quantity: map, low, high.

    Without ends of its own or given ones a quantity goes over what its values spread over.
    """
    if len(options) == 2 or len(options) >= 4:  # a map's own name may hold a colon
        options = [":".join(options[:2]), *options[2:]]
    if len(options) not in (0, 1, 3):
        raise SettingsError(f"colour '{text}': write it as scheme:map or scheme:map:low:high")
    look_up = color_map(options[0] if options else quantity.map)
    low, high = quantity.low, quantity.high
    if len(options) == 3:
        try:
            low, high = float(options[1]), float(options[2])
        except ValueError:
            raise SettingsError(f"colour '{text}': the ends of the map must be numbers") from None
        if not (math.isfinite(low) and math.isfinite(high)) or low == high:
            raise SettingsError(f"colour '{text}': the ends of the map must be two finite numbers")
    return look_up, (low, high) if math.isfinite(low) else None


def _mapped(
    text: str, quantity: _Quantity, options: list[str]
) -> Callable[[Molecule], NDArray[np.uint8]]:
    """Painter for a quantity with the options written after it."""
    look_up, fixed = _scale(text, quantity, options)

    def paint(molecule: Molecule) -> NDArray[np.uint8]:
        values = quantity.values(molecule)
        known = np.isfinite(values)
        if not known.any():
            return by_element(molecule)
        ends = fixed or _spread(values[known])
        share = (np.where(known, values, ends[0]) - ends[0]) / (ends[1] - ends[0])
        rgb = look_up(np.clip(share, 0.0, 1.0))
        return np.where(known[:, None], rgb, by_element(molecule))

    return paint


def _spread(values: NDArray) -> tuple[float, float]:
    """Range for a colour map: all but the outermost two per cent, which would wash out the rest."""
    low, high = np.percentile(values, [2.0, 98.0])
    return (float(low), float(high)) if high > low else (float(low) - 0.5, float(low) + 0.5)


def _unknown_color(text: str) -> str:
    from PIL.ImageColor import colormap as css_names

    names = (*scheme_names(), *ALIASES, *css_names)
    near = difflib.get_close_matches(text.strip().lower(), names, n=1)
    hint = f"did you mean '{near[0]}'? " if near else ""
    return (
        f"unknown colour '{text}': {hint}known are the schemes {', '.join(scheme_names())},"
        " CSS colour names and #rrggbb"
    )
