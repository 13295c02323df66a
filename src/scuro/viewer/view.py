"""One person's view of the scene: the picture of where they stand. Knows no window and no panel."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Generator, Iterator

from scuro.errors import ScuroError
from scuro.heap import give_back
from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.projection import Size
from scuro.viewer.drawing import Drawing, Drawn
from scuro.viewer.eyes import Eye, eyes_of
from scuro.viewer.model import Model
from scuro.viewer.pacing import GPU_TARGET, SOFTWARE_TARGET, Pacing, moving_size
from scuro.viewer.refine import Step, coarse, plain, steps
from scuro.viewer.stance import Stance, drawn_size

log = logging.getLogger(__name__)

REST = 0.25
"""Seconds without a change after which the picture is no longer moving."""
FIRST_SHARE = 0.01
"""How far a rough picture is said to be."""


class View(Stance):
    """Draws a model's scene for one pair of eyes.

    Args:
        model: What is shown; shared with other views.
        renderer: Draws for this view only; see :meth:`Renderer.sibling`.
        size: Width and height of the picture in pixels.
        clock: Seconds, for tests.
    """

    def __init__(
        self,
        model: Model,
        renderer: Renderer,
        size: tuple[int, int],
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        super().__init__(model, size)
        self.renderer = renderer
        self._clock = clock
        software = renderer.gpu.info.software
        self.pacing = Pacing(SOFTWARE_TARGET if software else GPU_TARGET)
        self.share = 0.0
        """How far the picture is refined; 1 when it is the full one."""
        self.drawn: Drawn | None = None
        """The last complete picture."""
        self.drawing = Drawing(renderer, clock)
        self.error = ""
        self.remark = ""
        """What is to be told of a picture that could be drawn."""
        self.changed: Callable[[], None] = lambda: None
        """Called when the picture is out of date, to wake whoever shows it."""
        self._moved = -1e9
        self._rough: Generator[Drawn | float, None, None] | None = None
        self._stale = False
        """Whether the rough picture that is being drawn will be out of date."""
        self._steps: Iterator[Step] = iter(())
        self._step: Step | None = None
        self._slices = self.drawing.nothing()
        self._work: Iterator[float] | None = None
        self.built: float | None = None
        """How far something slow is built that the picture needs; ``None`` if nothing is."""
        self.stopped = False
        """Whether a person stopped the work on the full picture; until the next change."""
        self._bare = False
        self._left = False
        """Whether building was stopped so early that the last picture has to stay."""
        self._prepare()
        self.refresh()
        model.watch(self)

    def eyes(self, size: Size) -> tuple[Eye, ...]:
        """Those that the picture is for, in its pixels if it has this size."""
        extent = 1.0 if self.drawn is None else self.drawn.extent
        return eyes_of(self.camera, self.model.settings.stereo, extent, size)

    # --- what is to be drawn -----------------------------------------------------------------

    def refresh(self) -> None:
        """The picture is out of date: draw anew, from the roughest step."""
        if self._left:
            self._prepare()
        target = plain(self.full_settings) if self._bare else self.full_settings
        self._break_off()
        self._steps = steps(target)
        self.share, self.error = 0.0, ""
        self._stale = True
        self.stopped = self._bare
        self.changed()

    def _prepare(self) -> None:
        """Something may have to be built first; pictures are plain until it is."""
        scene = self.model.dressed(self.camera)
        steps = self.renderer.prepare(scene, self.camera, self.full_settings)
        self._work = self.drawing.built(steps)
        self._bare, self._left, self.built = False, False, None

    def stop(self) -> None:
        """Leave the picture as it is: cancel what is being built, or refine it no more."""
        if self._work is not None:
            self._work, self.built = None, None
            # without its tables the scene cannot be drawn at all
            self._left = not self.renderer.holds(self.model.dressed(self.camera))
            self._bare = not self._left
            if self._bare:
                self.refresh()
                return
        self._break_off()
        self.stopped = True

    def _break_off(self) -> None:
        """Leave the picture that is being drawn; none follows."""
        self._slices.close()
        self._steps, self._step = iter(()), None

    def move(self, camera: Camera) -> None:
        """See the scene from elsewhere; the picture is rough until this stops."""
        if camera != self.camera:
            self.camera = camera
            probe = self.model.probe
            if probe is not None and probe.settings.clip:
                self._prepare()  # a plane rides with the camera
            self.stir()

    def stir(self) -> None:
        """Something moves: pictures are rough until :data:`REST` seconds after the last call."""
        self._moved = self._clock()
        self.refresh()

    def scene_changed(self) -> None:
        """The model's scene, settings or clipping changed."""
        self.pacing.plain = False
        self.selection = [p for p in self.selection if p.item in self.model.scene.items]
        place = self._place
        self.follow()
        if self._place != place:
            self.pacing.begin()
        if self._rough is not None:
            self._rough.close()  # of what is no more
            self._rough = None
        self._prepare()
        self.stir()

    def resize(self, size: tuple[int, int], ratio: float = 1.0) -> None:
        """The picture has another size in pixels, so many to each of the screen's logical ones."""
        if (size, ratio) != (self.size, self.ratio):
            self.size, self.ratio = size, ratio
            self.stir()

    @property
    def moving(self) -> bool:
        playing = self.model.player.playing
        return playing or self.spinning or self._clock() - self._moved < REST

    @property
    def complete(self) -> bool:
        """Whether there is nothing left to draw until something changes."""
        return (
            self._left
            or self.share >= 1
            or (self.stopped and self._step is None and self.share > 0)
        )

    @property
    def status(self) -> str:
        """How far the picture is, in words."""
        if self.model.restyle is not None:
            return "preparing what was chosen"
        if self.drawing.compiling:
            return "compiling shaders"
        if self.built is not None:
            return f"building {self.built:.0%}"
        if self._left:
            return "stopped before it was built"
        if self.stopped:
            return "effects left out" if self._bare else f"stopped at {self.share:.0%}"
        return "complete" if self.share >= 1 else f"refining {self.share:.0%}"

    @property
    def wait(self) -> float | None:
        """Seconds until :meth:`draw` has something to do; ``None`` if nothing changes."""
        if self._work is not None:
            return 0.0
        if self.complete and not self.spinning:
            return None
        if self.moving and self.share > 0 and not self.spinning:
            # the rough picture of this place is drawn: wait for the next one, or for rest
            return max(0.0, REST - (self._clock() - self._moved))
        return 0.0

    def draw(self) -> Drawn | None:
        """Draw the next picture, or slice of one, on the way to the full one.

        Returns:
            The last complete picture; ``None`` if the scene cannot be drawn as it is set, and
            :attr:`error` says why.
        """
        if self.spinning:
            self.spin(self._clock())
            self.refresh()
        if self._left:
            return self.drawn
        rested = self.complete
        try:
            if self._work is not None:
                self._build_on()
            if self.moving or self._work is not None or self._rough is not None:
                if self.share == 0 and self.drawable:
                    self._draw_moving()
            elif not self.complete:
                self._draw_resting()
        except ScuroError as error:
            self._give_up(str(error))
        except Exception as error:
            log.exception("the scene could not be drawn")
            self._give_up(
                f"a fault of scuro itself ({type(error).__name__}: {error}): undo the last change"
            )
        if self.complete and not rested:
            give_back()
        return self.drawn

    def _give_up(self, why: str) -> None:
        """The scene cannot be drawn as it is; the next change tries again."""
        self._break_off()
        self.drawn, self.error, self.share, self._work = None, why, 1.0, None
        self._rough = None

    @property
    def drawable(self) -> bool:
        """Whether the scene can be drawn without building its tables first."""
        if self._work is None:
            return not self._left
        return self.renderer.holds(self.model.dressed(self.camera))

    def _build_on(self) -> None:
        """Do one slice of what must be built."""
        assert self._work is not None
        self.model.dressed(self.camera)
        self.built = next(self._work, None)
        if self.built is None:
            self._work = None
            if self.share > 0:
                self.refresh()  # the plain picture is there: now the real one

    def _draw_moving(self) -> None:
        settings = coarse(self.full_settings)
        if self.pacing.plain or self._bare or self._work is not None:
            settings = plain(settings)
        settings = settings.replace(
            size=drawn_size(settings.stereo, moving_size(self.size, self.pacing.scale))
        )
        scene = self.model.dressed(self.camera)
        if self._rough is None:
            self._rough = self.drawing.draw(scene, self.camera, settings, accumulate=True)
            self._stale = False
        for made in self._rough:
            if isinstance(made, Drawn):
                self.drawn, self._rough = made, None
                self.pacing.measured(self.drawing.seconds)
                self.share = 0.0 if self._stale else FIRST_SHARE
            elif self.drawing.compiling:
                return

    def _draw_resting(self) -> None:
        if self._step is None:
            self._step = next(self._steps, None)
            if self._step is None:
                return
            self._before = self.share
            self._slices = self.drawing.draw(
                self.model.dressed(self.camera), self.camera, self._step.settings, slices=True
            )
        self.model.dressed(self.camera)  # another view may have drawn since
        made = next(self._slices)
        if isinstance(made, Drawn):
            self.drawn, self.share, self._step = made, self._step.share, None
        else:
            self.share = self._before + made * (self._step.share - self._before) * 0.99
