"""A transfer function from the histogram alone, to show something sensible on first sight."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.kept import kept_with
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction, from_colormap

LABEL_COLORS = "tab20"
DENSE = 0.6
"""Opacity of one voxel well inside what is shown."""

LEAST_ABOVE = 0.985
"""At least the values above this quantile are shown."""

CONTOUR = 0.12
"""How soft the surface of a density map is, as a share of its height over the background."""

WARM = (
    (0.0, 0.55, 0.27, 0.18),
    (0.35, 0.85, 0.58, 0.40),
    (0.7, 0.96, 0.86, 0.68),
    (1.0, 1.0, 0.98, 0.93),
)
"""Shares of the shown range and their sRGB colours: clay to ivory."""


@kept_with
def automatic(volume: Volume) -> TransferFunction:
    """Choose by what the values look like: labels, Hounsfield units, signed fields, or a density.

    - Labels: a colour each; the most frequent label is the background, and clear.
    - Hounsfield units (integers from air at -1000 to bone): skin faint, bone dense.
    - A signed field with its mode near zero (potentials, difference maps): both signs, two colours.
    - A density map whose matter is darker than what surrounds it (cryo-tomograms): the low values.
    - Anything else: Otsu's threshold between background and object; denser above it.
    """
    low, high = volume.value_range
    if high <= low:
        return from_colormap("gray", (low - 0.5, high + 0.5), [(low, 0.0)])
    if volume.labels:
        return _labels(volume)
    if volume.values.dtype.kind == "i" and low <= -900 and high >= 900:
        return _hounsfield()
    mode, spread = _background(volume)
    if (
        low < 0 < high
        and volume.value_name != "density"  # maps of density have noise of both signs
        and abs(mode) < 0.1 * (high - low)
        and min(-low, high) > 0.3 * max(-low, high)
    ):
        return _signed(volume)
    if volume.dark_matter:
        return _dark_matter(volume)
    return _density(volume, mode, spread)


def otsu(histogram: NDArray, low: float, high: float) -> float:
    """The value that splits a histogram into two classes of least variance within (Otsu 1979)."""
    centers = low + (np.arange(len(histogram)) + 0.5) * (high - low) / len(histogram)
    weight = histogram.astype(float)
    below = np.cumsum(weight)
    above = below[-1] - below
    sums = np.cumsum(weight * centers)
    with np.errstate(invalid="ignore", divide="ignore"):
        gap = sums / below - (sums[-1] - sums) / above
        between = np.nan_to_num(below * above * gap * gap)
    return float(centers[int(np.argmax(between))])


def _background(volume: Volume) -> tuple[float, float]:
    """The histogram's mode and a robust spread about it, taken from the side without object."""
    low, high = volume.value_range
    step = (high - low) / 256
    mode = low + (int(np.argmax(volume.histogram)) + 0.5) * step
    sample = volume.values[::2, ::2, ::2].astype(np.float64)
    beneath = mode - sample[sample <= mode]
    return mode, float(np.median(beneath)) * 1.4826 if beneath.size else step


def _labels(volume: Volume) -> TransferFunction:
    import cmap

    values, counts = np.unique(volume.values, return_counts=True)
    background = values[0] if values[0] <= 0 else values[int(np.argmax(counts))]
    palette = cmap.Colormap(LABEL_COLORS)
    colors, opacities = [], []
    for i, value in enumerate(values.tolist()):
        rgb = tuple(map(float, np.asarray(palette(i % 20))[:3]))
        colors.append((float(value), *rgb))
        opacities.append((float(value), 0.0 if value == background else 0.9))
    return TransferFunction(tuple(colors), tuple(opacities), stepped=True, name="labels")  # type: ignore[arg-type]


def _hounsfield() -> TransferFunction:
    colors = (
        (-1000.0, 0.3, 0.15, 0.1),
        (-150.0, 0.75, 0.5, 0.4),
        (80.0, 0.85, 0.55, 0.45),
        (220.0, 0.95, 0.85, 0.7),
        (1500.0, 1.0, 1.0, 0.95),
    )
    opacities = ((-300.0, 0.0), (-100.0, 0.01), (80.0, 0.015), (180.0, 0.05), (400.0, 0.7))
    return TransferFunction(colors, opacities, name="Hounsfield")


def _signed(volume: Volume) -> TransferFunction:
    extent = float(np.quantile(np.abs(volume.values[::2, ::2, ::2]), 0.995)) or 1.0
    points = [(-extent, 0.5), (-extent / 3, 0.0), (extent / 3, 0.0), (extent, 0.5)]
    return from_colormap("matplotlib:coolwarm", (-extent, extent), points)


def _density(volume: Volume, mode: float, spread: float) -> TransferFunction:
    low, high = volume.value_range
    maps = volume.value_name == "density"
    threshold = otsu(volume.histogram, low, high)
    if spread > (high - low) / 200:
        # a noisy background around a small object pulls Otsu's threshold down into the noise
        threshold = max(threshold, mode + 4 * spread)
    if volume.contour is not None:
        threshold = volume.contour
    # whatever the histogram looks like, a first sight of nothing helps nobody
    threshold = min(threshold, float(np.quantile(volume.values[::2, ::2, ::2], LEAST_ABOVE)))
    inside = volume.values[::2, ::2, ::2]
    inside = inside[inside > threshold]
    top = float(np.quantile(inside, 0.98)) if inside.size else high
    top = max(top, threshold + 0.05 * (high - low))
    # a map's surface is a contour, as its users know it; other matter begins softly
    ramp = CONTOUR * (threshold - mode) if maps else 0.15 * (top - threshold)
    start = threshold - ramp
    if start < mode + 3 * spread:
        start = min(mode + 3 * spread, threshold)
    full = threshold + ramp
    span = top - start
    colors = tuple((start + place * span, *rgb) for place, *rgb in WARM)
    opacities = ((start, 0.0), (full, DENSE if maps else 0.35 * DENSE), (max(top, full), DENSE))
    return TransferFunction(colors, opacities, name="density")  # type: ignore[arg-type]


def _dark_matter(volume: Volume) -> TransferFunction:
    values = volume.values[::2, ::2, ::2]
    low = volume.value_range[0]
    darkest, full, start = (float(q) for q in np.quantile(values, (0.001, 0.02, 0.05)))
    start = max(start, full + 1e-6 * (volume.value_range[1] - low))
    span = start - darkest
    colors = tuple((start - place * span, *rgb) for place, *rgb in reversed(WARM))
    opacities = ((low, DENSE), (full, DENSE), (start, 0.0))
    return TransferFunction(colors, opacities, name="dark matter")  # type: ignore[arg-type]
