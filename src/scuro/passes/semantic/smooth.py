"""What the noisy buffers of the pipeline end with: the mean over a resting camera's frames, a blur.

The thesis names the reuse of samples as future work. Halton points go on from frame to frame, so
that n frames of k samples are one frame of n k samples: exact, and blurred the less the more there
are. A moving camera starts anew: the light that is gathered comes from lamps that move with it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from scuro.passes.frame import Frame
from scuro.passes.semantic.levels import edges_uniform
from scuro.passes.semantic.settings import SemanticSettings

ENOUGH = 512
"""So many samples need no blur."""
THIN = 2
"""Bounce and shadow are found in one of so many pixels along either side (seen.wgsl)."""
_NOTHING = [(0.0, 0.0, 0.0, 0.0)]
WIDE = 5
"""Radius from which on a blur takes one pixel in two; one in three from twice this."""


def rested(frame: Frame) -> int:
    """Frames, this one counted, since the camera rests and nothing changed; 1 without reuse."""
    history = frame.history
    if history is None:
        return 1
    scene = np.asarray(frame.resources["scene"]["planes"]).tobytes()
    lamps = repr(frame.resources["lights"])
    key = (frame.accelerator, frame.settings, scene, lamps, frame.size)
    began = frame.targets.table("semantic frames", key, lambda: history.number)
    return max(1, min(history.frames, history.number - began + 1))


def smoothed(
    frame: Frame,
    calm: dict[str, Any],
    frames: int,
    samples: int,
    *,
    bounce: bool,
    shadow: bool,
) -> dict[str, Any]:
    """``gathered`` and ``bounce``, averaged and blurred; the alpha of the latter is the shadow.

    Args:
        frame: With the buffers ``gathered``, ``bounce`` and ``lit``.
        calm: The surface whose edges the blur keeps.
        frames: See :func:`rested`.
        samples: A pixel and frame.
        bounce: Whether there is any.
        shadow: Whether there is any.
    """
    settings: SemanticSettings = frame.settings.semantic
    left = 1.0
    if frame.history is not None:
        _average(frame, calm, "gathered", frames)
        if bounce:
            _average(frame, calm, "bounce", frames, "thinly")
        if shadow:
            _average(frame, calm, "lit", frames)
        left = math.sqrt(max(1.0 - frames * samples / ENOUGH, 0.0)) if frames > 1 else 1.0

    def radius(amount: float, apart: int = 1) -> int:
        """In pixels so far apart."""
        return math.ceil(round(round(left * amount) * frame.px) / apart)

    light = taps(radius(settings.blur_occlusion))
    found = {"gathered": _blurred(frame, calm, "gathered", light)}
    if bounce or shadow:
        shadows = radius(settings.blur_shadow, THIN) if shadow else 0
        thin = taps(radius(settings.blur_bounce, THIN) if bounce else 0, shadows)
        found["bounce"] = _blurred(frame, calm, "bounce", thin, "thinly", shadow=shadow)
    return found


def _average(
    frame: Frame, calm: dict[str, Any], name: str, frames: int, entry: str = "main"
) -> None:
    before, mean = (
        frame.targets.get(
            f"{name} mean {(frames + k) % 2}", frame.size, "rgba32float", lasting=True
        )
        for k in (1, 0)
    )
    frame.compute_tiles(
        "passes/semantic/average.wgsl",
        calm
        | {
            "averaging": {"share": 1.0 / frames},
            "source": frame.resources[name],
            "mean_before": before,
            "mean": mean,
        },
        entry=entry,
        label=f"average {name}",
    )
    frame.resources[name] = mean


def _blurred(
    frame: Frame,
    calm: dict[str, Any],
    name: str,
    weights: list[tuple[float, ...]],
    entry: str = "main",
    *,
    shadow: bool = False,
) -> Any:
    """A buffer after Algorithm 3, along x and then along y; ``shadow``: with ``lit`` as alpha."""
    blur = edges_uniform(frame) | {"taps": len(weights), "weights": weights or _NOTHING}
    source = frame.resources[name]
    for step, suffix in (((1, 0), "x"), ((0, 1), "blurred")):
        blurred = frame.target(f"{name}_{suffix}", "rgba16float", clear=(0.0, 0.0, 0.0, 0.0))
        frame.compute_tiles(
            "passes/semantic/blur.wgsl",
            calm | {"blur": blur | {"step": step}, "source": source, "blurred": blurred},
            entry=entry,
            constants={"HAS_SHADOW": shadow, "SHADOW_APART": suffix == "x"},
        )
        source = blurred
    return source


def taps(*amounts: int) -> list[tuple[float, ...]]:
    """Distances in pixels of what a blur takes on either side, with the weight for each radius.

    Radii of five pixels and more leave out every second pixel, of ten two in three, and so on: no
    radius takes more than five.
    """
    weights: dict[int, list[float]] = {}
    for which, amount in enumerate(amounts):
        for i in range(1, amount + 1, 1 + amount // WIDE):
            weights.setdefault(i, [0.0] * 3)[which] = math.exp(-((i / (1.5 * amount)) ** 2))
    return [(float(i), *weights[i]) for i in sorted(weights)]
