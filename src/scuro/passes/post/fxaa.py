"""Anti-aliasing of the finished picture: FXAA (Lottes 2009).

Pixels that stand out are listed first, then smoothed: a software adapter would make all others wait
for them. Where no pass comes between, what is smoothed goes straight into the encoded picture.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from scuro.passes.frame import Frame
from scuro.style.paint import premultiplied


def asked_for(frame: Frame) -> bool:
    """Whether the picture shall still be smoothed by FXAA."""
    return bool(frame.settings.antialias.method == "fxaa") and not frame.smoothed


def brightness_of(frame: Frame, wanted: bool = True) -> dict[str, Any]:
    """What brightness.wgsl wants bound, to store what FXAA compares beside ``color``."""
    background = premultiplied(frame.settings.background)
    red, green, blue, _ = background
    empty = math.sqrt(0.8 * red + 0.15 * green + 0.05 * blue)
    if wanted:
        target = frame.target("brightness", "r32float", clear=(empty, 0, 0, 0))
    else:
        target = frame.targets.get("no brightness", (1, 1), "r32float")
    return {"encode": {"background": background}, "brightness": target}


def draw_fxaa(frame: Frame) -> None:
    """Smooth the jagged edges of ``color``, for passes that follow."""
    if asked_for(frame):
        list_edges(frame)
        _smooth(frame)
        frame.resources["color"] = frame.resources["replaced"]


def smooth_picture(frame: Frame) -> None:
    """Smooth the jagged edges of ``picture``; ``color`` keeps them: see :func:`smoothed_color`."""
    if not asked_for(frame):
        return
    list_edges(frame)
    frame.compute(
        "passes/post/fxaa_picture.wgsl",
        {
            "nearest": frame.gpu.nearest_sampler,
            "encode": {"background": premultiplied(frame.settings.background)},
        },
        indirect=frame.resources["edge_count"],
        label="fxaa",
    )


def smoothed_color(frame: Frame) -> Any:
    """The light that ``picture`` of a finished frame was encoded from."""
    joined = frame.settings.stereo.mode == "red-cyan"  # of eyes that were smoothed before
    if not asked_for(frame) or joined:
        return frame.resources["color"]
    frame.recorder = frame.gpu.recorder()
    _smooth(frame)
    frame.recorder.submit()
    return frame.resources["replaced"]


def list_edges(frame: Frame) -> None:
    """Fill ``edge_list`` and ``edge_count``."""
    color = frame.resources["color"]
    if "brightness" not in frame.resources:
        frame.compute_shown("passes/post/fxaa_luma.wgsl", brightness_of(frame), label="fxaa")
    width, height = color.size[:2]
    frame.scratch("edge_list", 4 * width * height)
    count = frame.scratch("edge_count", 16, indirect=True)
    frame.gpu.write_buffer(count, np.array([0, 1, 1, 0], np.uint32))
    frame.compute_shown(
        "passes/post/fxaa_edges.wgsl",
        {"nearest": frame.gpu.nearest_sampler},
        threads=(-(-width // 2), -(-height // 4)),
        label="fxaa",
    )


def _smooth(frame: Frame) -> None:
    """Make ``replaced``, a smoothed copy of ``color``."""
    color = frame.resources["color"]
    replaced = frame.target("replaced", "rgba16float", size=color.size[:2])
    frame.recorder.copy_texture(color, replaced)
    frame.compute(
        "passes/post/fxaa.wgsl",
        {"nearest": frame.gpu.nearest_sampler},
        indirect=frame.resources["edge_count"],
        label="fxaa",
    )
