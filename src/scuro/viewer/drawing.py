"""Pictures drawn in slices, so that none takes long, and kept until the next is complete."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import Future, wait
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from scuro.gpu import Gpu
from scuro.passes.frame import Frame
from scuro.passes.part import Part
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.projection import Size
from scuro.scene.scene import Scene
from scuro.viewer.eyes import Eye, eyes_of
from scuro.viewer.jobs import in_turns

SLICE = 0.1
"""Seconds that one slice of a resting picture should take, margins aside."""
LEAST_ROWS = 48
"""Rows of the thinnest band: each also draws a margin."""
MOST_AT_ONCE = 1 << 21
"""Samples that are drawn at once while nothing moves: each takes some hundred bytes of memory,
which a GPU's allocator does not always give back."""
_WORTH = 0.25
"""Share of a slice below which a picture is not worth cutting."""
_TURN = 0.03
"""Seconds between two breaths of a long pass."""
_COMPILING = 0.02
"""Seconds for which a pipeline is waited for before others have their turn."""
_KEPT = {"picture": "rgba8unorm", "ids": "rgba32uint", "surface": "rgba32float"}


@dataclass(frozen=True, eq=False)
class Drawn:
    """A complete picture and what lies behind it."""

    gpu: Gpu
    camera: Camera
    settings: Settings
    resources: dict[str, Any]
    """``picture`` in output pixels; ``ids`` and ``surface`` in samples: of both eyes side by side,
    of the right one for red-cyan glasses, which have the other's ``left_ids`` besides."""
    extent: float = 1.0
    """Of the scene, which the distance of the eyes is a share of."""

    def eyes(self, size: Size) -> tuple[Eye, ...]:
        """Those that it is for, in the picture's pixels if it had this size."""
        return eyes_of(self.camera, self.settings.stereo, self.extent, size)

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
    compiling: bool = False
    """Whether the picture waits for a pipeline."""
    _turn: int = field(default=0, repr=False)

    def draw(
        self,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        slices: bool = False,
        accumulate: bool = False,
    ) -> Generator[Drawn | float, None, None]:
        """Draw a picture slice by slice.

        It is left, too, while a pipeline is made that it needs (:attr:`compiling`). A slow picture
        is cut into pieces of its passes (passes/pieces.py), and, where it has
        volumes or reservoirs, whose passes have none, into bands besides.

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
        count = self._count(scene, settings) if slices else 1
        parts = renderer.parts(settings, bands=count)
        self._turn = 1 - self._turn
        made: dict[str, Any] = {}
        kept = dict(self.kept)
        if "ids" in kept and settings.stereo.mode == "red-cyan":
            kept["left_ids"] = kept["ids"]
        seconds, pixels = 0.0, 0
        for index, part in enumerate(parts):
            start = self.clock()
            go_on = accumulate and len(parts) == 1
            cut = slices and self._expected(settings) > _WORTH * SLICE
            turns = self._in_turns(scene, camera, settings, part, cut, go_on)
            while True:
                try:
                    share = next(turns)
                except StopIteration as end:
                    frame = end.value
                    break
                if not self.compiling:
                    seconds += self.clock() - start
                yield (index + share) / len(parts)
                start = self.clock()
            for name, format in kept.items():
                source = frame.resources[name]
                scale = source.size[0] // part.size[0]
                if name not in made:
                    size = tuple(scale * s for s in settings.size)
                    made[name] = renderer.targets.get(f"{name} {self._turn}", size, format)
                _keep(frame.recorder, source, made[name], part, scale)
            renderer.timings = frame.recorder.submit()
            gpu.finish()
            seconds += self.clock() - start
            pixels += part.size[0] * part.size[1]
            if index + 1 < len(parts):
                yield (index + 1) / len(parts)
        self.rate, self.seconds = seconds / pixels, seconds
        yield Drawn(gpu, camera, settings, made, renderer.accelerator(scene).extent)

    def nothing(self) -> Generator[Drawn | float, None, None]:
        """A drawing that is done before it begins."""
        yield from ()

    def _in_turns(
        self,
        scene: Scene,
        camera: Camera,
        settings: Settings,
        part: Part,
        cut: bool,
        accumulate: bool,
    ) -> Generator[float, None, Frame]:
        """A frame that gives way while pipelines are made and, if it is to be cut, between the
        pieces of its long passes."""

        def draw(pause: Callable[[float], None]) -> Frame:
            last = self.clock()
            passes = 0

            def breathe(share: float) -> None:
                nonlocal last, passes
                passes += share >= 1
                if self.clock() - last >= _TURN:
                    # how many passes there are is not known: the share approaches the whole
                    pause(1 - 1 / (1 + passes + share % 1))
                    last = self.clock()

            self.renderer.breathe = breathe if cut else None
            try:
                with self._patiently(lambda: pause(1 - 1 / (1 + passes))):
                    return self.renderer.frame(scene, camera, settings, part, accumulate=accumulate)
            finally:
                self.renderer.breathe = None

        return (yield from in_turns(draw))

    def built(self, steps: Iterator[float]) -> Generator[float, None, None]:
        """Take steps that build something, giving way while pipelines are made for them."""

        def take(pause: Callable[[float], None]) -> None:
            share = 0.0
            with self._patiently(lambda: pause(share)):
                for share in steps:
                    pause(share)

        turns = in_turns(take)
        next(turns)  # before the first step: there may be none
        yield from turns

    @contextmanager
    def _patiently(self, pause: Callable[[], None]) -> Iterator[None]:
        """Within it, ``pause`` is called while pipelines are made."""

        def wait_for(coming: Future[Any]) -> None:
            while not wait([coming], _COMPILING).done:
                self.compiling = True
                try:
                    pause()
                finally:
                    self.compiling = False

        with self.renderer.gpu.programs.patiently(wait_for):
            yield

    def _expected(self, settings: Settings) -> float:
        """Seconds that a picture will take, as the last one did."""
        width, height = settings.size
        return self.rate * width * height

    def _count(self, scene: Scene, settings: Settings) -> int:
        """Bands that a picture at rest is drawn in."""
        if settings.renderer == "path":
            return 1  # the path tracer's sums are those of the whole picture
        width, height = settings.size
        samples = width * height * settings.antialias.scale**2
        count = -(-samples // MOST_AT_ONCE)
        if scene.volumes or scene.reservoirs:
            count = max(count, round(self._expected(settings) / SLICE))
        return max(1, min(count, height // LEAST_ROWS))


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
