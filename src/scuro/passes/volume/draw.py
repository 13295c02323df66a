"""One volume's picture: its light and its rays, by the method that the settings choose."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu, Recorder
from scuro.passes.volume.built import BuiltVolume
from scuro.passes.volume.image_space import draw_cones, state_bytes
from scuro.passes.volume.light import LightTexture, light_constants
from scuro.passes.volume.march import March
from scuro.passes.volume.scaling import Scaler, scaled_size, scaled_view
from scuro.passes.volume.settings import MONTE_CARLO, PATHS, SLICES, VolumeSettings
from scuro.passes.volume.slices import SliceBuffers, draw_slices
from scuro.reference.volume_cones import draw_monte_carlo
from scuro.reference.volume_path import draw_paths
from scuro.reference.volume_sums import RunningSums
from scuro.scene.clip import Clip
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction


class VolumePicture(BuiltVolume):
    """Pictures of one volume, and what outlives a frame."""

    def __init__(self, gpu: Gpu, volume: Volume, center: NDArray, filled: bool = True) -> None:
        super().__init__(gpu, volume, center, filled)
        self.restart()

    def restart(self) -> None:
        """Forget what earlier frames of the same picture gathered."""
        self._sums = RunningSums(self.gpu)

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
            light_constants(settings) | {"LIGHT_COUNT": lights["count"]},
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
        breathe: Callable[[float], None] | None = None,
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
            breathe: See :meth:`LightTexture.make`.
        """
        clip = clip or Clip()
        full = size
        if settings.scale != 1.0:
            size = scaled_size(full, settings.scale)
            view = scaled_view(view, np.array(size) / full)
            key = (settings.scale_filter, size, full)
            scaler = self.keep("scaler", key, lambda: Scaler(self.gpu, *key))
        surfaces = surface is not None
        resources = {
            "view": view,
            "lights": lights,
            "march": {"width": size[0], "height": size[1],
                      "surface_scale": np.array(full) / size},
            "surface": surface or self.keep("no surface", 0, self._no_surface),
            "volume_color": color if size == full else scaler.color,
            "volume_depth": depth if size == full else scaler.depth,
        }  # fmt: skip
        march = self._march(record, settings, transfer, resources, size, clip, surfaces, solids)
        self._draw(march, clip, solids, breathe)
        if size != full:
            scaler.scale(record, color, depth)

    def _march(
        self,
        record: Recorder,
        settings: VolumeSettings,
        transfer: TransferFunction,
        resources: dict[str, Any],
        size: tuple[int, int],
        clip: Clip,
        surfaces: bool,
        solids: Any,
    ) -> March:
        """The picture's rays, without light."""
        classified = self.classified(transfer, settings)
        resources = {
            **resources,
            **classified.resources(),
            "volume": self.uniform(settings, clip, classified),
            "march": resources["march"]
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
            "illuminated": self.keep("no light", 0, self._no_light),
        }
        constants = {
            "ISOSURFACE": settings.iso is not None,
            "LABELS": self.volume.labels,
            "SURFACES": surfaces,
            "PHONG": settings.shading == "phong",
            "SHADOWED": settings.shadow.on,
            "LIGHT_COUNT": resources["lights"]["count"],
        }
        same = (
            settings.replace(samples=1), transfer, clip, solids, resources["surface"],
            frozen(resources["view"]), frozen(resources["lights"]),
        )  # fmt: skip
        return March(record, settings, classified, size, resources, constants, same)

    def _draw(
        self, march: March, clip: Clip, solids: Any, breathe: Callable[[float], None] | None
    ) -> None:
        """Record the picture by the method that the settings choose."""
        settings, size = march.settings, march.size
        lighted = settings.occlusion.on or settings.shadow.on
        if settings.light == PATHS:
            draw_paths(march, self._sums)
            return
        if lighted and settings.light == MONTE_CARLO:
            seen = {"HAS_SOLIDS": solids is not None, **light_constants(settings)}
            bound = {"solids": solids or self.grid.texture}
            draw_monte_carlo(march.with_(bound, seen), self._sums)
            return
        if lighted:
            pyramid = self.pyramid(march.classified, settings, clip, solids)
            march = march.with_(self.cones(settings, pyramid, clip))
        if settings.occlusion.on and settings.light == SLICES:
            buffers = self.keep("slices", size, lambda: SliceBuffers(self.gpu, size))
            draw_slices(
                march.with_(constants={**light_constants(settings), "OCCLUSION": False}), buffers
            )
            return
        if lighted and settings.light == "image":
            bytes_ = state_bytes(size)
            state = self.keep("pieces", bytes_, lambda: self.gpu.buffer(bytes_, label="pieces"))
            draw_cones(march.with_(constants=light_constants(settings)), state)
            return
        if lighted:
            texels = LightTexture.texels_for(self.grid, settings)
            light = self.keep("light", texels, lambda: LightTexture(self.gpu, texels))
            light.make(
                march.record, march.resources, settings, size, march.constants, breathe=breathe
            )
            march = march.with_({"illuminated": light.texture})
        march.compute(
            "passes/volume/raycast.wgsl",
            "main",
            {},
            constants={"ILLUMINATED": lighted},
            label="volume",
        )

    def _no_surface(self) -> Any:
        return self.gpu.texture((1, 1), "rgba32float")

    def _no_light(self) -> Any:
        return self.gpu.texture((1, 1, 1), "rgba16float", dimension="3d")


def frozen(value: Any) -> Any:
    """A uniform's fields as something that can be compared."""
    if isinstance(value, Mapping):
        return tuple((key, frozen(part)) for key, part in value.items())
    if isinstance(value, list):
        return tuple(map(frozen, value))
    return np.asarray(value).tobytes()
