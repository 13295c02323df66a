"""One volume's picture: space skipping, pyramid, light and ray casting, kept while unchanged."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu, Recorder
from scuro.passes.volume.classify import Classified
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.image_space import draw_cones, state_bytes
from scuro.passes.volume.light import LightTexture, cone_kinds, light_constants
from scuro.passes.volume.pyramid import Pyramid
from scuro.passes.volume.scaling import Scaler, scaled_size, scaled_view
from scuro.passes.volume.settings import MONTE_CARLO, PATHS, PEERS, SLICES, VolumeSettings
from scuro.passes.volume.slices import SliceBuffers, draw_slices
from scuro.passes.volume.solids import solid_fraction, texels_for
from scuro.passes.volume.summed import summed_table
from scuro.reference.volume_cones import draw_monte_carlo
from scuro.reference.volume_path import draw_paths
from scuro.reference.volume_sums import RunningSums
from scuro.scene.clip import Clip
from scuro.scene.geometry import Body
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

SLICE_BYTES = 4 << 20
"""Of the pyramid's slabs where it is built in slices."""


@dataclass
class VolumePicture:
    """Everything of one volume that outlives a frame.

    Built on first use and rebuilt piece by piece as its inputs change: the grid with the data, the
    classification with the transfer function, the pyramid with both and the clipping.
    """

    gpu: Gpu
    volume: Volume
    center: NDArray

    def __post_init__(self) -> None:
        self.grid = VolumeGrid(self.gpu, self.volume, self.center)
        self._kept: dict[str, tuple[Any, Any]] = {}
        self.restart()

    def restart(self) -> None:
        """Forget what earlier frames of the same picture gathered."""
        self._sums = RunningSums(self.gpu)

    def _keep(self, name: str, key: Any, make: Any) -> Any:
        """The value made last under ``name`` if its key is the same, else a new one."""
        kept = self._kept.get(name)
        if kept is None or kept[0] != key:
            self._kept.pop(name, None)  # free the old one before making the new one
            self._kept[name] = kept = (key, make())
        return kept[1]

    def classified(self, transfer: TransferFunction, settings: VolumeSettings) -> Classified:
        """Tables and empty space of a transfer function."""
        key = (transfer, settings.step, settings.iso)
        return self._keep(
            "classified", key, lambda: Classified(self.grid, transfer, settings.step, settings.iso)
        )

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
        return self._keep(
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
    ) -> Iterator[float]:
        """Build in slices the pyramid that a picture will need; yields the share that is done."""
        if settings.light == "monte-carlo" or not (settings.occlusion.on or settings.shadow.on):
            return
        classified = self.classified(transfer, settings)
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
            summed = self._keep(
                "summed",
                (classified, clip),
                lambda: summed_table(classified, self.uniform(settings, clip, classified)),
            )
        else:
            summed = self._keep("not summed", 0, lambda: self.gpu.buffer(16))
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
        return self._keep(
            "solids",
            tuple(bodies),
            lambda: self.gpu.texture_from(
                solid_fraction(bodies, matrix, size), "r16float", dimension="3d"
            ),
        )

    def light_surfaces(
        self,
        record: Recorder,
        settings: VolumeSettings,
        transfer: TransferFunction,
        *,
        view: dict[str, Any],
        lights: dict[str, Any],
        size: tuple[int, int],
        surface: Any,
        out: Any,
        clip: Clip,
    ) -> None:
        """Record how much light the volume's matter leaves to each pixel's surface.

        Args:
            surface: The G-buffer's ``surface`` texture.
            out: r32float texture, 1 where nothing is taken; see :meth:`draw` for the others.
        """
        classified = self.classified(transfer, settings)
        pyramid = self.pyramid(classified, settings, clip)
        record.compute(
            "passes/volume/on_surfaces.wgsl",
            "main",
            size,
            {
                **classified.resources(),
                **self.cones(settings, pyramid, clip),
                "volume": self.uniform(settings, clip, classified),
                "view": view,
                "lights": lights,
                "surface": surface,
                "surface_light": out,
            },
            light_constants(settings),
            label="volume on surfaces",
        )

    def draw(
        self,
        record: Recorder,
        settings: VolumeSettings,
        transfer: TransferFunction,
        *,
        view: dict[str, Any],
        lights: dict[str, Any],
        size: tuple[int, int],
        color: Any,
        depth: Any,
        clip: Clip | None = None,
        surface: Any = None,
        solids: Any = None,
    ) -> None:
        """Record the volume's picture.

        Args:
            record: Where to.
            settings: How.
            transfer: Colour and opacity.
            view: The ``View`` uniform.
            lights: The ``Lights`` uniform; layers 0 to 2 cast shadows.
            size: Width and height of the picture (or tile).
            color: rgba16float texture for premultiplied linear colour and opacity.
            depth: r32float texture for the depth of half the opacity.
            clip: Half-spaces to keep.
            surface: The G-buffer's ``surface`` texture, whose depths stop rays.
            solids: Texture that is 1 where surfaces fill space, for cones to see them.
        """
        clip = clip or Clip()
        full = size
        if settings.scale != 1.0:
            size = scaled_size(full, settings.scale)
            view = scaled_view(view, np.array(size) / full)
            key = (settings.scale_filter, size, full)
            scaler = self._keep("scaler", key, lambda: Scaler(self.gpu, *key))
        resources = {
            "view": view,
            "lights": lights,
            "march": {"width": size[0], "height": size[1],
                      "surface_scale": np.array(full) / size},
            "surface": surface or self._keep("no surface", 0, self._no_surface),
            "volume_color": color if size == full else scaler.color,
            "volume_depth": depth if size == full else scaler.depth,
        }  # fmt: skip
        self._draw(record, settings, transfer, resources, clip, surface is not None, solids)
        if size != full:
            scaler.scale(record, color, depth)

    def _draw(
        self,
        record: Recorder,
        settings: VolumeSettings,
        transfer: TransferFunction,
        resources: dict[str, Any],
        clip: Clip,
        surfaces: bool,
        solids: Any,
    ) -> None:
        """Record the picture by the method that the settings choose."""
        march = resources["march"]
        size = march["width"], march["height"]
        classified = self.classified(transfer, settings)
        lighted = settings.occlusion.on or settings.shadow.on
        resources = {
            **resources,
            **classified.resources(),
            "volume": self.uniform(settings, clip, classified),
            "march": march
            | {
                "cutoff": settings.cutoff,
                "jitter": settings.jitter,
                "iso": classified.iso or 0.0,
            },
            "shading": {
                "diffuse": 1.0,
                "specular": settings.specular,
                "shininess": settings.shininess,
                "flat": 0.02,
            },
            "illuminated": self._keep("no light", 0, self._no_light),
        }
        constants = {
            "ISOSURFACE": settings.iso is not None,
            "SURFACES": surfaces,
            "PHONG": settings.shading == "phong",
            "SHADOWED": settings.shadow.on,
        }
        same = (
            settings.replace(samples=1), transfer, clip, solids, resources["surface"],
            _frozen(resources["view"]), _frozen(resources["lights"]),
        )  # fmt: skip
        if settings.light == PATHS:
            draw_paths(record, resources, constants, classified, settings, size, self._sums, same)
            return
        if lighted and settings.light == MONTE_CARLO:
            constants |= light_constants(settings) | {"HAS_SOLIDS": solids is not None}
            resources["solids"] = solids or self.grid.texture
            draw_monte_carlo(
                record, resources, constants, self.grid, settings, size, self._sums, same
            )
            return
        if lighted:
            pyramid = self.pyramid(classified, settings, clip, solids)
            resources |= self.cones(settings, pyramid, clip)
        if settings.occlusion.on and settings.light == SLICES:
            buffers = self._keep("slices", size, lambda: SliceBuffers(self.gpu, size))
            constants |= light_constants(settings) | {"OCCLUSION": False}
            draw_slices(record, resources, constants, self.grid, settings, size, buffers)
            return
        if lighted and settings.light == "image":
            bytes_ = state_bytes(size)
            state = self._keep("pieces", bytes_, lambda: self.gpu.buffer(bytes_, label="pieces"))
            constants |= light_constants(settings)
            draw_cones(record, resources, constants, self.grid, settings, state)
            return
        if lighted:
            texels = LightTexture.texels_for(self.grid, settings)
            light = self._keep("light", texels, lambda: LightTexture(self.gpu, texels))
            light.make(record, resources, settings, size, constants)
            resources["illuminated"] = light.texture
        record.compute(
            "passes/volume/raycast.wgsl",
            "main",
            size,
            resources,
            {**constants, "ILLUMINATED": lighted},
            label="volume",
        )

    def _no_surface(self) -> Any:
        return self.gpu.texture((1, 1), "rgba32float")

    def _no_light(self) -> Any:
        return self.gpu.texture((1, 1, 1), "rgba16float", dimension="3d")


def _frozen(value: Any) -> Any:
    """A uniform's fields as something that can be compared."""
    if isinstance(value, Mapping):
        return tuple((key, _frozen(part)) for key, part in value.items())
    if isinstance(value, list):
        return tuple(map(_frozen, value))
    return np.asarray(value).tobytes()
