"""Which parts a picture is drawn in, by how far beyond a part its settings' passes may look."""

from __future__ import annotations

import math
from dataclasses import replace

from scuro.passes.part import Part, screen_reach, split
from scuro.passes.part import bands as split_bands
from scuro.passes.post.antialias import FILTER_RADIUS
from scuro.passes.post.cues import cues_reach
from scuro.passes.post.focus import focus_reach
from scuro.passes.post.stereo import eye_size
from scuro.render_settings import Settings

_OF_RAYS = ("ray", "hybrid", "analytic", "baked")
_SMOOTHING = 32
"""Samples that the widest smoothing looks about: à-trous at half resolution."""
_CALM = 8
"""Samples about which semantic shading smooths normals, and rounding."""
_FILTERS = 64
"""Samples beyond a part that filters may look at where occlusion is one of object space."""


def parts_of(
    settings: Settings, max_texture: int, bands: int = 1, rows: int | None = None
) -> list[Part]:
    """The parts in which a picture is drawn, row by row: one, unless it is large or stereo.

    Args:
        settings: The picture's, implied ones included.
        max_texture: Largest edge of a texture on this GPU.
        bands: Cut a picture that could be drawn at once into about so many.
        rows: The most that parts of a larger one shall keep.
    """
    scale = settings.antialias.scale
    size = eye_size(settings.stereo, settings.size)
    sight = _sight(settings, size[1] * scale)
    screen = max(sight, _FILTERS) / scale
    margin = (
        screen
        + cues_reach(settings, settings.px)
        + focus_reach(settings.depth_of_field, settings.px)
        + FILTER_RADIUS
    )
    parts = split(size, scale=scale, margin=math.ceil(margin), max_texture=max_texture, rows=rows)
    if bands > 1 and len(parts) == 1:
        # many thin bands: what looks less far about has narrower margins
        margin += sight / scale - screen
        parts = split_bands(size, margin=math.ceil(margin), count=bands)
    if settings.stereo.mode != "side-by-side":
        return parts
    both = [replace(part, eye=-1) for part in parts]
    both += [replace(part, eye=1, shift=size[0]) for part in parts]
    return sorted(both, key=lambda part: part.keep[1])


def _sight(settings: Settings, height: int) -> int:
    """Samples beyond a part, of a picture so many high, that its techniques may look at."""
    semantic = settings.semantic
    if semantic.mode != "off":
        blur = max(semantic.blur_occlusion, semantic.blur_bounce, semantic.blur_shadow)
        return screen_reach(height) + blur + _CALM
    if settings.occlusion.technique not in ("none", *_OF_RAYS):
        return screen_reach(height) + _SMOOTHING
    return min(_FILTERS, max(2 * settings.occlusion.hybrid.reach + 8, _SMOOTHING))
