"""What every way of drawing a volume is given: the volume, the settings, the picture's rays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from scuro.gpu import Recorder
from scuro.passes.volume.classify import Classified
from scuro.passes.volume.grid import VolumeGrid
from scuro.passes.volume.settings import VolumeSettings


@dataclass(frozen=True)
class March:
    """Rays of one picture through one volume."""

    record: Recorder
    settings: VolumeSettings
    classified: Classified
    size: tuple[int, int]
    """Width and height of the picture, or of its part."""
    resources: Mapping[str, Any]
    """What lit.wgsl, march.wgsl and, where there is light, illumination.wgsl want bound."""
    constants: Mapping[str, Any]
    """Theirs."""
    key: Any = None
    """Everything that the picture depends on but the number of samples."""

    @property
    def grid(self) -> VolumeGrid:
        """The volume on the GPU."""
        return self.classified.grid

    @property
    def spacing(self) -> float:
        """Distance of samples along a ray, in scene units."""
        return self.settings.step * self.grid.voxel

    def with_(
        self,
        resources: Mapping[str, Any] | None = None,
        constants: Mapping[str, Any] | None = None,
    ) -> March:
        """The same with further resources and constants."""
        return replace(
            self,
            resources={**self.resources, **(resources or {})},
            constants={**self.constants, **(constants or {})},
        )

    def compute(
        self,
        shader: str,
        entry: str,
        resources: Mapping[str, Any],
        *,
        constants: Mapping[str, Any] | None = None,
        size: tuple[int, int] | None = None,
        label: str,
    ) -> None:
        """Record a pass over the picture, with further resources and constants."""
        more = self.with_(resources, constants)
        self.record.compute(
            shader, entry, size or self.size, more.resources, more.constants, label=label
        )
