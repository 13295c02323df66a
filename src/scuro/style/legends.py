"""The legends of a scene: what its molecules', volume's and reservoirs' colours mean."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.load.elements import SYMBOLS
from scuro.scene.molecule import HELIX, POLYMER_NUCLEIC, POLYMER_PROTEIN, STRAND, Molecule
from scuro.scene.reservoir import ReservoirItem
from scuro.style import palettes
from scuro.style.color import ALIASES, VALUES, atom_colors, scale_of
from scuro.style.color_by import polymer_atoms
from scuro.style.legend import (
    MOST_SWATCHES,
    STEPS,
    Legend,
    bar_shares,
    opacity_curve,
    strip_colors,
)
from scuro.style.reservoir import item_transfer, property_range

if TYPE_CHECKING:
    from scuro.passes.volume.settings import VolumeSettings
    from scuro.render_settings import Settings
    from scuro.scene.items import MoleculeItem, VolumeItem
    from scuro.scene.scene import Scene

BINS = 48
_QUANTITIES = {
    "bfactor": "B-factor (Å²)",
    "occupancy": "occupancy",
    "charge": "formal charge (e)",
    "sequence": "along the chain",
    "hydrophobicity": "hydropathy (Kyte–Doolittle)",
}
_SEQUENCE_ENDS = ("start", "end")
_BANDS = ("below 50, very low", "50 to 70, low", "70 to 90, confident", "above 90, very high")
_HOUNSFIELD = "radiodensity (HU)"


def scene_legends(scene: Scene, settings: Settings) -> list[Legend]:
    """What a picture's colours mean, in the order of the scene's items."""
    found: list[Legend] = []
    for item in scene.molecules:
        found += [legend for legend in molecule_legends(item) if legend not in found]
    found += [volume_legend(item, settings.volume) for item in scene.volumes]
    found += [reservoir_legend(item) for item in scene.reservoirs]
    return found


def reservoir_legend(item: ReservoirItem) -> Legend:
    """Property and unit, model and date, exaggeration; opacity where it is a volume."""
    grid, name = item.grid, item.shown_property
    unit = grid.property_unit(name)
    low, high = property_range(grid, name)
    transfer = item_transfer(item)
    steps = np.linspace(low, high, STEPS)
    lines = [grid.name]
    if grid.changes(name) and grid.steps:
        lines = [f"{grid.name}, {grid.steps[grid.step_index(item.settings.time)]}"]
    if item.exaggeration != 1:
        lines.append(f"heights × {item.exaggeration:g}")
    values: Any = item.values()
    counts = np.histogram(values[np.isfinite(values)], bins=BINS, range=(low, high))[0]
    return Legend(
        f"{name} ({unit})" if unit else name,
        tuple(lines),
        low,
        high,
        strip_colors(transfer.color(steps)),
        bars=bar_shares(counts),
        curve=opacity_curve(transfer.opacity(steps)) if item.show == "volume" else (),
    )


def volume_legend(item: VolumeItem, settings: VolumeSettings) -> Legend:
    """Colours and opacity over the histogram of the values; of label maps, the labels' colours."""
    from scuro.style.transfer_choose import choose_transfer

    volume = item.volume
    transfer = item.shown or choose_transfer(
        volume, settings.transfer, settings.opacity, settings.window, settings.level
    )
    title = volume.value_name or "value"
    least, greatest = volume.value_range
    if volume.values.dtype.kind == "i" and least <= -900 and greatest >= 900:
        title = _HOUNSFIELD
    lines = (volume.name,) if volume.name else ()
    if settings.iso is not None:
        color = strip_colors(transfer.color(np.array([settings.iso])))[0]
        return Legend(title, lines, swatches=((color, f"{settings.iso:g}"),))
    if transfer.stepped:
        shown = [v for v, a in transfer.opacities if a > 0]
        colors = strip_colors(transfer.color(np.array(shown[:MOST_SWATCHES], float)))
        swatches = tuple((c, f"{v:g}") for c, v in zip(colors, shown, strict=False))
        return Legend("label", lines, swatches=swatches, more=len(shown) - len(swatches))
    low, high = shown_range(transfer, least, greatest)
    steps = np.linspace(low, high, STEPS)
    edges = np.linspace(least, greatest, len(volume.histogram) + 1)
    middles = (edges[1:] + edges[:-1]) / 2
    counts = np.histogram(middles, bins=BINS, range=(low, high), weights=volume.histogram)[0]
    return Legend(
        title,
        lines,
        low,
        high,
        strip_colors(transfer.color(steps)),
        bars=bar_shares(counts),
        curve=opacity_curve(transfer.opacity(steps)),
    )


def shown_range(transfer: Any, least: float, greatest: float) -> tuple[float, float]:
    """Values between which colour or opacity change, within those that there are."""
    points = [p[0] for p in transfer.colors] + [p[0] for p in transfer.opacities]
    low, high = max(min(points), least), min(max(points), greatest)
    if not high > low:
        low, high = least, greatest
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def molecule_legends(item: MoleculeItem) -> Iterator[Legend]:
    """One for each colour scheme that the molecule is shown in; plain colours have none."""
    from scuro.scene.items import Shown
    from scuro.style.selection import select

    molecule = item.molecule
    seen = set()
    for shown in item.shown or [Shown()]:
        mask = select(molecule, shown.select)
        if shown.color in seen or not mask.any():
            continue
        seen.add(shown.color)
        scale = scale_of(shown.color, molecule)
        if scale is not None:
            yield _quantity(molecule, mask, *scale)
            continue
        named = _categories(molecule, shown.color, mask)
        if named is not None:
            title, names, order = named
            legend = _swatches(molecule, title, names, order, mask, shown.color)
            if legend.swatches:
                yield legend


def _quantity(
    molecule: Molecule, mask: NDArray, key: str, look_up: Any, low: float, high: float
) -> Legend:
    values = VALUES[key].values(molecule)[mask]
    values = values[np.isfinite(values)]
    left, right = min(low, high), max(low, high)
    shares = (np.linspace(left, right, STEPS) - low) / (high - low)
    return Legend(
        _QUANTITIES[key],
        (molecule.name,) if molecule.name else (),
        left,
        right,
        strip_colors(look_up(np.clip(shares, 0, 1)) / 255),
        ends=_SEQUENCE_ENDS if key == "sequence" else None,
        bars=()
        if key == "sequence"
        else bar_shares(np.histogram(np.clip(values, left, right), BINS, (left, right))[0]),
    )


def _categories(
    molecule: Molecule, scheme: str, mask: NDArray[np.bool_]
) -> tuple[str, NDArray, bool] | None:
    """Title, the name of each atom's class (empty for none), and whether to sort by number."""
    key = scheme.strip().lower().partition("+")[0]
    key = ALIASES.get(key, key)
    chains = np.asarray(molecule.chain_names, object)[molecule.chain]
    polymer = polymer_atoms(molecule)
    if key in ("auto", "complex"):
        # chains of a complex, elements of all else
        several = len(np.unique(molecule.chain[polymer])) > 1
        if (several or key == "complex") and (mask & polymer).any():
            return "chain", np.where(polymer, chains, ""), False
        key = "element"
        names = np.array(SYMBOLS, object)[molecule.element]
        return "element", np.where(polymer & (molecule.element == 6), "", names), True
    if key in ("chain", "illustrative"):
        return "chain", chains, False
    if key in ("element", "cpk"):
        return "element", np.array(SYMBOLS, object)[molecule.element], True
    if key == "entity":
        known = np.asarray(molecule.entity_names, object)
        which = molecule.chain_entity[molecule.chain]
        return ("entity", known[which], False) if len(known) else None
    if key == "model":
        return "model", np.array([f"model {m}" for m in molecule.model], object), False
    if key == "residue":
        return "residue", np.asarray(molecule.residue_name, object)[molecule.residue], True
    if key == "secondary":
        kind = molecule.secondary[molecule.residue]
        names = np.select([kind == HELIX, kind == STRAND], ["helix", "strand"], "coil")
        names = np.where(molecule.kind == POLYMER_PROTEIN, names, "")
        return (
            "secondary structure",
            np.where(molecule.kind == POLYMER_NUCLEIC, "nucleic acid", names).astype(object),
            False,
        )
    if key == "plddt":
        band = np.searchsorted([50.0, 70.0, 90.0], molecule.b_factor, side="right")
        return "confidence (pLDDT)", np.array(_BANDS, object)[band], False
    return None


def _swatches(
    molecule: Molecule, title: str, names: NDArray, by_count: bool, mask: NDArray, scheme: str
) -> Legend:
    """The classes of the atoms in a mask, with the colour that they are painted in."""
    told = np.flatnonzero(mask & (names != ""))
    if title == "confidence (pLDDT)":
        order = [n for n in _BANDS if (names[told] == n).any()]
        colors = dict(zip(_BANDS, palettes.PLDDT.tolist(), strict=True))
    else:
        found, first, count = np.unique(
            names[told].astype(str), return_index=True, return_counts=True
        )
        rank = np.argsort(-count if by_count else first, kind="stable")
        order = found[rank].tolist()
        painted = atom_colors(molecule, scheme)[told[first[rank]], :3].tolist()
        colors = dict(zip(order, painted, strict=True))
    rows = tuple((tuple(colors[name]), name) for name in order[:MOST_SWATCHES])
    return Legend(
        title,
        (molecule.name,) if molecule.name else (),
        swatches=rows,
        more=len(order) - len(rows),
    )
