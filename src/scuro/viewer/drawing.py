"""Pictures drawn in slices, so that none takes long, and kept until the next is complete."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from scuro.gpu import Gpu
from scuro.passes.part import Part
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.scene import Scene

SLICE = 0.1
"""Seconds that one slice of a resting picture should take, margins aside."""
LEAST_ROWS = 48
"""Rows of the thinnest slice: each also draws a margin."""
_KEPT = {"picture": "rgba8unorm", "ids": "rgba32uint", "surface": "rgba32float"}


@dataclass(frozen=True, eq=False)
class Drawn:
    """A complete picture and what lies behind it."""

    gpu: Gpu
    camera: Camera
    settings: Settings
    resources: dict[str, Any]
    """``picture`` in output pixels; ``ids`` and ``surface`` in samples."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of ``ids`` in samples."""
        width, height = self.resources["ids"].size[:2]
        return width, height


@dataclass
class Drawing:
    """Draws pictures into two sets of textures in turn: one is shown, one is worked on."""

    renderer: Renderer
    clock: Callable[[], float]
    rate: float = 0.0
    """Seconds a pixel took in the last picture."""
    seconds: float = 0.0
    """Seconds the last complete picture took."""
    kept: Mapping[str, str] = field(default_factory=lambda: _KEPT)
    """Textures of a finished picture, with their formats."""
    _turn: int = field(default=0, repr=False)

    def draw(
        self,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        slices: bool = False,
        accumulate: bool = False,
    ) -> Iterator[Drawn | float]:
        """Draw a picture slice by slice.

        Args:
            scene: What to draw.
            camera: From where.
            settings: How.
            slices: Whether a slow picture may be cut into slices.
            accumulate: Whether to go on from what the pictures before found (and not to make the
                picture that these settings make alone).

        Yields:
            The share that is done, after each slice but the last; then the picture.
        """
        renderer, gpu = self.renderer, self.renderer.gpu
        count = self._count(settings) if slices else 1
        parts = renderer.parts(settings, bands=count)
        self._turn = 1 - self._turn
        made: dict[str, Any] = {}
        seconds, pixels = 0.0, 0
        for index, part in enumerate(parts):
            start = self.clock()
            go_on = accumulate and len(parts) == 1
            frame = renderer.frame(scene, camera, settings, part, accumulate=go_on)
            for name, format in self.kept.items():
                source = frame.resources[name]
                scale = source.size[0] // part.size[0]
                if name not in made:
                    size = tuple(scale * s for s in settings.size)
                    made[name] = renderer.targets.get(f"{name} {self._turn}", size, format)
                if name == "picture" or part.eye < 1:
                    _keep(frame.recorder, source, made[name], part, scale)
            renderer.timings = frame.recorder.submit()
            gpu.finish()
            seconds += self.clock() - start
            pixels += part.size[0] * part.size[1]
            if index + 1 < len(parts):
                yield (index + 1) / len(parts)
        self.rate, self.seconds = seconds / pixels, seconds
        yield Drawn(gpu, camera, settings, made)

    def _count(self, settings: Settings) -> int:
        width, height = settings.size
        wanted = self.rate * width * height / SLICE
        return max(1, min(round(wanted), height // LEAST_ROWS))


def _keep(recorder: Any, source: Any, target: Any, part: Part, scale: int) -> None:
    """Copy the kept rectangle of a part into the whole."""
    rows, columns = part.inside
    recorder.copy_region(
        source,
        target,
        (scale * columns.start, scale * rows.start),
        (scale * part.columns.start, scale * part.rows.start),
        (scale * (columns.stop - columns.start), scale * (rows.stop - rows.start)),
    )
