"""The volume's picture drawn larger or smaller than it is shown, and scaled (thesis, Figure 3.17).

Every filter is two small matrices a side: one that samples a continuous kernel, and for O-MOMS the
digital filter that makes the kernel cardinal (Blu, Thévenaz and Unser 2001; Nehab and Hoppe 2014,
"A Fresh Look at Generalized Sampling"). It stands before the samples when scaling up, after them
when scaling down. Beyond the border a picture goes on as its mirror image.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu, Recorder


def _o_moms(x: NDArray) -> NDArray:
    """The cubic of maximal order and minimal support with the least error constant."""
    near = ((x / 2 - 1) * x + 1 / 14) * x + 13 / 21
    far = ((1 - x / 6) * x - 85 / 42) * x + 29 / 21
    return np.where(x < 1, near, np.where(x < 2, far, 0.0))


def _catmull_rom(x: NDArray) -> NDArray:
    near = (1.5 * x - 2.5) * x * x + 1
    far = ((2.5 - 0.5 * x) * x - 4) * x + 2
    return np.where(x < 1, near, np.where(x < 2, far, 0.0))


def _lanczos(x: NDArray) -> NDArray:
    return np.where(x < 3, np.sinc(x) * np.sinc(x / 3), 0.0)


FILTERS: dict[str, tuple[Callable[[NDArray], NDArray], float]] = {
    "o-moms": (_o_moms, 2.0),
    "cubic": (_catmull_rom, 2.0),
    "lanczos": (_lanczos, 3.0),
    "linear": (lambda x: np.maximum(1 - x, 0.0), 1.0),
    "nearest": (lambda x: np.where(x <= 0.5, 1.0, 0.0), 0.5),
}
"""Kernels over the distance in samples, and their radii."""

POLE = (math.sqrt(105) - 13) / 8
"""Of the inverse of the O-MOMS kernel's samples 4/21, 13/21, 4/21."""

CARDINAL_REACH = 8
"""Where that inverse, whose samples shrink by |POLE| each, is cut: 0.02 % of the largest."""


@dataclass(frozen=True, eq=False)
class Banded:
    """A matrix whose rows are short: from ``first[i]`` on, ``weights[i]``."""

    first: NDArray[np.int64]
    weights: NDArray[np.float64]

    def table(self) -> NDArray[np.float32]:
        """(rows, 1 + taps): first index, then weights."""
        return np.column_stack([self.first, self.weights]).astype(np.float32)

    def dense(self, count: int) -> NDArray[np.float64]:
        """The matrix for a line of so many samples, mirrored at its ends."""
        out = np.zeros((len(self.first), count))
        for i, (first, row) in enumerate(zip(self.first, self.weights, strict=True)):
            at = np.mod(first + np.arange(len(row)), 2 * count)
            np.add.at(out[i], np.minimum(at, 2 * count - 1 - at), row)
        return out


def sampling(name: str, before: int, after: int) -> Banded:
    """Samples of the kernel's sum at ``after`` places along a line of ``before``."""
    kernel, radius = FILTERS[name]
    stretch = 1.0 if name == "nearest" else max(1.0, before / after)
    middle = (np.arange(after) + 0.5) * before / after - 0.5
    taps = math.ceil(2 * radius * stretch) + (0 if name == "nearest" else 1)
    first = np.ceil(middle - radius * stretch - 1e-9).astype(np.int64)
    distance = np.abs(middle[:, None] - first[:, None] - np.arange(taps))
    weights = kernel(distance / stretch)
    return Banded(first, weights / weights.sum(axis=1, keepdims=True))


def cardinal(count: int) -> Banded:
    """The digital filter with which O-MOMS interpolates: the inverse of its kernel's samples."""
    reach = np.arange(-CARDINAL_REACH, CARDINAL_REACH + 1)
    row = POLE ** np.abs(reach)
    weights = np.tile(row / row.sum(), (count, 1))
    return Banded(np.arange(count) - CARDINAL_REACH, weights)


def steps(name: str, before: int, after: int) -> list[Banded]:
    """What to do with a line, in order."""
    if name != "o-moms":
        return [sampling(name, before, after)]
    if after >= before:
        return [cardinal(before), sampling(name, before, after)]
    return [sampling(name, before, after), cardinal(after)]


def scaled_size(size: tuple[int, int], scale: float) -> tuple[int, int]:
    """Width and height of a picture drawn at another scale."""
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))


def scaled_view(view: dict[str, Any], ratio: NDArray) -> dict[str, Any]:
    """The ``View`` of the same picture with ``ratio`` times the pixels along x and y."""
    changed = {key: np.asarray(view[key]) * ratio for key in ("size", "origin", "jitter")}
    return {**view, **changed}


class Scaler:
    """Scales pictures of one size to another.

    Args:
        gpu: Where.
        name: One of :data:`FILTERS`.
        before: Width and height of the picture that is given.
        after: Of the picture that is wanted.
    """

    def __init__(
        self, gpu: Gpu, name: str, before: tuple[int, int], after: tuple[int, int]
    ) -> None:
        self.color = gpu.texture(before, "rgba16float", label="unscaled volume")
        self.depth = gpu.texture(before, "r32float", label="unscaled depth")
        across, down = (steps(name, b, a) for b, a in zip(before, after, strict=True))
        # both axes of one step, then those of the next: what is scaled up is small at first
        plan = [(axis, step) for pair in zip(across, down, strict=True)
                for axis, step in enumerate(pair)]  # fmt: skip
        size = list(before)
        self._passes = []
        for i, (axis, step) in enumerate(plan):
            size[axis] = len(step.first)
            last = i == len(plan) - 1
            target = None if last else gpu.texture(tuple(size), "rgba16float", label="scaling")
            table = gpu.texture_from(step.table(), "r32float")
            fields = {"axis": axis, "taps": step.weights.shape[1], "last": int(last)}
            self._passes.append((tuple(size), target, table, fields))

    def scale(self, record: Recorder, color: Any, depth: Any) -> None:
        """Record the scaling of both textures into others of the size wanted."""
        source = self.color
        for size, target, table, fields in self._passes:
            bound = {
                "source": source,
                "result": target or color,
                "weights": table,
                "step": fields,
                "near": self.depth,
                "near_result": depth,
            }
            record.compute("passes/volume/scaling.wgsl", "along", size, bound, label="scaling")
            source = target
