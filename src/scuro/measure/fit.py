"""Numbers of a technique fitted to a reference, so that techniques are compared at their best.

The thesis leaves its attenuation factor to the user (Campagnolo 2021, section 3.4, α) and fitted by
hand; here it is a one-dimensional search for the smallest mean CIE ΔE2000 over the object.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from scuro.measure.metrics import delta_e
from scuro.measure.variant import Variant

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from scuro.render import Renderer
    from scuro.render_settings import Settings
    from scuro.scene.camera import Camera
    from scuro.scene.scene import Scene

LEAST_OPACITY = 0.02
"""Pixels of a volume with less are background."""
SHARE = 3
"""Pictures to fit by are drawn at one in so many pixels along each side, down to LEAST_SIDE."""
LEAST_SIDE = 96
TRIALS = 12
"""Pictures drawn for each number that is fitted."""


@dataclass(frozen=True)
class Number:
    """A setting to fit, and where to look for it."""

    path: str
    low: float
    high: float


def numbers_to_fit(settings: Settings) -> list[Number]:
    """What to fit of a technique for volumes as these settings draw it."""
    from scuro.passes.compose.lighting import with_implied

    volume = settings.volume
    shadows = volume.shadow.on or with_implied(settings).shadows.technique != "none"
    found: list[Number] = []
    if volume.sampled:
        return found
    if volume.occlusion.on:
        if volume.light == "slices":
            found.append(Number("volume__occlusion__slice_angle", 2.0, 80.0))
        found.append(Number("volume__occlusion__attenuation", 0.02, 2.0))
    if shadows:
        found.append(Number("volume__shadow__attenuation", 0.02, 2.0))
    return found


class Fitter:
    """Fits variants to one reference picture of a scene.

    Args:
        renderer: Draws.
        scene: What.
        camera: From where.
        settings: What all variants share.
        reference: What they are fitted to.
    """

    def __init__(
        self,
        renderer: Renderer,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        reference: Variant,
    ) -> None:
        least = min(1.0, LEAST_SIDE / min(settings.size))
        share = max(1 / SHARE, least)
        width, height = (max(1, round(n * share)) for n in settings.size)
        self._settings = settings.replace(size=(width, height))
        self._draw: Callable[[Settings], Any] = lambda chosen: renderer.render(
            scene, camera, chosen
        )
        image = self._draw(self._settings.replace(**reference.changes))
        self._truth = rgb(image.pixels)
        opacity = image.buffers().get("volume_opacity")
        self._mask = None if opacity is None else opacity > LEAST_OPACITY

    def fitted(self, variant: Variant, numbers: Sequence[Number] | None = None) -> Variant:
        """The variant with its numbers changed to those that fit best.

        Args:
            variant: What to fit.
            numbers: Which numbers; those of :func:`numbers_to_fit` by default.
        """
        from dataclasses import replace

        chosen = self._settings.replace(**variant.changes)
        changes = dict(variant.changes)
        for number in numbers_to_fit(chosen) if numbers is None else numbers:

            def error(value: float, path: str = number.path) -> float:
                drawn = self._draw(self._settings.replace(**{**changes, path: value}))
                return delta_e(rgb(drawn.pixels), self._truth, self._mask)

            changes[number.path] = search(error, number.low, number.high, TRIALS)
        return replace(variant, changes=changes)


def search(error: Callable[[float], float], low: float, high: float, trials: int) -> float:
    """The place of the least error between two positive bounds, to three digits.

    Golden-section search over the logarithm: fine near the lower bound, where factors are small.
    """
    ratio = (np.sqrt(5) - 1) / 2
    a, b = np.log(low), np.log(high)
    x, y = b - ratio * (b - a), a + ratio * (b - a)
    at_x, at_y = error(float(np.exp(x))), error(float(np.exp(y)))
    best = min((at_x, x), (at_y, y))
    for _ in range(trials - 2):
        if at_x <= at_y:
            b, y, at_y = y, x, at_x
            x = b - ratio * (b - a)
            at_x = error(float(np.exp(x)))
        else:
            a, x, at_x = x, y, at_y
            y = a + ratio * (b - a)
            at_y = error(float(np.exp(y)))
        best = min(best, (at_x, x), (at_y, y))
    return float(f"{np.exp(best[1]):.3g}")


def rgb(pixels: NDArray[np.uint8]) -> NDArray[np.float64]:
    """sRGB over black where the background is transparent."""
    values = pixels / 255
    return values[..., :3] * values[..., 3:]
