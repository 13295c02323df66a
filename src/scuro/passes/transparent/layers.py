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

from scuro.passes.filter.temporal import History
from scuro.passes.frame import Frame
from scuro.passes.geometry.visibility import EMPTY_IDS
from scuro.passes.targets import TargetPool

MOST_LAYERS = 4
"""Objects behind each other that a pixel shows."""
_OPAQUE, _TRANSPARENT = 1, 2
"""As in wgsl/opacity.wgsl."""


@contextmanager
def opaque_only(frame: Frame) -> Iterator[None]:
    """Passes in this block meet opaque objects only."""
    if frame.constants["HAS_OPACITY"]:
        frame.constants["PART"] = _OPAQUE
    yield
    frame.constants.pop("PART", None)


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
            self._histories.clear()
            return
        pools = self._pools(frame, min(count, MOST_LAYERS))
        front = frame.target("layers", "rgba16float", clear=(0, 0, 0, 0))
        before = {
            "layer_surface": frame.targets.get("no layer", (1, 1), "rgba32float"),
            "layer_visible": frame.targets.get("no layer seen", (1, 1), "rgba32uint"),
        }
        drawn = frame.targets.frame
        for index, pool in enumerate(pools):
            layer = replace(
                frame, targets=pool, resources=dict(frame.resources),
                constants=dict(frame.constants), history=None,
            )  # fmt: skip
            for name in ("visibility", "shadow"):
                layer.resources.pop(name, None)
            self._see(frame, layer, before, index)
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

    def _see(self, frame: Frame, layer: Frame, before: dict, index: int) -> None:
        """Fill the layer's G-buffer."""
        layer.target("visible", "rgba32uint", attachment=True)
        layer.compute_tiles(
            "passes/transparent/layer.wgsl",
            before | {"opaque_surface": frame.resources["surface"]},
            constants={"PART": _TRANSPARENT, "LATER": index > 0},
            label="transparent",
        )
        layer.target("surface", "rgba32float", clear=(0, 0, 0, 0))
        layer.target("albedo", "rgba16float", clear=(0, 0, 0, 0))
        layer.target("ids", "rgba32uint", clear=EMPTY_IDS)
        layer.compute_tiles("passes/geometry/resolve.wgsl", label="transparent")
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
