"""Volumes in the frame: the one call between shading the surfaces and encoding the picture."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.passes.compose.lighting import lighting_of, lights_uniform
from scuro.passes.frame import Frame
from scuro.passes.volume.draw import VolumePicture
from scuro.passes.volume.planes import draw_planes
from scuro.passes.volume.settings import VolumeSettings
from scuro.steps import Sharing, finished
from scuro.style.transfer import TransferFunction
from scuro.style.transfer_choose import choose_transfer

if TYPE_CHECKING:
    from scuro.scene.scene import Scene

MOST_SHADOWS = 3
"""Lights that may cast shadows in a volume at once: the channels of its light texture but one."""


class Volumes:
    """Draws a scene's volume and keeps between frames what did not change."""

    def __init__(self) -> None:
        self._picture: VolumePicture | None = None
        self._sharing: Sharing[None] = Sharing()

    def restart(self) -> None:
        """Forget what earlier frames of the same picture gathered."""
        if self._picture is not None:
            self._picture.restart()

    def holds(self, scene: Scene, center: NDArray) -> bool:
        """Whether a frame of the scene, whose origin is there, needs nothing uploaded."""
        if len(scene.volumes) != 1:
            return True  # none, or too many, which drawing says
        return self._has(scene, center) and self._picture is not None and self._picture.filled

    def _has(self, scene: Scene, center: NDArray) -> bool:
        picture = self._picture
        if picture is None or picture.volume is not scene.volumes[0].volume:
            return False
        return bool((picture.center == center).all())

    def _chosen(
        self, frame: Frame, scene: Scene
    ) -> tuple[VolumePicture, VolumeSettings, TransferFunction]:
        """The scene's volume, the settings that hold for it, and its transfer function."""
        if len(scene.volumes) > 1:
            names = ", ".join(item.volume.name for item in scene.volumes)
            raise SettingsError(f"one volume a picture: the scene has {names}")
        item = scene.volumes[0]
        settings = frame.settings.volume
        if frame.settings.shadows.technique != "none":
            settings = settings.replace(shadow__on=True)
        center = frame.accelerator.center
        if not self._has(scene, center):
            self._picture = None  # frees the old one first
            self._picture = VolumePicture(frame.gpu, item.volume, center, filled=False)
        assert self._picture is not None
        transfer = item.shown or choose_transfer(
            item.volume, settings.transfer, settings.opacity, settings.window, settings.level
        )
        return self._picture, settings, transfer

    def prepare(self, frame: Frame, scene: Scene) -> Iterator[float]:
        """Build in slices what :meth:`draw` would build first; yields the share that is done.

        Views of one scene share the work.
        """
        if not scene.volumes:
            return
        picture, settings, transfer = self._chosen(frame, scene)
        if settings.planes.on and settings.planes.alone:
            yield from picture.fill()
            return
        bodies = scene.occluders()
        lighted = settings.occlusion.on or settings.shadow.on
        solids = picture.solids(bodies) if lighted else None
        needed = (settings, transfer, scene.clip, solids)
        yield from self._sharing.steps((picture, *needed), lambda: picture.prepare(*needed))

    def draw(self, frame: Frame, scene: Scene) -> None:
        """Draw the scene's volume, if it has one, over ``color``.

        Raises:
            SettingsError: The scene has several volumes.
        """
        if not scene.volumes:
            self._picture = None
            return
        picture, settings, transfer = self._chosen(frame, scene)
        finished(picture.fill())
        center = frame.accelerator.center
        lighting = lighting_of(frame.settings.lighting, scene.lighting)
        lights = lights_uniform(lighting, frame.camera, center, shadows=settings.shadow.on)
        casting = sum(light["shadow"] >= 0 for light in lights["list"])
        if casting > MOST_SHADOWS:
            raise SettingsError(
                f"at most {MOST_SHADOWS} lights cast shadows in a volume, not {casting}; "
                "turn the shadow of the others off"
            )
        bodies = scene.bodies()
        lighted = settings.occlusion.on or settings.shadow.on
        surface = frame.resources["surface"] if bodies else None
        if settings.planes.on:
            bound = picture.bound(settings, transfer, scene.clip)
            surface = draw_planes(frame, settings.planes, bound, surfaces=bool(bodies))
            if settings.planes.alone:
                return
        common = {
            "view": frame.resources["view"],
            "lights": lights,
            "size": frame.size,
            "clip": scene.clip,
        }
        picture.draw(
            frame.recorder,
            settings,
            transfer,
            color=frame.target("volume_color", "rgba16float"),
            depth=frame.target("volume_depth", "r32float"),
            surface=surface,
            solids=picture.solids(scene.occluders()) if lighted else None,
            breathe=frame.breathe,
            **common,
        )
        on_surfaces = bool(bodies) and lighted
        surface_light = frame.target(
            "surface_light", "r32float", size=frame.size if on_surfaces else (1, 1)
        )
        if on_surfaces:
            picture.light_surfaces(
                frame.recorder,
                settings,
                transfer,
                surface=frame.resources["surface"],
                out=surface_light,
                **common,
            )
        combined = frame.target("combined", "rgba16float")
        frame.compute(
            "passes/volume/over.wgsl",
            {"combined": combined},
            constants={"SURFACES": on_surfaces},
            label="volume over",
        )
        frame.resources["color"] = combined
