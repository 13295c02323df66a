"""How cluttered a picture is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def edge_density(picture: NDArray[np.uint8], threshold: float = 0.08) -> float:
    """Share of the shown object's pixels that lie on an edge (Mack & Oliva 2004).

    An edge is where the gradient of luminance (Sobel, per pixel) exceeds ``threshold``.

    Args:
        picture: (height, width, 3 or 4) sRGB on a plain background.
        threshold: Of the gradient, luminance being 0 to 1.
    """
    luminance = _luminance(picture)
    dy, dx = _sobel(luminance), _sobel(luminance.T).T
    edges = np.hypot(dx, dy) > threshold
    shown = _shown(picture)
    return float(edges[shown].mean()) if shown.any() else 0.0


def subband_entropy(picture: NDArray[np.uint8], levels: int = 3, bins: int = 64) -> float:
    """Mean entropy, in bits, of the luminance's band-pass levels (after Rosenholtz et al. 2007).

    Bands are differences of means over squares of 2, 4, 8, … pixels; a calm picture needs few bits.

    Args:
        picture: (height, width, 3 or 4) sRGB.
        levels: How many bands.
        bins: Of the histogram over -0.5 to 0.5.
    """
    finer = _luminance(picture)
    entropies = []
    for _ in range(levels):
        height, width = (s // 2 * 2 for s in finer.shape)
        finer = finer[:height, :width]
        coarser = finer.reshape(height // 2, 2, width // 2, 2).mean(axis=(1, 3))
        band = finer - np.repeat(np.repeat(coarser, 2, axis=0), 2, axis=1)
        counts = np.histogram(band, bins, (-0.5, 0.5))[0]
        share = counts[counts > 0] / counts.sum()
        entropies.append(float(-(share * np.log2(share)).sum()))
        finer = coarser
    return float(np.mean(entropies))


def _luminance(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    return np.asarray(picture, np.float64)[..., :3] @ [0.2126, 0.7152, 0.0722] / 255


def _shown(picture: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """What differs from the picture's first pixel, the background."""
    rgb = np.asarray(picture)[..., :3].astype(int)
    return (np.abs(rgb - rgb[0, 0]) > 2).any(axis=-1)


def _sobel(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivative along the first axis, per pixel."""
    padded = np.pad(image, 1, mode="edge")
    step = (padded[2:] - padded[:-2]) / 2
    return (step[:, :-2] + 2 * step[:, 1:-1] + step[:, 2:]) / 4
