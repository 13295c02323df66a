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
from scuro.passes.semantic.levels import depth_limit
from scuro.passes.semantic.settings import SemanticSettings

ENOUGH = 512
"""So many samples need no blur."""
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
    amounts = [
        settings.blur_occlusion,
        settings.blur_bounce * bounce,
        settings.blur_shadow * shadow,
    ]
    if frame.history is not None:
        for name, there in (("gathered", True), ("bounce", bounce), ("lit", shadow)):
            if there:
                _average(frame, calm, name, frames)
        left = 1.0 - frames * samples / ENOUGH if frames > 1 else 1.0
        amounts = [round(amount * math.sqrt(max(left, 0.0))) for amount in amounts]
    return _blurred(frame, calm, [round(a * frame.px) for a in amounts], bounce, shadow)


def _average(frame: Frame, calm: dict[str, Any], name: str, frames: int) -> None:
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
        label=f"average {name}",
    )
    frame.resources[name] = mean


def _blurred(
    frame: Frame, calm: dict[str, Any], amounts: list[int], bounce: bool, shadow: bool
) -> dict[str, Any]:
    """The buffers after Algorithm 3, along x and then along y.

    ``amounts``: radii of occlusion, bounce and shadow, pixels.
    """
    light, beside = taps(*amounts[:1]), taps(*amounts[1:])
    blur = {
        "light_taps": len(light),
        "beside_taps": len(beside),
        "depth_limit": depth_limit(frame),
        "normal_limit": frame.settings.semantic.blur_normal,
        "light": light or _NOTHING,
        "beside": beside or _NOTHING,
    }
    found = {name: frame.resources[name] for name in ("gathered", "bounce")}
    for step, suffix in (((1, 0), "x"), ((0, 1), "blurred")):
        before = found
        found = {
            name: frame.target(f"{name}_{suffix}", "rgba16float", clear=(0.0, 0.0, 0.0, 0.0))
            for name in (before if bounce or shadow else ("gathered",))
        }
        frame.compute_tiles(
            "passes/semantic/blur.wgsl",
            calm
            | {
                "blur": blur | {"step": step},
                "source": before["gathered"],
                "source_beside": before["bounce"],
                "blurred": found["gathered"],
                "blurred_beside": found.get("bounce", found["gathered"]),
            },
            constants={
                "HAS_BOUNCE": bounce,
                "HAS_SHADOW": shadow,
                "SHADOW_APART": suffix == "x",
            },
        )
        found = {"bounce": before["bounce"]} | found
    return found


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
