"""Colours of a hierarchy: hue tells the branch, chroma and lightness the depth.

After Waldin et al. (2016, "Chameleon: dynamic color mapping for multi-scale structural biology
models"), in OKLCh: the circle of hues is shared out among the root's children, each child's arc
among its own children, and so on. Seen from afar an ingredient has its compartment's hue; as one
approaches, hues spread over the arcs, chroma grows and siblings differ in lightness.

A given palette takes the place of the circle: its colours are those of the root's children in
order, around which the hues of all below them spread.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.style.paint import srgb
from scuro.style.palettes import lch_of, oklch

FIRST_HUE = 250.0
"""Degrees: the first branch is blue; the others follow around the circle."""
GAP = 0.35
"""Share of an arc that is left empty between siblings."""
LIGHTNESS, LIGHTNESS_SPREAD = 0.74, 0.07
CHROMA_FAR, CHROMA_NEAR = 0.08, 0.125
PALETTE_ARC = 50.0
"""Degrees over which hues spread around a palette's colour."""
_SAMPLES = 8
"""Colours taken from a continuous map."""

Path = tuple[str, ...]


def hierarchy_colors(
    paths: Sequence[Path], level: float | None = None, palette: NDArray[np.uint8] | None = None
) -> NDArray[np.uint8]:
    """Colours (n, 3), sRGB, of the leaves of a tree.

    Args:
        paths: Root first, the leaf's own name last, for each leaf. Equal paths get equal colours.
        level: How deep the colours tell branches apart: 1 for the root's children, 2 for theirs;
            between two whole levels the colours pass smoothly from one to the other. ``None`` for
            the leaves themselves.
        palette: sRGB (m, 3) of the root's children, from the first again when there are more.
    """
    depth = max((len(p) for p in paths), default=1) - 1
    level = float(depth) if level is None else min(max(level, 0.0), float(depth))
    anchors = None if palette is None else lch_of(palette)
    hues = _hues(paths, anchors)
    low = int(np.floor(level))
    share = level - low
    near = _look(paths, hues, low, depth, anchors)
    far = _look(paths, hues, min(low + 1, depth), depth, anchors)
    lightness, chroma, hue = (1 - share) * near + share * far
    return oklch(lightness, chroma, hue)


def palette_colors(words: str) -> NDArray[np.uint8]:
    """sRGB (m, 3) of colours with commas between them, or of a colour map's name.

    Raises:
        SettingsError: A colour or map is not known.
    """
    try:
        colors = np.array([srgb(word.strip())[:3] for word in words.split(",")])
    except SettingsError:
        if "," in words:
            raise
        from cmap import Colormap

        try:
            found = Colormap(words)
        except (ValueError, KeyError, TypeError):
            raise SettingsError(
                f"'{words}' is neither a colour, colours with commas between them, nor a colour "
                "map such as 'tab10' or 'viridis'"
            ) from None
        count = len(found.color_stops) if found.interpolation == "nearest" else _SAMPLES
        colors = found(np.linspace(0, 1, count))[:, :3]
    return np.rint(255 * colors).astype(np.uint8)


def _look(
    paths: Sequence[Path],
    hues: dict[Path, float],
    level: int,
    depth: int,
    anchors: NDArray[np.float64] | None,
) -> NDArray[np.float64]:
    """(3, n) lightness, chroma and hue in degrees with branches told apart down to ``level``."""
    # a leaf's own name counts on the deepest level only, however short its path
    ancestors = [p if level >= depth else p[: min(level + 1, max(len(p) - 1, 1))] for p in paths]
    rank = _sibling_rank(paths)
    steps = np.array([rank[a] % 3 - 1 for a in ancestors]) * (level >= depth)
    chroma = CHROMA_FAR + (CHROMA_NEAR - CHROMA_FAR) * level / max(depth, 1)
    light = np.full(len(paths), LIGHTNESS)
    strength = np.full(len(paths), chroma)
    if anchors is not None:
        branch = np.array([rank[a[:2]] if len(a) > 1 else 0 for a in ancestors]) % len(anchors)
        light, strength = anchors[branch, 0], anchors[branch, 1]
    hue = np.array([hues[a] for a in ancestors], np.float64)
    return np.stack([light + LIGHTNESS_SPREAD * steps, strength, hue])


def _hues(paths: Sequence[Path], anchors: NDArray[np.float64] | None) -> dict[Path, float]:
    """Hue in degrees, not wrapped, of every node: the middle of its arc."""
    children = _children(paths)
    hues: dict[Path, float] = {}
    root = paths[0][:1] if paths else ("",)
    stack = [(root, FIRST_HUE, FIRST_HUE + 360.0)]
    while stack:
        node, start, end = stack.pop()
        hues[node] = (start + end) / 2 if len(node) > 1 else FIRST_HUE
        below = list(children.get(node, ()))
        if not below:
            continue
        # a node's share grows with what is below it, but slowly: few-membered branches stay visible
        weights = np.array([1.0 + _count(children, child) for child in below]) ** 0.35
        edges = start + (end - start) * np.concatenate([[0], np.cumsum(weights)]) / weights.sum()
        for index, (child, low, high) in enumerate(zip(below, edges[:-1], edges[1:], strict=True)):
            if anchors is not None and len(child) == 2:
                hue = anchors[index % len(anchors), 2]
                stack.append((child, hue - PALETTE_ARC / 2, hue + PALETTE_ARC / 2))
                continue
            margin = (high - low) * GAP / 2 if len(below) > 1 else 0.0
            stack.append((child, low + margin, high - margin))
    return hues


def _children(paths: Sequence[Path]) -> dict[Path, dict[Path, None]]:
    """Children of every inner node, in order of appearance."""
    found: dict[Path, dict[Path, None]] = {}
    for path in paths:
        for depth in range(1, len(path)):
            found.setdefault(path[:depth], {})[path[: depth + 1]] = None
    return found


def _count(children: dict[Path, dict[Path, None]], node: Path) -> int:
    return sum(1 + _count(children, child) for child in children.get(node, ()))


def _sibling_rank(paths: Sequence[Path]) -> dict[Path, int]:
    """Position of every node among its siblings."""
    ranks: dict[Path, int] = {p[:1]: 0 for p in paths}
    for siblings in _children(paths).values():
        ranks |= {node: rank for rank, node in enumerate(siblings)}
    return ranks
