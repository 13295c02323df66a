"""What one volume's pictures need first: tables, pyramid, solids; each kept while unchanged."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.passes.volume.classify import Classified
from scuro.passes.volume.grid import UPLOAD_BYTES, VolumeGrid
from scuro.passes.volume.light import cone_kinds
from scuro.passes.volume.pyramid import Pyramid
from scuro.passes.volume.settings import PEERS, VolumeSettings
from scuro.passes.volume.solids import solid_fraction, texels_for
from scuro.passes.volume.summed import summed_table
from scuro.scene.clip import Clip
from scuro.scene.geometry import Body
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

SLICE_BYTES = 2 << 20
"""Of slabs of the grid and the pyramid where they are built in slices."""


@dataclass
class BuiltVolume:
    """What is made of one volume before a picture and outlives it.

    Built on first use and rebuilt piece by piece as its inputs change: the grid with the data, the
    classification with the transfer function, the pyramid with both and the clipping.
    """

    gpu: Gpu
    volume: Volume
    center: NDArray
    filled: bool = True
    """Whether the grid is there, or has to be uploaded by :meth:`fill` or :meth:`prepare`."""

    def __post_init__(self) -> None:
        self.grid = VolumeGrid(self.gpu, self.volume, self.center, self.filled)
        self._kept: dict[str, tuple[Any, Any]] = {}

    def fill(self, slab: int = UPLOAD_BYTES) -> Generator[float, None, None]:
        """Upload the grid if it is not there, roughly so many bytes at a time."""
        if not self.filled:
            for share in self.grid.fill(slab):
                self.gpu.finish()
                yield share
            self.filled = True

    def keep(self, name: str, key: Any, make: Any) -> Any:
        """The value made last under ``name`` if its key is the same, else a new one."""
        kept = self._kept.get(name)
        if kept is None or kept[0] != key:
            self._kept.pop(name, None)  # free the old one before making the new one
            self._kept[name] = kept = (key, make())
        return kept[1]

    def classified(self, transfer: TransferFunction, settings: VolumeSettings) -> Classified:
        """Tables and empty space of a transfer function."""
        key = (transfer, settings.iso)
        return self.keep("classified", key, lambda: Classified(self.grid, transfer, settings.iso))

    def uniform(self, settings: VolumeSettings, clip: Clip, classified: Classified) -> dict:
        """The ``Volume`` uniform."""
        return self.grid.uniform(settings.step, clip, self.center, classified.table_end)

    def bound(
        self, settings: VolumeSettings, transfer: TransferFunction, clip: Clip
    ) -> dict[str, Any]:
        """What volume.wgsl wants bound."""
        classified = self.classified(transfer, settings)
        uniform = self.uniform(settings, clip, classified)
        return {**classified.resources(), "volume": uniform}

    def pyramid(
        self, classified: Classified, settings: VolumeSettings, clip: Clip, solids: Any = None
    ) -> Pyramid:
        """The extinction pyramid for the current transfer function and clipping."""
        name, key = self._pyramid_key(classified, settings, clip, solids)
        return self.keep(
            name, key, lambda: self._new_pyramid(classified, settings, clip, solids, True)
        )

    @staticmethod
    def _pyramid_key(
        classified: Classified, settings: VolumeSettings, clip: Clip, solids: Any
    ) -> tuple[str, Any]:
        boxes = settings.light in PEERS
        key = (classified, settings.sigma, settings.coefficients, clip, solids, boxes)
        return "pyramid" if solids is None else "pyramid with solids", key

    def _new_pyramid(
        self,
        classified: Classified,
        settings: VolumeSettings,
        clip: Clip,
        solids: Any,
        build: bool,
    ) -> Pyramid:
        return Pyramid(
            classified,
            self.uniform(settings, clip, classified),
            sigma=settings.sigma,
            factor=settings.coefficients,
            solids=solids,
            boxes=settings.light in PEERS,
            build=build,
        )

    def prepare(
        self, settings: VolumeSettings, transfer: TransferFunction, clip: Clip, solids: Any
    ) -> Generator[float, None, None]:
        """Build in slices what a picture will need; yields the share that is done."""
        yield from self.fill(SLICE_BYTES)
        classified = self.classified(transfer, settings)
        if not classified.ready:
            _ = classified.distances
            self.gpu.finish()
            yield 0.0
        if settings.light == "monte-carlo" or not (settings.occlusion.on or settings.shadow.on):
            return
        name, key = self._pyramid_key(classified, settings, clip, solids)
        if self._kept.get(name, (None,))[0] == key:
            return
        pyramid = self._new_pyramid(classified, settings, clip, solids, False)
        for share in pyramid.build(SLICE_BYTES):
            self.gpu.finish()
            yield share
        self._kept[name] = (key, pyramid)

    def cones(self, settings: VolumeSettings, pyramid: Pyramid, clip: Clip) -> dict[str, Any]:
        """What cone.wgsl and peers.wgsl want bound besides the volume."""
        classified = pyramid.classified
        if settings.light == "summed-area":
            summed = self.keep(
                "summed",
                (classified, clip),
                lambda: summed_table(classified, self.uniform(settings, clip, classified)),
            )
        else:
            summed = self.keep("not summed", 0, lambda: self.gpu.buffer(16))
        return {
            "pyramid": pyramid.texture,
            "cones": {"kinds": cone_kinds(self.grid, pyramid, settings)},
            "summed": summed,
        }

    def solids(self, bodies: Sequence[Body]) -> Any:
        """A texture over the volume that is 1 where surfaces fill space; None without surfaces."""
        if not bodies:
            return None
        size = texels_for(self.grid.size)
        world_from_scene = np.eye(4)
        world_from_scene[:3, 3] = -np.asarray(self.center)
        matrix = self.grid.texture_from_scene @ world_from_scene
        return self.keep(
            "solids",
            tuple(bodies),
            lambda: self.gpu.texture_from(
                solid_fraction(bodies, matrix, size), "r16float", dimension="3d"
            ),
        )
