"""Settings of semantic occlusion (Koch 2018)."""

from __future__ import annotations

from itertools import pairwise

from scuro.errors import SettingsError
from scuro.settings import SettingsGroup, setting


def _falling(values: tuple[float, ...]) -> None:
    if any(a <= b for a, b in pairwise(values)):
        raise SettingsError(
            "thresholds are distances from far to near, each smaller than the one before, "
            f"not {', '.join(f'{v:g}' for v in values)}"
        )


class SemanticSettings(SettingsGroup):
    """Occlusion and shadow between the regions of a hierarchy only, level by level."""

    mode: str = setting(
        "off",
        "off; screen (the thesis's screen-space passes); traced (the same in object space); "
        "plain (the screen-space passes without the semantics)",
        choices=("off", "screen", "traced", "plain"),
        main=True,
    )
    thresholds: tuple[float, ...] | None = setting(
        None,
        "distances of camera to scene centre at which each level is reached, far to near; "
        "equal segments by default",
        low=0.0,
        check=_falling,
    )
    spacing: str = setting(
        "log", "equal segments of distance, or of its logarithm", choices=("linear", "log")
    )
    distance_to: str = setting(
        "scene",
        "measure the camera's distance to the scene's centre, or to its own target",
        choices=("scene", "target"),
    )
    parts: str = setting(
        "",
        "parts of molecules above their chains, as a tree of selections: "
        "NAME=SELECTION; NAME/INNER=SELECTION; …",
    )
    samples: int = setting(16, "directions a pixel", low=1, high=256)
    rays: int = setting(4, "rays a pixel, in traced mode", low=1, high=256)
    near_radius: float = setting(
        4.0, "reach of occlusion between atoms, in atom radii", low=0.1, high=100
    )
    far_radius: float = setting(
        0.06,
        "reach of occlusion between regions, as a share of the camera's distance",
        low=0.001,
        high=1.0,
    )
    strength: float = setting(1.0, "strength of the occlusion", low=0, high=4)
    bounce: float = setting(0.6, "strength of the indirect light; 0 for none", low=0, high=10)
    shadow: float = setting(
        0.6, "strength of shadows between compartments; 0 for none", low=0, high=1
    )
    shadow_steps: int = setting(20, "steps along each shadow ray, at most", low=4, high=512)
    blur_occlusion: int = setting(3, "radius of the occlusion's blur", low=0, high=32, unit="px")
    blur_bounce: int = setting(6, "radius of the bounce's blur", low=0, high=32, unit="px")
    blur_shadow: int = setting(5, "radius of the shadow's blur", low=0, high=32, unit="px")
    blur_depth: float = setting(
        0.02,
        "depths differing more are not blurred, as a share of the camera's distance",
        low=0,
        high=1,
    )
    blur_normal: float = setting(
        0.3, "normals with a smaller dot product are not blurred", low=-1, high=1
    )
    calm: float = setting(
        1.0,
        "how much to smooth light and picture where a pixel holds many atoms; 0 not at all",
        low=0,
        high=8,
    )
    color: bool = setting(
        True, "colour by the level in view: hues spread as the camera comes closer"
    )
    palette: str = setting(
        "",
        "colours of the outermost compartments, with commas between them, or a colour map's name; "
        "hues spread evenly by default",
    )
