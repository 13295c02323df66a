"""Every value of one setting, such as each occlusion technique, held against a reference."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.errors import SettingsError
from scuro.measure.fit import Fitter, rgb
from scuro.measure.metrics import rmse, score
from scuro.measure.report import Row
from scuro.measure.variant import Variant
from scuro.render_settings import Settings
from scuro.settings import Parameter, unknown, walk

if TYPE_CHECKING:
    from scuro.render import Renderer
    from scuro.scene.camera import Camera
    from scuro.scene.scene import Scene


_LEAST_OPACITY = 0.02
"""Pixels of a volume with less are background."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """What a variant gave."""

    variant: Variant
    pixels: NDArray[np.uint8]
    """(h, w, 4)"""
    object_mask: NDArray[np.bool_]
    visibility: NDArray[np.float32] | None
    milliseconds: float
    megabytes: float = 0.0
    """GPU memory of the reservoirs drawn; 0 without any."""


def varied() -> dict[str, tuple[str, Parameter]]:
    """What can be varied: settings that are one of several words, by their flag's name.

    Gives the path for :meth:`replace` and the parameter.
    """
    return {
        (path[:-1] if p.main and len(path) > 1 else path)[-1]: ("__".join(path), p)
        for path, p in walk(Settings)
        if p.choices and not p.many
    }


def variants(setting: str, names: Sequence[str] = ()) -> list[Variant]:
    """One variant for each value of a setting, or for those named.

    Raises:
        SettingsError: The setting has no list of values, or a name is not among them.
    """
    known = varied()
    if setting not in known:
        raise SettingsError(unknown("setting to vary", setting, known))
    path, parameter = known[setting]
    choices = [c for c in parameter.choices or () if c != "auto"]
    for name in names:
        if name not in choices:
            raise SettingsError(unknown(setting, name, choices))
    return [Variant(name, {path: name}) for name in names or choices]


def draw(
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    variant: Variant,
    frames: int,
) -> Drawn:
    """Draw a variant once to warm up and ``frames`` times for its median time.

    With 0 frames the first drawing is the one that is timed, compilation and building included.
    """
    chosen = settings.replace(**variant.changes)
    begun = time.perf_counter()
    image = renderer.render(scene, camera, chosen)
    times = [] if frames else [time.perf_counter() - begun]
    buffers = image.buffers()
    shown = buffers["object"] >= 0
    if "volume_opacity" in buffers:
        shown |= buffers["volume_opacity"] > _LEAST_OPACITY
    for _ in range(frames):
        renderer.restart()
        start = time.perf_counter()
        renderer.frame(scene, camera, chosen).recorder.submit()
        renderer.gpu.finish()
        times.append(time.perf_counter() - start)
    return Drawn(
        variant,
        image.pixels,
        shown,
        buffers.get("visibility"),
        1e3 * statistics.median(times),
        sum(renderer.reservoirs.bytes(r, chosen.strategy) for r in scene.reservoirs) / 1e6,
    )


def compare(
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    variants: Sequence[Variant],
    reference: Variant,
    *,
    frames: int = 3,
    fit: bool = False,
    on_drawn: Callable[[Drawn, Row], None] = lambda drawn, row: None,
) -> list[Row]:
    """Draw the reference and all variants with equal settings otherwise, and score them.

    Args:
        frames: Frames timed for each.
        fit: Fit each variant's attenuation to the reference first (volumes).
        on_drawn: Called after each picture, the reference's first.

    Raises:
        SettingsError: The picture shows nothing, so that there is nothing to compare.
    """
    truth = draw(renderer, scene, camera, settings, reference, 0)
    if not truth.object_mask.any():
        raise SettingsError("the picture is empty: there is nothing to compare")
    rows = [
        Row(reference.name, _settings(reference), truth.milliseconds, notes=_notes(truth, truth))
    ]
    on_drawn(truth, rows[0])
    fitter = Fitter(renderer, scene, camera, settings, reference) if fit else None
    for given in variants:
        variant = fitter.fitted(given) if fitter else given
        drawn = draw(renderer, scene, camera, settings, variant, frames)
        row = Row(
            variant.name,
            _settings(variant),
            drawn.milliseconds,
            score(rgb(drawn.pixels), rgb(truth.pixels), truth.object_mask),
            score(rgb(drawn.pixels), rgb(truth.pixels)),
            notes=_notes(drawn, truth),
        )
        rows.append(row)
        on_drawn(drawn, row)
    return rows


def _settings(variant: Variant) -> dict[str, Any]:
    return {key.replace("__", "."): value for key, value in variant.changes.items()}


def _notes(drawn: Drawn, truth: Drawn) -> dict[str, float]:
    """Memory of reservoirs; RMSE of the visibility itself, where both techniques make one."""
    notes = {}
    if drawn.megabytes:
        notes["megabytes"] = drawn.megabytes
    if drawn is not truth and drawn.visibility is not None and truth.visibility is not None:
        notes["visibility_rmse"] = rmse(drawn.visibility, truth.visibility, truth.object_mask)
    return notes
