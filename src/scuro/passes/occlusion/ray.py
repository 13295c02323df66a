"""``ray``: cosine-weighted hemisphere rays through the tracer (Easdon 2013, section 4.2)."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.filter.temporal import settle
from scuro.passes.frame import Frame
from scuro.trace.table import float_table

PATTERN = 4
"""Edge of the square of interleaved pixel classes; the filters are sized to average over it."""

DEFAULT_SAMPLES = 4
UNFILTERED = 64
"""So many samples need no smoothing."""


def draw(frame: Frame) -> None:
    """Fill ``visibility``."""
    settings = frame.settings.occlusion
    samples = settings.samples or DEFAULT_SAMPLES
    filtered = settings.filter != "none" and (settings.filter != "auto" or samples < UNFILTERED)
    trace_visibility(frame, "visibility", samples, settings.distance, interleaved=filtered)
    settle(
        frame, "visibility", occlusion_key(frame), samples,
        kind=settings.filter if filtered else "none", enough=UNFILTERED,
    )  # fmt: skip


def occlusion_key(frame: Frame) -> Any:
    """Everything but the camera that visibility depends on."""
    planes = np.asarray(frame.resources["scene"]["planes"]).tobytes()
    return (frame.accelerator, planes, frame.settings.occlusion, frame.settings.seed)


def trace_visibility(
    frame: Frame,
    name: str,
    samples: int,
    distance: float | None,
    *,
    interleaved: bool,
) -> None:
    """Trace ``samples`` rays a pixel into the texture ``name``.

    Args:
        frame: With ``surface`` filled.
        name: Target; half the frame's size if the settings ask for half resolution.
        samples: Rays a pixel.
        distance: Length of the rays, world units; unlimited if ``None``.
        interleaved: Share directions within classes of pixels (coherent, to be filtered), or give
            each pixel a sequence of its own.
    """
    half = frame.settings.occlusion.resolution == "half"
    width, height = frame.size
    index = int(frame.resources["view"]["frame"])
    target = frame.target(
        name,
        "r32float",
        size=((width + 1) // 2, (height + 1) // 2) if half else None,
        clear=(1, 1, 1, 1),
    )
    frame.compute_tiles(
        "passes/occlusion/ray.wgsl",
        {
            "rays": {
                "samples": samples,
                "distance": distance or 3e38,
                "offset": index % 4,
            },
            "directions": direction_table(frame, samples if interleaved else 1, index),
            "result": target,
        },
        entry="half" if half else "main",
        constants={"PATTERN": PATTERN if interleaved else 0, **fan_constants(frame, samples)},
        label="occlusion",
    )


def fan_constants(frame: Frame, samples: int) -> dict[str, float]:
    """Constants of wgsl/trace_fan.wgsl for so many rays from each point."""
    has = frame.constants
    local = not (has["HAS_TOP_LEVEL"] or has["CLIPPED"])
    plain = local and not (has["HAS_RODS"] or has["HAS_TRIANGLES"])
    return {
        "LOCAL": local,
        # measured: below four rays it costs more than it saves
        "FIRST_CELL_AT_ONCE": plain and samples >= 4,
        "ROUND": 4 * min(4, -(-samples // 4)),
    }


def direction_table(frame: Frame, samples: int, index: int) -> object:
    """The table of :func:`class_directions` for a frame."""
    key = (samples, index, frame.settings.seed)
    return frame.targets.table(
        "directions", key, lambda: float_table(frame.gpu, class_directions(*key), "directions")
    )


def class_directions(samples: int, frame: int, seed: int) -> NDArray[np.float32]:
    """Points of the unit sphere (PATTERN² · samples, 4): a run of ``samples`` for each pixel class.

    All classes together are one spherical Fibonacci set, which is what a filter over a square of
    classes averages; each class takes every PATTERN²-th point of it, well spread by itself. Each
    frame turns the whole by a rotation of its own, so that frames average to the exact mean.
    """
    classes = PATTERN * PATTERN
    points = fibonacci_sphere(samples * classes).reshape(samples, classes, 3)
    # neighbours in the picture get runs that start far apart
    order = np.argsort(_bit_reversed(np.arange(classes)))
    turned = points[:, order].transpose(1, 0, 2).reshape(-1, 3) @ _rotation(frame, seed).T
    return np.concatenate([turned, np.zeros((len(turned), 1))], axis=1).astype(np.float32)


@lru_cache(maxsize=8)
def fibonacci_sphere(count: int) -> NDArray[np.float64]:
    """(count, 3) spherical Fibonacci points."""
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    angle = 2 * np.pi * np.modf(i * (np.sqrt(5) - 1) / 2)[0]
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)


def _bit_reversed(values: NDArray) -> NDArray:
    """Of four bits."""
    bits = [((values >> k) & 1) << (3 - k) for k in range(4)]
    return np.sum(bits, axis=0)


def _rotation(frame: int, seed: int) -> NDArray[np.float64]:
    """(3, 3) rotation of a frame: uniform over all, low-discrepancy over frames (Shoemake 1992)."""
    start = np.random.default_rng(seed).random(3)
    steps = np.array([0.8191725134, 0.6710436067, 0.5497004779])  # R3 sequence (Roberts 2018)
    u, v, w = np.modf(start + frame * steps)[0]
    a, b = np.sqrt(1 - u), np.sqrt(u)
    x, y = a * np.sin(2 * np.pi * v), a * np.cos(2 * np.pi * v)
    z, q = b * np.sin(2 * np.pi * w), b * np.cos(2 * np.pi * w)
    from scuro.scene.geometry import rotation_matrices

    return rotation_matrices(np.array([[x, y, z, q]]))[0]
