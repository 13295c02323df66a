"""Context: surroundings of what matters, in simple light (Easdon 2013, section 5.4).

What is shown as context is left out of the scene that techniques see: it neither occludes nor
casts shadows in any of them, and theirs cost nothing for it. It is drawn by itself, shaded by the
lights alone, and put into the frame where it is nearer.
Later passes (transparent layers, volumes, depth cues, picking) take it for what it is: a surface.
"""

from __future__ import annotations

from dataclasses import replace

from scuro.passes.compose.shade import shade
from scuro.passes.frame import Frame, TargetPool
from scuro.passes.geometry.tiles import find_tiles
from scuro.passes.geometry.visibility import draw_visibility
from scuro.passes.transparent.layers import Layers, opaque_only
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
    with opaque_only(context):
        draw_visibility(context)
    shade(context)
    frame.context = context
    find_tiles(frame, name="all_tile")
    smooth = frame.settings.renderer == "path"
    if smooth:
        # what shows through the edges of a path-traced picture lies under it
        under = {"front": frame.resources["color"], "color": context.resources["color"]}
        frame.replace_color(
            "passes/transparent/over.wgsl", under, tiles=True, constants={"LAST": True}
        )
    _put(frame, context, smooth)
    _draw_layers(frame, context)


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
