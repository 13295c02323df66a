"""A view, its panel and its hands together: takes events, draws into any texture."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from scuro.render import Renderer
from scuro.viewer import navigate
from scuro.viewer.controls import Controls
from scuro.viewer.drawing import Drawn
from scuro.viewer.eyes import Eye
from scuro.viewer.glasses import Glasses
from scuro.viewer.gui import Gui
from scuro.viewer.handles import Handles
from scuro.viewer.jobs import Jobs
from scuro.viewer.marks import draw_marks
from scuro.viewer.model import Model
from scuro.viewer.names import Names
from scuro.viewer.overlay import draw_flat, draw_hung
from scuro.viewer.panel import WIDTH as PANEL_WIDTH
from scuro.viewer.panel import Panel
from scuro.viewer.pick import instance_number
from scuro.viewer.playbar import ABOVE_BAR, PlayBar, room
from scuro.viewer.probing import Probing
from scuro.viewer.under import words_at
from scuro.viewer.view import View

log = logging.getLogger(__name__)

_MOST_OUTLINED = 32
"""As in screen.wgsl."""
_OUTLINE = (1.0, 0.55, 0.0, 1.0)
_OUTLINE_OF_GLASSES = (1.0, 0.9, 0.1, 1.0)
"""Bright for both eyes."""
_STEREO = {"side-by-side": 1, "red-cyan": 2}
"""As in screen.wgsl."""
LARGEST = 8192
"""Pixels along a side of the largest picture a screen may ask for."""
MOST_PIXELS = 1 << 24
"""In all: each takes some hundred bytes of the GPU's memory."""


class Screen:
    """What a window, a browser's page or a notebook's cell shows.

    Args:
        model: The scene, shared by all screens.
        renderer: Another screen's renderer or the first; this screen draws with a sibling of it.
        format: Of the textures it is drawn into.
        deliver: Where saved pictures and scene files go: a name, and a function that writes them
            to a path with that ending; it returns a sentence for people.
        listing: Files to offer for opening.
        elsewhere: Whether ``deliver`` takes files to another machine.
        told: Makes of an error's sentence what may be told.
    """

    def __init__(
        self,
        model: Model,
        renderer: Renderer,
        format: str,
        deliver: Callable[[str, Callable[[Path], None]], str],
        listing: Callable[[], list[str]] = list,
        elsewhere: bool = False,
        told: Callable[[str], str] = str,
    ) -> None:
        self.model = model
        self.gpu = renderer.gpu
        self.view = View(model, renderer.sibling(), (64, 48))
        self.handles = Handles(self.view)
        jobs = Jobs()
        self.probing = Probing(self.view, jobs)
        self.controls = Controls(self.view, self.handles, self.probing)
        self.gui = Gui(self.gpu, format)
        self.glasses = Glasses(self.gpu, format)
        self.panel = Panel(
            self.view, self.handles, self.probing, jobs, deliver, listing, elsewhere, told
        )
        self.play_bar = PlayBar(self.view)
        self.names = Names(self.view, time.perf_counter)
        self.controls.key_hook = self.panel.key
        self.logical = (64.0, 48.0)
        self.ratio = 1.0
        self._first = True
        self._touched = True
        self._asked: Any = None
        self._hover = ""

    def resize(self, width: float, height: float, ratio: float) -> None:
        """Logical size, and physical pixels to each logical one."""
        ratio = min(max(ratio, 0.25), 4.0)
        width, height = (min(max(s, 1.0), LARGEST / ratio) for s in (width, height))
        ratio = min(ratio, math.sqrt(MOST_PIXELS / (width * height)))
        self.logical, self.ratio = (width, height), ratio
        self._lay_out()
        if self._first and min(width, height) > 1:
            # the camera was fitted before the screen had a size
            self._first = False
            # a phone's picture is not hidden behind the panel before anybody asked for it
            self.panel.open = width > 2 * PANEL_WIDTH
            self._lay_out()
            self.view.camera = self.view.initial_camera()
        self._touched = True

    @property
    def physical(self) -> tuple[int, int]:
        """Pixels of the textures to draw into."""
        return physical(self.logical, self.ratio)

    def _lay_out(self) -> None:
        """The picture takes what the panel leaves; on a narrow screen the panel lies over it."""
        width, height = self.logical
        taken = PANEL_WIDTH if self.panel.open and width > 2 * PANEL_WIDTH else 0.0
        self.controls.logical = (width - taken, height)
        plays = self.model.player.length > 1
        self.view.foot = min(room(self.controls.logical) / height, 0.4) if plays else 0.0
        self.view.resize(physical(self.controls.logical, self.ratio), self.ratio)

    def take(self, event: dict[str, Any]) -> None:
        """Act on an event; a fault of our own is told and logged, and ends no window or page."""
        try:
            self.handle(event)
        except Exception as error:
            log.exception("an event could not be acted on: %s", event.get("event_type"))
            self.model.message = (
                f"a fault of scuro itself ({type(error).__name__}: {error}): what was asked for "
                "may not have happened"
            )

    def handle(self, event: dict[str, Any]) -> None:
        """Act on one event of rendercanvas."""
        self._touched = True
        if event["event_type"] == "gamepad":
            self._gamepad(event)
            return
        taken = self.gui.handle(event)
        if not taken or self.controls.dragging or event["event_type"] == "pointer_leave":
            self.controls.handle(event)
        elif event["event_type"] == "pointer_move":
            self.controls.pointer = None

    def _gamepad(self, event: dict[str, Any]) -> None:
        """The left stick and the triggers move the probe, the right stick turns the scene."""
        axes = [min(max(float(event[name]), -1.0), 1.0) for name in ("x", "y", "z")]
        self.probing.push(*axes)
        turn = (8 * float(event["turn_x"]), 8 * float(event["turn_y"]))
        if any(turn):
            self.view.move(navigate.orbit(self.view.camera, turn, self.controls.logical))

    @property
    def wait(self) -> float | None:
        """Seconds until there is something to draw; ``None`` when nothing changes by itself."""
        if self._touched:
            return 0.0
        model, panel = self.model, self.panel
        timed = (
            model, model.player, self.view, self.names, self.gui, panel.jobs, self.probing
        )  # fmt: skip
        waits = [part.wait for part in timed]
        return min((w for w in waits if w is not None), default=None)

    def draw(self, target: Any) -> None:
        """Draw the next picture with everything over it.

        Args:
            target: Texture of the physical size.
        """
        self._touched = False
        begun = time.perf_counter()
        self._tick()
        self._lay_out()
        ready = time.perf_counter()
        drawn = self.view.draw()
        shown = time.perf_counter()
        self._show(drawn, target)
        self._look()
        over = target.create_view()
        if self._joined:
            for eye in self.view.eyes(self.controls.logical):
                hung = partial(self._hang, eye)
                self.glasses.draw(eye.number, over, self.logical, self.ratio, hung)
        else:
            self.glasses.close()
        self.gui.draw(over, self.logical, self.ratio, self._interface)
        beside = ready - begun + time.perf_counter() - shown
        pacing = self.view.pacing
        pacing.beside += 0.2 * (min(beside, 0.5 * pacing.target) - pacing.beside)

    def _tick(self) -> None:
        """Do what time brings."""
        self.model.tick()
        self.probing.tick()
        if self.view.drawable:
            self.model.player.tick()  # not before the frame at hand is seen
        if not self.view.moving:
            self.panel.jobs.tick()

    def _interface(self) -> None:
        picture = self.controls.logical
        eyes = self.view.eyes(picture)
        if not self._joined:
            for eye in eyes:
                self._hang(eye)
        draw_flat(self.view, eyes, (self._hover, self.controls.pointer))
        self.play_bar.draw(picture)
        # where the panel lies over the picture, it leaves the bars at its foot alone
        lies_over = picture[0] == self.logical[0]
        taken = max(ABOVE_BAR, self.view.foot * picture[1]) if lies_over else 0.0
        self.panel.draw((self.logical[0], self.logical[1] - taken))

    @property
    def _joined(self) -> bool:
        """Whether both eyes' pictures lie on each other."""
        return self.model.settings.stereo.mode == "red-cyan"

    def _hang(self, eye: Eye) -> None:
        """What an eye sees on places of the scene."""
        from imgui_bundle import imgui

        paper = imgui.get_background_draw_list()
        end = (eye.start + eye.size[0], eye.size[1])
        paper.push_clip_rect((eye.start, 0.0), end, True)
        self.probing.draw(eye)
        draw_marks(paper, self.names.marks(eye.number), self.ratio)
        draw_hung(self.view, self.handles, eye, self.panel.labels())
        paper.pop_clip_rect()

    def _look(self) -> None:
        """Ask what is under a pointer that came to rest; not while things move."""
        pointer = self.controls.pointer
        away = self.gui.over or (pointer is not None and pointer[0] > self.controls.logical[0])
        if self.controls.dragging or self.view.moving or pointer is None or away:
            self._hover, self._asked = "", None
            return
        # what lies there may have changed, too
        asked = (pointer, self.view.camera, id(self.model.history.present))
        if asked != self._asked:
            self._asked = asked
            width, height = self.controls.logical
            self._hover = words_at(self.view, pointer[0] / width, pointer[1] / height)

    def _show(self, drawn: Drawn | None, target: Any) -> None:
        recorder = self.gpu.recorder()
        if drawn is None:
            recorder.clear_texture(target, (0.1, 0.1, 0.11, 1.0))
            recorder.submit()
            return
        scene = self.model.scene
        picks = [p for p in self.view.selection if p.element >= 0][:_MOST_OUTLINED]
        numbers = [(p.element, instance_number(scene, p)) for p in picks]
        chosen = [(element, n, 0, 0) for element, n in numbers if n is not None]
        stereo = _STEREO.get(drawn.settings.stereo.mode, 0)
        uniform = {
            "size": self.view.full_settings.size,
            "selected": len(chosen),
            "reach": max(1, round(self.ratio * drawn.size[1] / self.view.size[1])),
            "color": _OUTLINE if stereo < 2 else _OUTLINE_OF_GLASSES,
            "stereo": stereo,
            "list": chosen or [(0, 0, 0, 0)],
        }
        left = {"left_ids": drawn.resources["ids"]}
        resources = {"screen": uniform, **left, **drawn.resources}
        recorder.draw("viewer/screen.wgsl", {"screen": target}, 3, 1, resources, clear=True)
        recorder.submit()

    def close(self) -> None:
        """Free what this screen holds."""
        self.panel.jobs.close()
        self.glasses.close()
        self.gui.close()


def physical(logical: tuple[float, float], ratio: float) -> tuple[int, int]:
    """Whole pixels of a logical size."""
    width, height = (max(1, round(s * ratio)) for s in logical)
    return width, height
