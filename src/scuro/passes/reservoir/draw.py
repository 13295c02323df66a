"""One reservoir's volume picture, kept between frames piece by piece while unchanged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.passes.frame import Frame
from scuro.passes.reservoir.light import ReservoirLight, light_shares
from scuro.passes.reservoir.model import ENTRIES, ReservoirModel, texture_bytes
from scuro.passes.reservoir.resample import Resampled, resampled_size
from scuro.passes.reservoir.settings import StrategySettings
from scuro.scene.clip import MAX_PLANES, Clip
from scuro.scene.reservoir import ReservoirItem
from scuro.scene.scene import Scene
from scuro.style.reservoir import item_transfer, property_range

MOST_CELLS = 20_000
"""Cells and searches after which a ray ends, whatever the geometry."""


class ReservoirPicture:
    """Everything of one reservoir that outlives a frame.

    Args:
        gpu: Where to.
        item: The reservoir; its settings may change, its grid not.
    """

    def __init__(self, gpu: Gpu, item: ReservoirItem) -> None:
        self.gpu, self.item = gpu, item
        self._kept: dict[str, tuple[Any, Any]] = {}

    def _keep(self, name: str, key: Any, make: Callable[[], Any]) -> Any:
        """What was made last under ``name`` if its key is the same, else a new one."""
        kept = self._kept.get(name)
        if kept is None or kept[0] != key:
            self._kept.pop(name, None)
            self._kept[name] = kept = (key, make())
        return kept[1]

    def model(self, center: NDArray, strategy: StrategySettings) -> ReservoirModel:
        """The model with the item's property, time step, filters and transfer function in place."""
        item = self.item
        place = (tuple(center), item.exaggeration)
        model = self._keep(
            "model", place, lambda: ReservoirModel(self.gpu, item.grid, center, item.exaggeration)
        )
        settings = item.settings
        name = item.shown_property
        step = item.grid.step_index(settings.time) if item.grid.changes(name) else 0
        values_key = (place, name, step, settings.low, settings.high, settings.box)
        low, high = property_range(item.grid, name)
        self._keep(
            "values",
            values_key,
            lambda: model.set_values(item.values(), low, high, item.chosen()),
        )
        transfer = item_transfer(item)
        self._keep(
            "transfer",
            (place, name, transfer, strategy.step),
            lambda: model.set_transfer(transfer, strategy.step * model.unit),
        )
        return model

    @property
    def drawn(self) -> ReservoirModel:
        """The model that was drawn last."""
        model: ReservoirModel = self._kept["model"][1]
        return model

    def bytes(self, strategy: StrategySettings) -> int:
        """GPU memory of what a strategy reads: cells, samples of a grid, light."""
        held = self.drawn.bytes
        if strategy.technique == "srg" and "resampled" in self._kept:
            held += texture_bytes(self._kept["resampled"][1])
        if (strategy.occlusion or strategy.shadow) and "light" in self._kept:
            held += self._kept["light"][1].bytes
        return held

    def march(self, model: ReservoirModel, strategy: StrategySettings, clip: Clip) -> dict:
        """The ``March`` uniform."""
        planes = np.zeros((MAX_PLANES, 4))
        equations = clip.equations()
        planes[: len(equations)] = equations
        planes[:, 3] += planes[:, :3] @ model.center
        low, high = model.bounds
        return {
            "planes": planes,
            "plane_count": len(equations),
            "step": strategy.step * model.unit,
            "cutoff": strategy.cutoff,
            "table_end": ENTRIES - 1,
            "light_low": low,
            "most_cells": MOST_CELLS,
            "light_scale": 1 / np.maximum(high - low, 1e-9),
            "unit": model.unit,
            "light_weights": (1.0, 0.0, 0.0, 0.0),
            "light_rest": 0.0,
        }

    def draw(self, frame: Frame, scene: Scene, strategy: StrategySettings) -> None:
        """Record the volume over ``color``, up to the depths of ``surface``."""
        if frame.settings.shadows.technique != "none":
            strategy = strategy.replace(shadow=True)
        model = self.model(frame.accelerator.center, strategy)
        march = self.march(model, strategy, scene.clip.cutting)
        resources = {
            **model.resources,
            "colors": model.colors,
            "volume_color": frame.target("volume_color", "rgba16float"),
            "light": self._keep("no light", 0, self._no_light),
            "trilinear_sampler": self.gpu.linear_sampler,
        }
        lit = strategy.occlusion or strategy.shadow
        on_surfaces = lit and bool(scene.bodies())
        if lit:
            light = self._keep(
                "light",
                (self._kept["values"][0], strategy.light_resolution),
                lambda: ReservoirLight(model, strategy.light_resolution),
            )
            how = (frame, scene, strategy, item_transfer(self.item), scene.clip.cutting)
            resources["light"] = light.draw(*how)
            if on_surfaces:
                light.draw_on_surfaces(*how)
            march |= light_shares(frame, scene, model, strategy)
        if strategy.technique == "srg":
            resources["resampled"] = self._keep(
                "resampled",
                (self._kept["values"][0], strategy.resample),
                lambda: Resampled(model, resampled_size(model, strategy.resample)).texture(),
            )
        frame.compute(
            f"passes/reservoir/{strategy.technique}.wgsl",
            {**resources, "march": march},
            constants={"PREINTEGRATED": strategy.fast, "LIT": lit},
            label="reservoir",
        )
        combined = frame.targets.get("combined with reservoir", frame.size, "rgba16float")
        if not on_surfaces:
            frame.target("surface_light", "r32float", size=(1, 1))
        frame.compute(
            "passes/volume/over.wgsl",
            {"combined": combined},
            constants={"SURFACES": on_surfaces},
            label="reservoir over",
        )
        frame.resources["color"] = combined

    def _no_light(self) -> Any:
        return self.gpu.texture((1, 1, 1), "rgba16float", dimension="3d")
