"""Transparent objects in the picture: layers, nearest first, each drawn as a picture of its own.

An object counts as one film, drawn where a pixel's ray first meets it. Each layer goes through the
same occlusion, shadow and shading as what is opaque; the layers are then blended from the nearest
to the farthest, so the picture does not depend on the order of objects (depth peeling, Everitt
2001, by rays). Depth cues and buffers know what is opaque only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from scuro.passes.filter.temporal import History
from scuro.passes.frame import Frame, TargetPool
from scuro.passes.geometry.visibility import EMPTY_IDS

MOST_LAYERS = 4
"""Objects behind each other that a pixel shows."""
OPAQUE, TRANSPARENT = 1, 2
"""As in wgsl/opacity.wgsl."""


@contextmanager
def opaque_only(frame: Frame) -> Iterator[None]:
    """Passes in this block meet opaque objects only."""
    if frame.constants["HAS_OPACITY"]:
        frame.constants["PART"] = OPAQUE
    yield
    frame.constants.pop("PART", None)


def no_layer(frame: Frame) -> dict[str, Any]:
    """What stands for the layer before the first."""
    return {
        "layer_surface": frame.targets.get("no layer", (1, 1), "rgba32float"),
        "layer_visible": frame.targets.get("no layer seen", (1, 1), "rgba32uint"),
    }


def see_layer(
    layer: Frame, opaque: Any, before: dict[str, Any], *, part: int, later: bool = False
) -> None:
    """Fill a layer's G-buffer with the nearest surfaces in front of the ``opaque`` one.

    Args:
        layer: A frame with textures of its own.
        opaque: Texture like ``surface``, beyond which nothing is looked for.
        before: ``layer_surface`` and ``layer_visible`` of the layer in front, or :func:`no_layer`.
        part: Which objects: :data:`OPAQUE` or :data:`TRANSPARENT` ones.
        later: Whether there is a layer in front.
    """
    layer.target("visible", "rgba32uint", attachment=True)
    layer.compute_tiles(
        "passes/transparent/layer.wgsl",
        before | {"opaque_surface": opaque},
        constants={"PART": part, "LATER": later},
        label="transparent",
    )
    layer.target("surface", "rgba32float", clear=(0, 0, 0, 0))
    layer.target("albedo", "rgba16float", clear=(0, 0, 0, 0))
    layer.target("ids", "rgba32uint", clear=EMPTY_IDS)
    layer.compute_tiles("passes/geometry/resolve.wgsl", label="transparent")


class Layers:
    """What the layers of earlier frames found."""

    def __init__(self) -> None:
        self._histories: list[History] = []

    def draw(self, frame: Frame, light: Callable[[Frame], None]) -> None:
        """Blend the transparent objects over ``color``.

        Args:
            frame: With the opaque part drawn and shaded.
            light: Makes ``color`` of a frame whose G-buffer is filled.
        """
        count = sum(len(b.positions) for b in frame.accelerator.bodies if b.material.opacity < 1)
        if not count:
            return
        pools = self._pools(frame, min(count, MOST_LAYERS))
        front = frame.target("layers", "rgba16float", clear=(0, 0, 0, 0))
        before = no_layer(frame)
        drawn = frame.targets.frame
        for index, pool in enumerate(pools):
            layer = replace(
                frame, targets=pool, resources=dict(frame.resources),
                constants=dict(frame.constants), history=None,
            )  # fmt: skip
            for name in ("visibility", "shadow"):
                layer.resources.pop(name, None)
            see_layer(layer, frame.resources["surface"], before, part=TRANSPARENT, later=index > 0)
            self._remember(frame, layer, index)
            light(layer)
            if layer.history is not None:
                layer.history.end(layer)
            behind = frame.target(f"layers {index % 2}", "rgba16float", clear=(0, 0, 0, 0))
            layer.compute_tiles(
                "passes/transparent/over.wgsl",
                {"front": front, "replaced": behind},
                label="transparent",
            )
            front = behind
            before = {
                "layer_surface": layer.resources["surface"],
                "layer_visible": layer.resources["visible"],
            }
        frame.targets.frame = drawn
        blended = frame.sparse = frame.target("blended", "rgba16float", clear=(0, 0, 0, 0))
        frame.compute_tiles(
            "passes/transparent/over.wgsl",
            {"front": front, "replaced": blended},
            constants={"LAST": True},
            label="transparent",
        )
        frame.resources["color"] = blended

    def _remember(self, frame: Frame, layer: Frame, index: int) -> None:
        """Let the layer go on from the one of the frame before."""
        if frame.history is not None:
            while len(self._histories) <= index:
                self._histories.append(History())
            layer.history = self._histories[index]
            layer.history.begin(frame.resources["view"], frame.size)

    def _pools(self, frame: Frame, count: int) -> list[TargetPool]:
        """A pool of textures for each layer."""
        return [
            frame.targets.table(f"layer {index}", count, lambda: TargetPool(frame.gpu))
            for index in range(count)
        ]
