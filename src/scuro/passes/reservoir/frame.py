"""Reservoirs in the frame: the one call between shading the surfaces and encoding the picture."""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.passes.reservoir.draw import ReservoirPicture
from scuro.passes.reservoir.model import ReservoirModel
from scuro.passes.reservoir.settings import StrategySettings
from scuro.scene.reservoir import ReservoirItem
from scuro.scene.scene import Scene


class Reservoirs:
    """Draws a scene's reservoirs and keeps between frames what did not change."""

    def __init__(self) -> None:
        self._pictures: dict[ReservoirItem, ReservoirPicture] = {}

    def model(self, item: ReservoirItem) -> ReservoirModel:
        """The model on the GPU that was drawn last for an item."""
        return self._pictures[item].drawn

    def bytes(self, item: ReservoirItem, strategy: StrategySettings) -> int:
        """GPU memory of what an item's last picture read; 0 if it was not drawn as a volume."""
        return self._pictures[item].bytes(strategy) if item in self._pictures else 0

    def draw(self, frame: Frame, scene: Scene) -> None:
        """Draw the reservoirs that are shown as volumes over ``color``."""
        for item in self._pictures.keys() - set(scene.reservoirs):
            del self._pictures[item]  # which holds the reservoir, all of a file
        for item in scene.reservoirs:
            if item.show != "volume":
                continue
            if item not in self._pictures:
                self._pictures[item] = ReservoirPicture(frame.gpu, item)
            self._pictures[item].draw(frame, scene, frame.settings.strategy)
