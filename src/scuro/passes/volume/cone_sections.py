"""Where the samples of a cone lie, and their weights (Campagnolo 2021, 3.2 and appendix A)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SPACING = 2.5
"""Distance between samples, in standard deviations."""

LIMIT = 2.0
"""r_c: a section wider than so many deviations splits the cone or climbs a level."""

THREE_RADIUS, THREE_OFFSET = 2 * math.sqrt(3) - 3, 4 - 2 * math.sqrt(3)
"""Three circles packed in a unit circle: their radius, and their distance from its middle."""

SEVEN_RADIUS, SEVEN_OFFSET = 1 / 3, 2 / 3
"""Seven circles packed in a unit circle: one in the middle, six around it."""

MAX_SECTIONS = 128


@dataclass(frozen=True)
class ConeSections:
    """The samples along a cone, in mean voxel edges."""

    table: NDArray[np.float32]
    """(n, 4): distance to the next sample, pyramid level, A_tau, weight h_I of equation A-1."""
    counts: tuple[int, int, int]
    """How many samples are taken with one, with three and with seven cones."""
    starts: tuple[float, float, float]
    """Distances from the apex of the first sample of each kind."""
    tangent: float
    """Of the whole cone's half-angle."""

    @property
    def parts(self) -> int:
        """1, 4 or 11: the whole cone, its three parts, and their seven."""
        return 11 if self.counts[2] else 4 if self.counts[1] else 1


def cone_sections(
    half_angle: float,
    length: float,
    *,
    sigma: float = 1.0,
    gap: float = 3.0,
    most_cones: int = 7,
    levels: int = 32,
    constant_exact: bool = False,
) -> ConeSections:
    """Place samples along a cone.

    Args:
        half_angle: Aperture θ in degrees.
        length: L in mean voxel edges.
        sigma: σ of the pyramid's first level, in mean voxel edges.
        gap: h₀, in units of ``sigma``.
        most_cones: C_split: 1, 3 or 7.
        levels: Levels of the pyramid; σ grows no further than the last one's.
        constant_exact: Take each section's mean instead of the truncated Gaussian's integral, so
            that a uniform medium attenuates as it should (not in the thesis).
    """
    tangent = math.tan(math.radians(half_angle))
    ratios = {1: 1.0, 3: THREE_RADIUS, 7: SEVEN_RADIUS}
    cones, level, distance = 1, 0, gap * sigma
    rows: list[tuple[float, float]] = []  # sigma, radius
    counts = {1: 0, 3: 0, 7: 0}
    while distance < gap * sigma + length and len(rows) < MAX_SECTIONS:
        while distance * tangent * ratios[cones] > LIMIT * sigma * 2**level:
            if cones < most_cones:
                cones = 3 if cones == 1 else 7
            elif level < levels - 1:
                level += 1
                # a wider sample stands farther from the one before it
                distance += SPACING / 2 * sigma * 2 ** (level - 1) if rows else 0.0
            else:
                break
        rows.append((sigma * 2**level, distance * tangent * ratios[cones]))
        counts[cones] += 1
        distance += SPACING * sigma * 2**level
    deviations, radii = np.array(rows).T
    following = np.append(deviations[1:], deviations[-1:])
    before = np.append(deviations[:1], deviations[:-1])
    half = SPACING / 2
    weight = half * (before + deviations) / 2
    weight[0] = 0.5 * deviations[0] * math.sqrt(2 * math.pi)
    amplitude = np.ones(len(rows)) if constant_exact else section_amplitude(radii, deviations)
    table = np.stack(
        [half * (deviations + following), np.log2(deviations / sigma), amplitude, weight], 1
    )
    places = gap * sigma + np.concatenate([[0.0], np.cumsum(table[:, 0])])
    first3 = counts[1]
    first7 = counts[1] + counts[3]
    return ConeSections(
        table.astype(np.float32),
        (counts[1], counts[3], counts[7]),
        (float(places[0]), float(places[first3]), float(places[first7])),
        tangent,
    )


def section_amplitude(radius: NDArray, sigma: NDArray) -> NDArray[np.float64]:
    """A_tau of equation 3-15: the Gaussian's integral over a disc's square, by the disc's area.

    p_r is the share of a one-dimensional Gaussian within ±r; towards r = 0 the ratio tends to 4/π.
    """
    radius, sigma = np.asarray(radius, float), np.asarray(sigma, float)
    ratio = np.maximum(radius / sigma, 1e-4)
    share = np.array([math.erf(x / math.sqrt(2)) for x in ratio.ravel()]).reshape(ratio.shape)
    return share**2 * 2 / ratio**2
