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
    frame: Frame, calm: dict[str, Any], name: str, amount: int, frames: int, samples: int
) -> Any:
    """A buffer, averaged and blurred.

    Args:
        frame: With the buffer of this name.
        calm: The surface whose edges the blur keeps.
        name: ``gathered``, ``bounce`` or ``lit``.
        amount: Radius of the blur, pixels.
        frames: See :func:`rested`.
        samples: A pixel and frame.
    """
    if frame.history is not None:
        _average(frame, calm, name, frames)
        left = 1.0 - frames * samples / ENOUGH if frames > 1 else 1.0
        amount = round(amount * math.sqrt(max(left, 0.0)))
    return _blurred(frame, calm, name, amount)


def _average(frame: Frame, calm: dict[str, Any], name: str, frames: int) -> None:
    before, mean = (
        frame.targets.get(f"{name} mean {(frames + k) % 2}", frame.size, "rgba32float")
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


def _blurred(frame: Frame, calm: dict[str, Any], name: str, amount: int) -> Any:
    """A buffer after Algorithm 3, along x and then along y."""
    settings: SemanticSettings = frame.settings.semantic
    source = frame.resources[name]
    if amount == 0:
        return source
    for step, target in (((1, 0), f"{name}_x"), ((0, 1), f"{name}_blurred")):
        blur = {
            "step": step,
            "amount": round(amount * frame.px),
            "depth_limit": depth_limit(frame),
            "normal_limit": settings.blur_normal,
        }
        blurred = frame.target(target, "rgba16float", clear=(0.0, 0.0, 0.0, 0.0))
        frame.compute_tiles(
            "passes/semantic/blur.wgsl",
            calm | {"blur": blur, "source": source, "blurred": blurred},
            label=f"blur {name}",
        )
        source = blurred
    return source
