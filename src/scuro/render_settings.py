"""All settings of a picture, gathered from the passes that own them."""

from __future__ import annotations

from scuro.passes.compose.lighting import LightingSettings
from scuro.passes.occlusion.occlusion import OcclusionSettings
from scuro.passes.post.annotations import (
    AxesSettings,
    LabelSettings,
    LegendSettings,
    ScaleBarSettings,
)
from scuro.passes.post.antialias import AntialiasSettings
from scuro.passes.post.attention import AttentionSettings
from scuro.passes.post.borders import BorderSettings
from scuro.passes.post.focus import FocusSettings
from scuro.passes.post.fog import FogSettings
from scuro.passes.post.halos import HaloSettings
from scuro.passes.post.stereo import StereoSettings
from scuro.passes.post.toon import ToonSettings
from scuro.passes.reservoir.settings import StrategySettings
from scuro.passes.semantic.settings import SemanticSettings
from scuro.passes.shadow.shadow import ShadowSettings
from scuro.passes.volume.settings import VolumeSettings
from scuro.reference.path import PathSettings
from scuro.settings import SettingsGroup, setting
from scuro.style.paint import check_color
from scuro.style.reservoir_options import ReservoirSettings

SCREEN_DPI = 96.0
"""Resolution of a screen by convention (CSS): a picture without a resolution of its own has it."""


class Settings(SettingsGroup):
    """Everything about a picture but the scene and the camera."""

    size: tuple[int, int] = setting((1280, 720), "width and height", low=1, high=65536, unit="px")
    dpi: float | None = setting(
        None,
        "resolution to state in the file; what is given in px (lines, halos, blur) then keeps its "
        "size on paper: 1 px is 1/96 inch",
        low=1,
        high=100_000,
        unit="pixels an inch",
    )
    text: float | None = setting(
        None,
        "height of letters in labels, legends and the scale bar; auto: a 40th of the picture's "
        "height, or with a resolution 12 px, which is 9 points",
        low=4,
        high=1000,
        unit="px",
    )
    background: str = setting(
        "white", "colour behind the scene, or 'transparent'", check=check_color
    )
    visibility: str = setting(
        "auto",
        "how pixels find their atom: rasterised impostors or rays",
        choices=("auto", "raster", "raycast"),
    )
    renderer: str = setting(
        "deferred",
        "how light is found: passes for a picture at once, or the path tracer as the judge",
        choices=("deferred", "path"),
    )
    detail: float = setting(
        0.7,
        "in cell-scale models, merge atoms into spheres with a radius of up to this; 0 never",
        low=0.0,
        high=64.0,
        unit="px",
    )
    seed: int = setting(0, "seed of all random sequences", low=0, high=2**31 - 1)
    lighting: LightingSettings = LightingSettings()
    occlusion: OcclusionSettings = OcclusionSettings()
    shadows: ShadowSettings = ShadowSettings()
    path: PathSettings = PathSettings()
    volume: VolumeSettings = VolumeSettings()
    reservoir: ReservoirSettings = ReservoirSettings()
    strategy: StrategySettings = StrategySettings()
    semantic: SemanticSettings = SemanticSettings()
    attention: AttentionSettings = AttentionSettings()
    labels: LabelSettings = LabelSettings()
    legend: LegendSettings = LegendSettings()
    scale_bar: ScaleBarSettings = ScaleBarSettings()
    axes: AxesSettings = AxesSettings()
    toon: ToonSettings = ToonSettings()
    fog: FogSettings = FogSettings()
    borders: BorderSettings = BorderSettings()
    halos: HaloSettings = HaloSettings()
    depth_of_field: FocusSettings = FocusSettings()
    antialias: AntialiasSettings = AntialiasSettings()
    stereo: StereoSettings = StereoSettings()

    @property
    def px(self) -> float:
        """Pixels of the picture to a length of 1 px in other settings."""
        return 1.0 if self.dpi is None else self.dpi / SCREEN_DPI
