"""How volumes are shown, lit and shadowed."""

from __future__ import annotations

from scuro.errors import SettingsError
from scuro.passes.volume.planes import PlaneSettings
from scuro.passes.volume.scaling import FILTERS
from scuro.settings import SettingsGroup, setting

SLICES = "slices"
"""Directional occlusion by slices, a peer with a picture of its own."""

MONTE_CARLO, PATHS = "monte-carlo", "path"
"""The slow truths: rays through each cone, and light that is scattered many times."""

PEERS = {"voxel-cones": 1, "summed-area": 2, "local-sphere": 3}
"""Methods that Gaussian cones are compared with, and their numbers in peers.wgsl."""


def _split(value: int) -> None:
    if value not in (1, 3, 7):
        raise SettingsError(f"cones split in 1, 3 or 7, not {value}")


class VolumeOcclusionSettings(SettingsGroup):
    """Directional ambient occlusion of volumes by Gaussian cone tracing (Campagnolo 2021)."""

    on: bool = setting(True, "darken what lies behind and between other matter", main=True)
    angle: float = setting(20.0, "half-angle of the cones", low=0.1, high=60, unit="deg")
    length: float = setting(0.5, "length of the cones, in volume diagonals", low=0.01, high=2)
    cones: int = setting(3, "cones after splitting: 1, 3 or 7", check=_split)
    gap: float = setting(3.0, "first sample's distance, in sigmas", low=0.1, high=50)
    attenuation: float = setting(0.35, "global factor on what is met", low=0, high=2)
    correlation: float = setting(
        0.0, "how unlike a cone's rays are: 0 all alike, as in the thesis; 1 suits opaque matter",
        low=0, high=4,
    )  # fmt: skip
    slice_angle: float | None = setting(
        None, "half-angle for 'slices', whose cones are others (default: angle)", low=0.1, high=85,
        unit="deg",
    )  # fmt: skip


class VolumeShadowSettings(SettingsGroup):
    """Shadows in volumes by Gaussian cone tracing toward the lights (Campagnolo 2021)."""

    on: bool = setting(False, "shadows from the lights that cast them", main=True)
    angle: float = setting(0.5, "half-angle of the cones", low=0.01, high=30, unit="deg")
    length: float = setting(0.75, "length of the cones, in volume diagonals", low=0.01, high=2)
    cones: int = setting(1, "cones after splitting: 1, 3 or 7", check=_split)
    gap: float = setting(3.0, "first sample's distance, in sigmas", low=0.1, high=50)
    attenuation: float = setting(1.0, "global factor on what is met", low=0, high=2)
    correlation: float = setting(0.0, "as for occlusion", low=0, high=4)


class VolumePathSettings(SettingsGroup):
    """Volumes path traced, with light that is scattered many times (``--volume-light path``)."""

    bounces: int = setting(64, "times a path may scatter; 1 is direct light", low=1, high=4096)
    anisotropy: float = setting(
        0.0, "mean cosine of the scattering angle: 0 in all directions alike", low=-0.95, high=0.95
    )
    environment: str = setting(
        "constant",
        "ambient light around the volume: equal everywhere, or brighter from above",
        choices=("constant", "gradient"),
    )


class VolumeSettings(SettingsGroup):
    """Scalar volumes: transfer function, ray casting, and where light is worked out."""

    transfer: str = setting(
        "auto",
        "colour and opacity: 'auto', a colormap's name, or a .toml, .tf1d, .json, .xml file "
        "(FILE:PRESET for one of several)",
        main=True,
    )
    opacity: str = setting("", "opacity points that replace the transfer function's: '40:0 90:0.8'")
    window: float | None = setting(None, "width of a window of values, with --level", low=0)
    level: float | None = setting(None, "middle of the window")
    iso: float | None = setting(
        None, "show the surface where values cross this, instead", switch=True
    )
    scale: float = setting(
        1.0,
        "draw the volume so many times larger or smaller and scale its picture",
        low=0.1,
        high=4,
    )
    scale_filter: str = setting(
        "o-moms", "how it is scaled; o-moms is the cardinal cubic one", choices=tuple(FILTERS)
    )
    step: float = setting(0.5, "distance between samples", low=0.05, high=8, unit="voxels")
    jitter: float = setting(1.0, "random shift of rays' starts, in steps", low=0, high=1)
    cutoff: float = setting(0.01, "rays end at this transparency", low=0, high=0.5)
    shading: str = setting("phong", "surface shading by the gradient", choices=("none", "phong"))
    specular: float = setting(0.25, "strength of highlights", low=0, high=2)
    shininess: float = setting(40.0, "exponent of highlights", low=1, high=500)
    light: str = setting(
        "object",
        "occlusion and shadows by Gaussian cones precomputed over the volume (object) or traced at "
        "every sample (image); by Monte Carlo, the slow truth; by paths that scatter many times, "
        "the physical one; or by other published methods",
        choices=("object", "image", MONTE_CARLO, PATHS, SLICES, *PEERS),
    )
    samples: int = setting(
        64, "rays a cone for monte-carlo, paths a pixel for path", low=1, high=65536
    )
    light_resolution: float = setting(
        0.5, "resolution of precomputed light, relative to the volume", low=0.05, high=1
    )
    light_all: bool = setting(False, "precompute light also where no ray of the picture reads it")
    radius: float = setting(8.0, "reach of 'local-sphere'", low=1, high=64, unit="voxels")
    sigma: float = setting(1.0, "deviation of the first Gaussian", low=0.3, high=8, unit="voxels")
    coefficients: int = setting(1, "voxels along each side of a coefficient", low=1, high=8)
    constant_exact: bool = setting(
        False, "weigh cone sections so that uniform matter attenuates exactly (not in the thesis)"
    )
    occlusion: VolumeOcclusionSettings = VolumeOcclusionSettings()
    shadow: VolumeShadowSettings = VolumeShadowSettings()
    planes: PlaneSettings = PlaneSettings()
    path: VolumePathSettings = VolumePathSettings()

    @property
    def sampled(self) -> bool:
        """Whether ``samples`` counts."""
        return self.light in (MONTE_CARLO, PATHS)
