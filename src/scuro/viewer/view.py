"""One person's view of the scene: camera, picture, selection. Knows no window and no panel."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Generator, Iterator
from dataclasses import replace
from typing import Any

from scuro.errors import ScuroError
from scuro.passes.post.stereo import StereoSettings, eye_size
from scuro.render import Renderer
from scuro.render_names import SMALLEST_TEXT, text_size
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.points import scene_points
from scuro.scene.projection import Size
from scuro.scene.view import ViewSettings, view_camera
from scuro.viewer import navigate
from scuro.viewer.drawing import Drawing, Drawn
from scuro.viewer.eyes import Eye, eyes_of
from scuro.viewer.model import Model
from scuro.viewer.pacing import GPU_TARGET, SOFTWARE_TARGET, Pacing, moving_size
from scuro.viewer.pick import Pick
from scuro.viewer.refine import Step, coarse, plain, steps

log = logging.getLogger(__name__)

REST = 0.25
"""Seconds without a change after which the picture is no longer moving."""
FIRST_SHARE = 0.01
"""How far a rough picture is said to be."""
SPIN = 30.0
"""Degrees a second."""


class View:
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
        self.model = model
        self.renderer = renderer
        self.size = size
        self.ratio = 1.0
        """Pixels of the picture to each logical pixel of its screen."""
        self.foot = 0.0
        """Share of the picture's height that something covers at its foot."""
        self._clock = clock
        software = renderer.gpu.info.software
        self.pacing = Pacing(SOFTWARE_TARGET if software else GPU_TARGET)
        self.camera = self.initial_camera()
        self._place = self._shown_place()
        self._cameras: dict[Any, Camera] = {}
        """Where this view stood before what was shown earlier."""
        self._stereo = model.settings.stereo
        self.selection: list[Pick] = []
        self.spinning = False
        self.profile = "scuro"
        """What drags do: a name in :data:`scuro.viewer.controls.PROFILES`."""
        self.windowing = False
        """Whether dragging sets window and level of a volume."""
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
        self._spun = 0.0
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

    def initial_camera(self) -> Camera:
        """As the document says, for this size."""
        wanted = self.model.document.view
        camera = view_camera(self.model.scene, wanted, self.aspect)
        return camera if wanted.position is not None else navigate.raised(camera, self.foot)

    @property
    def aspect(self) -> float:
        """Width over height of what an eye sees."""
        return self._aspect(self.model.settings.stereo)

    def _aspect(self, stereo: StereoSettings) -> float:
        width, height = eye_size(stereo, _drawn_size(stereo, self.size))
        return width / height

    def _shown_place(self) -> Any:
        """What a camera belongs to: what was read, and from where it is first looked at."""
        return self.model.document.input, self.model.document.view

    def _follow(self) -> None:
        """Stand before another scene where it was left, or as it says; see as much in stereo."""
        place, stereo = self._shown_place(), self.model.settings.stereo
        if place != self._place:
            self._cameras[self._place] = self.camera
            known = self._cameras.get(place)
            self.camera = self.initial_camera() if known is None else known
        elif stereo.mode != self._stereo.mode:
            before, after = self._aspect(self._stereo), self._aspect(stereo)
            points = scene_points(self.model.scene)
            self.camera = navigate.narrowed(self.camera, before, after, points)
        self._place, self._stereo = place, stereo

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
        self._work = self.renderer.prepare(scene, self.camera, self.full_settings)
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
        self._follow()
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
    def full_settings(self) -> Settings:
        """Of the picture that the view comes to rest at; ``scuro render`` makes the same one."""
        settings = self.model.settings.replace(
            size=_drawn_size(self.model.settings.stereo, self.size)
        )
        if settings.text is None and text_size(settings) < SMALLEST_TEXT * self.ratio:
            settings = settings.replace(text=SMALLEST_TEXT * self.ratio / settings.px)
        return self.model.focused(settings, self.camera)

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
            self._spin()
        if self._left:
            return self.drawn
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
            size=_drawn_size(settings.stereo, moving_size(self.size, self.pacing.scale))
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

    def _spin(self) -> None:
        now = self._clock()
        if self._spun:
            self.camera = self.camera.orbited(SPIN * min(now - self._spun, 0.5), 0)
        self._spun = now
        self.refresh()

    def toggle_spin(self) -> None:
        """Start or stop turning about the vertical."""
        self.spinning = not self.spinning
        self._spun = 0.0
        self.stir()

    def fit(self) -> None:
        """See all of the scene from the same side."""
        scene = self.model.scene
        points = scene_points(scene)
        bounds = scene.bounds()
        fitted = navigate.fit(self.camera, bounds, self.aspect, points if len(points) else None)
        self.move(navigate.raised(fitted, self.foot))

    def select(self, found: Pick | None, add: bool = False) -> None:
        """Select what was picked, or nothing; with ``add``, besides what is selected."""
        if found is None:
            self.selection = self.selection if add else []
            return
        again = [p for p in self.selection if p.same_place(found)]
        if add and again:
            self.selection.remove(again[0])
        else:
            self.selection = [*(self.selection if add else []), found]

    def document(self) -> Any:
        """The document that makes this view's picture, at this size."""
        return replace(
            self.model.as_seen(self.camera),
            view=ViewSettings.of(self.camera),
            settings=self.full_settings,
        )


def _drawn_size(stereo: StereoSettings, size: tuple[int, int]) -> tuple[int, int]:
    """A picture's size: side by side it is an even number of pixels wide."""
    width, height = size
    if stereo.mode == "side-by-side":
        width = max(2, width - width % 2)
    return width, height
