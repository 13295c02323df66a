"""Edge-aware smoothing of a noisy one-channel picture; also brings half resolution to full.

What is smoothed is the picture itself or its *ratio* to a guide without noise, such as a closed
form of the near surroundings: what both know of a crease is divided out and stays sharp.
"""

from __future__ import annotations

import math
from typing import Any

from scuro.passes.frame import Frame

_SHADER = "passes/filter/smooth.wgsl"
_LEVELS = 3
"""Of the à-trous transform: 5, 13 and 29 pixels wide."""
_MARGIN = 2.0
"""Values of n rays count as distinct beyond 1 / (√n - margin): of 16, four deviations of their
noise; of up to four, whose noise is as large as what they tell apart, never."""
TOLERANCE = 0.8
"""Distance from the tangent plane, in typical radii, at which weights have fallen to a half."""


def smooth(
    frame: Frame,
    name: str,
    kind: str = "auto",
    *,
    radius: int = 6,
    guide: Any = None,
    samples: float = 1.0,
) -> None:
    """Replace the texture ``name`` by its smoothed form at full resolution.

    Args:
        frame: With ``surface`` filled.
        name: A one-channel texture, full or half resolution; values below 0 are unknown.
        kind: ``bilateral`` (also ``auto``): separable cross-bilateral, depth and normal aware;
            ``atrous``: edge-avoiding à-trous wavelets (Dammertz et al. 2010), three levels;
            ``none``: only to full resolution.
        radius: Of the bilateral kernel, in pixels.
        guide: A one-channel texture at full resolution; the ratio to it is smoothed.
        samples: Behind each value: the more there are, the less alike pixels are averaged.
    """
    source = frame.resources[name]
    half = tuple(source.size[:2]) != tuple(frame.size)
    size = source.size[:2]
    passes: list[tuple[str, int]] = []
    if kind == "atrous":
        passes = [("atrous", 1 << level) for level in range(_LEVELS)]
    elif kind != "none":
        reach = max(1, radius // 2) if half else radius
        passes = [("across", reach), ("down", reach)]
    if half:
        passes = [(f"half_{entry}", reach) for entry, reach in passes] or [("half_across", 0)]
        passes.append(("upsample", 1))
    if not passes:
        return
    result = frame.target(f"{name}_smooth", "r32float", clear=(1, 1, 1, 1))
    # a texture is either read or written within a pass: stand-ins take the other's place
    read, written, unwritten = (
        frame.targets.get(f"smooth_{what}", (1, 1), format)
        for what, format in (("read", "rg32float"), ("pair", "rg32float"), ("value", "r32float"))
    )
    pairs = read
    for index, (entry, reach) in enumerate(passes):
        last = index == len(passes) - 1
        target = frame.targets.get(f"smooth_{'ab'[index % 2]}", size, "rg32float")
        frame.compute_tiles(
            _SHADER,
            {
                "smooth_settings": {
                    "reach": reach,
                    "offset": int(frame.resources["view"]["frame"]) % 4,
                    "tolerance": TOLERANCE,
                    "selective": 0.5 * math.sqrt(samples),
                    "distinct": 0.0 if guide else max(0.0, math.sqrt(samples) - _MARGIN),
                },
                "source": source,
                "guide": source if guide is None else guide,
                "pairs": pairs,
                "smoothed": written if last else target,
                "result": result if last else unwritten,
            },
            entry=entry,
            constants={
                "BLOCK": 2 if half else 1,
                "GUIDED": guide is not None,
                "FIRST": index == 0,
                "LAST": last,
            },
            label="filter",
        )
        pairs = target
    frame.resources[name] = result
