"""Context: surroundings of what matters, in simple light (Easdon 2013, section 5.4).

What is shown as context is left out of the scene that techniques see: it neither occludes nor
casts shadows in any of them, and theirs cost nothing for it. It is drawn by itself, shaded by the
lights alone, and put into the frame where it is nearer.
Later passes (transparent layers, volumes, depth cues, picking) take it for what it is: a surface.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scuro.passes.compose.shade import shade
from scuro.passes.frame import Frame
from scuro.passes.geometry.tiles import find_tiles
from scuro.passes.geometry.visibility import draw_visibility
from scuro.passes.targets import TargetPool
from scuro.passes.transparent.layers import Layers, opaque_only
from scuro.reference.path import path_key
from scuro.scene.clip import Clip
from scuro.trace import Accelerator


def draw_context(frame: Frame, accelerator: Accelerator, clip: Clip) -> None:
    """Draw bodies in simple light into ``color`` and the G-buffer.

    ``visibility`` and ``shadow`` become 1 where they show. Transparent ones follow as layers,
    behind those of the scene.

    Args:
        frame: With all else that is opaque drawn and shaded.
        accelerator: Of the bodies, about the same centre as the frame's.
        clip: What cuts those that are clipped.
    """
    context = _begun(frame, accelerator, clip)
    _draw(context)
    frame.context = context
    find_tiles(frame, name="all_tile")
    smooth = frame.settings.renderer == "path"
    if smooth:
        _blend(frame, context)
    _put(frame, context, smooth)
    _draw_layers(frame, context)


def _draw(context: Frame) -> None:
    """G-buffer and ``color`` of what is opaque."""
    with opaque_only(context):
        draw_visibility(context)
    shade(context)


def _begun(frame: Frame, accelerator: Accelerator, clip: Clip) -> Frame:
    """A frame of the context alone, with the same view and lights."""
    resources, constants = accelerator.clipped(clip)
    shared = {name: frame.resources[name] for name in ("view", "lights")}
    height = int(shared["view"]["size"][1])
    scene = resources["scene"] | accelerator.detail_for(frame.camera, height, frame.settings.detail)
    return replace(
        frame,
        accelerator=accelerator,
        targets=frame.targets.table("context", 0, lambda: TargetPool(frame.gpu)),
        resources=resources | shared | {"scene": scene},
        constants=constants | {"LOCAL_LIGHTS": frame.constants["LOCAL_LIGHTS"]},
        history=None,
        sparse=None,
    )


MOST_MEANS = 16
"""Frames of the context that a path-traced picture shows the mean of, at most."""


def _blend(frame: Frame, context: Frame) -> None:
    """Put the mean of frames of the context, each shifted within the pixels, into ``color``.

    There are no more than paths a pixel; like these, they are kept for the frames that go on.
    """
    paths = frame.settings.path
    count = min(paths.samples, MOST_MEANS) if paths.antialias else 1
    pool = frame.targets.table("shifted context", 0, lambda: TargetPool(frame.gpu))
    width, height = frame.size
    sums = frame.targets.buffer("context_sums", 32 * width * height)
    done = frame.targets.table("context means", (path_key(frame), context.accelerator, sums), list)
    if len(done) > count:
        done.clear()
    for index in range(len(done), count):
        shifted = _shifted(context, pool, index) if index else context
        frame.compute_tiles(
            "passes/compose/context_sums.wgsl",
            {
                "means": {"index": index},
                "context_sums": sums,
                "context_surface": shifted.resources["surface"],
                "context_color": shifted.resources["color"],
            },
            label="context",
        )
        frame.recorder.flush()  # drawing may be broken off
        done.append(index)
    frame.replace_color(
        "passes/compose/context_mean.wgsl",
        {"means": {"count": len(done)}, "context_sums": sums},
        tiles=True,
    )


def _shifted(context: Frame, pool: TargetPool, index: int) -> Frame:
    """The context from the next place within the pixels."""
    view = context.resources["view"]
    # well spread, the first in the middle (Roberts 2018, with the plastic number)
    shift = np.modf(0.5 + index * np.array([0.7548776662, 0.5698402910]))[0] - 0.5
    view = view | {"jitter": tuple(np.add(view["jitter"], shift).tolist())}
    shifted = replace(context, targets=pool, resources=context.resources | {"view": view})
    _draw(shifted)
    return shifted


def _put(frame: Frame, context: Frame, smooth: bool) -> None:
    """Put the context into the frame, at whose pixels it is nearer than all else."""
    behind = frame.resources
    white = context.target("white", "r32float", size=(1, 1))
    context.compute_tiles(
        "passes/compose/context_light.wgsl",
        {
            "scene_surface": behind["surface"],
            "nearer": context.target("nearer", "r32float"),
            "over_color": behind["color"],
            "visibility": behind.get("visibility") or white,
            "shadow": behind.get("shadow") or white,
        },
        constants={
            "SMOOTH": smooth,
            "HAS_OCCLUSION": "visibility" in behind,
            "HAS_SHADOWS": "shadow" in behind,
        },
        label="context",
    )
    first = len(frame.accelerator.bodies)
    frame.constants["CONTEXT_FROM"] = first
    context.compute_tiles(
        "passes/compose/context_surface.wgsl",
        {
            "numbers": {"object": first, "instance": frame.accelerator.instances},
            **{f"over_{name}": behind[name] for name in ("surface", "albedo", "ids")},
        },
        label="context",
    )


def _draw_layers(frame: Frame, context: Frame) -> None:
    """Blend what is transparent of the context over ``color``."""
    names = ("surface", "color", "tile_count", "tile_list")
    films = replace(
        context, resources=context.resources | {name: frame.resources[name] for name in names}
    )
    Layers().draw(films, shade)
    frame.resources["color"] = films.resources["color"]
