"""Occlusion and shadows in a reservoir: the cones of volumes, through a regular grid of its matter
(Campagnolo 2021, section 4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.compose.lighting import lighting_of, lights_uniform
from scuro.passes.frame import Frame
from scuro.passes.reservoir.model import ReservoirModel, texture_bytes
from scuro.passes.reservoir.resample import Resampled, cubic_size
from scuro.passes.reservoir.settings import StrategySettings
from scuro.passes.volume.classify import Classified
from scuro.passes.volume.draw import VolumePicture, frozen
from scuro.passes.volume.light import BRICK, LightTexture
from scuro.passes.volume.pyramid import Pyramid
from scuro.passes.volume.settings import VolumeSettings
from scuro.scene.clip import Clip
from scuro.scene.geometry import Body
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

POINTS = 129
"""Opacity points of the grid's transfer function."""


class ReservoirLight:
    """The matter of a model on a regular grid, and the light worked out there.

    Args:
        model: With values in place.
        longest: Voxels along the longest side.
    """

    def __init__(self, model: ReservoirModel, longest: int) -> None:
        self.model = model
        grid = Resampled(model, cubic_size(model, longest))
        values, inside = grid.read()
        # what is outside lies as far below the property's range as the range is wide
        data = np.where(inside, values, -1).astype(np.float32)
        data.flat[0] = -1
        matrix = np.eye(4)
        matrix[:3, :3] = np.diag(grid.voxel)
        matrix[:3, 3] = grid.low + grid.voxel / 2 + model.center
        self.volume = Volume(data, matrix)
        self.picture = VolumePicture(model.gpu, self.volume, model.center)
        self._texture: LightTexture | None = None
        self._made_of: Any = None
        """What the light in the texture depends on."""
        self._pyramid: Pyramid | None = None
        self._marks: Any = None
        self._transfer: tuple[Any, TransferFunction] | None = None

    @property
    def bytes(self) -> int:
        """GPU memory of the samples, the pyramid of coefficients and the light."""
        held = texture_bytes(self.picture.grid.texture)
        held += self._pyramid.bytes if self._pyramid else 0
        return held + (texture_bytes(self._texture.texture) if self._texture else 0)

    def transfer(self, shown: TransferFunction) -> TransferFunction:
        """The same opacities over the grid's values, for one voxel instead of one cell."""
        if self._transfer is None or self._transfer[0] is not shown:
            model = self.model
            share = np.linspace(0, 1, POINTS)
            opacity = shown.opacity(model.low + share * (model.high - model.low))
            per_voxel = -np.expm1(np.log1p(-opacity) * self.picture.grid.voxel / model.unit)
            points = [
                (-1.0, 0.0),
                (-0.02, 0.0),
                *zip(share.tolist(), per_voxel.tolist(), strict=True),
            ]
            made = TransferFunction(((0.0, 1.0, 1.0, 1.0),), tuple(points))
            self._transfer = (shown, made)
            marks = bricks_with(made.opacity(self.volume.values) > 0)
            self._marks = model.gpu.buffer(marks, label="bricks with matter")
        return self._transfer[1]

    def coefficients(
        self, settings: VolumeSettings, shown: TransferFunction, clip: Clip, bodies: Sequence[Body]
    ) -> tuple[Classified, Pyramid]:
        """The grid seen through a transfer function, and its pyramid of extinction coefficients."""
        classified = self.picture.classified(self.transfer(shown), settings)
        solids = self.picture.solids(bodies)
        self._pyramid = self.picture.pyramid(classified, settings, clip, solids)
        return classified, self._pyramid

    def draw(
        self, frame: Frame, scene: Scene, strategy: StrategySettings, shown: TransferFunction,
        clip: Clip,
    ) -> Any:  # fmt: skip
        """Record the light's texture: visibility, and the shadows of three lights.

        Surfaces in the scene stand in the cones' way, too. It is object space's: nothing is made
        anew while neither the lights move nor, for occlusion toward it, the eye.
        """
        settings = light_settings(frame.settings.volume, strategy)
        picture = self.picture
        bodies = scene.occluders()
        view, lights = frame.resources["view"], self._lights(frame, scene, strategy)
        eye = np.asarray(view["scene_from_view"])[:, 2 if view["orthographic"] else 3]
        made_of = (settings, shown, clip, tuple(bodies), frozen(lights) if strategy.shadow else 0,
                   frozen(eye) if strategy.occlusion else 0)  # fmt: skip
        if self._texture is not None and self._made_of == made_of:
            return self._texture.texture
        classified, pyramid = self.coefficients(settings, shown, clip, bodies)
        resources = {
            **classified.resources(),
            "view": view,
            "lights": lights,
            "volume": picture.uniform(settings, clip, classified),
            **picture.cones(settings, pyramid, clip),
        }
        texels = LightTexture.texels_for(picture.grid, settings)
        if self._texture is None or self._texture.texels != texels:
            self._texture = LightTexture(self.model.gpu, texels)
        self._texture.make(
            frame.recorder,
            resources,
            settings,
            frame.size,
            {"ISOSURFACE": False},
            self._marks,
            frame.breathe,
        )
        self._made_of = made_of
        return self._texture.texture

    def draw_on_surfaces(
        self, frame: Frame, scene: Scene, strategy: StrategySettings, shown: TransferFunction,
        clip: Clip,
    ) -> Any:  # fmt: skip
        """Record the share of their light that the model's matter leaves to surfaces."""
        out = frame.target("surface_light", "r32float")
        self.picture.light_surfaces(
            frame.recorder,
            light_settings(frame.settings.volume, strategy),
            self.transfer(shown),
            view=frame.resources["view"],
            lights=self._lights(frame, scene, strategy),
            size=frame.size,
            surface=frame.resources["surface"],
            out=out,
            clip=clip,
        )
        return out

    def _lights(self, frame: Frame, scene: Scene, strategy: StrategySettings) -> dict[str, Any]:
        lighting = lighting_of(frame.settings.lighting, scene.lighting)
        center = self.model.center
        return lights_uniform(lighting, frame.camera, center, shadows=strategy.shadow)


def light_settings(volume: VolumeSettings, strategy: StrategySettings) -> VolumeSettings:
    """Settings of volumes for the grid of a reservoir's matter: all of its light beforehand."""
    return volume.replace(
        light="object",
        light_all=True,
        light_resolution=1.0,
        coefficients=1,
        iso=None,
        occlusion__on=strategy.occlusion,
        shadow__on=strategy.shadow,
    )


def bricks_with(matter: NDArray[np.bool_]) -> NDArray[np.uint32]:
    """1 for each brick of light that samples of the matter read, in the order of illuminate.wgsl.

    Args:
        matter: (nz, ny, nx) where there is any; samples between voxels read those around them.
    """
    counts = [-(-n // BRICK) for n in matter.shape]
    around = np.pad(
        matter, [(1, c * BRICK - n + 1) for c, n in zip(counts, matter.shape, strict=True)]
    )
    for axis in range(3):
        before, after = np.roll(around, 1, axis), np.roll(around, -1, axis)
        around = around | before | after
    inner = around[1:-1, 1:-1, 1:-1]
    shape = [n for count in counts for n in (count, BRICK)]
    return inner.reshape(shape).any(axis=(1, 3, 5)).astype(np.uint32).ravel()


def light_shares(
    frame: Frame, scene: Scene, model: ReservoirModel, strategy: StrategySettings
) -> dict[str, Any]:
    """Fields of ``March``: how visibility and shadows dim a sample; open ones keep their color."""
    if not strategy.shadow:
        return {"light_weights": (1.0, 0.0, 0.0, 0.0), "light_rest": 0.0}
    lighting = lighting_of(frame.settings.lighting, scene.lighting)
    lights = lights_uniform(lighting, frame.camera, model.center, shadows=True)
    strength = np.array([np.mean(light["color"]) for light in lights["list"]])
    ambient = float(np.mean(lights["ambient"]))
    whole = max(ambient + float(strength.sum()), 1e-6)
    weights = np.zeros(4)
    weights[0] = ambient / whole
    for light, power in zip(lights["list"], strength, strict=True):
        if 0 <= light["shadow"] < 3:
            weights[1 + light["shadow"]] = power / whole
    return {"light_weights": weights, "light_rest": 1 - float(weights.sum())}
