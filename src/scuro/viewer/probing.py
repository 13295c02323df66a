"""The probe in a view: moved by mouse and keys, drawn over the picture, replayed along its path."""

from __future__ import annotations

import itertools
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from scuro.errors import MissingExtraError, ScuroError, SettingsError
from scuro.probe.probe import Probe, ProbeSettings
from scuro.viewer import navigate
from scuro.viewer.navigate import Size
from scuro.viewer.view import View

STEP = 0.4
"""Å the arrow keys move the hand."""
REPLAY = 30.0
"""Places of a recorded path that are shown a second."""
_FORCE = 4.0
"""Å an arrow has for each Å of penetration (at a stiffness of one)."""
_BALL, _RIM, _HAND, _ARROW, _PATH = 0x60E0A060, 0xFFB06020, 0xFF2020C0, 0xFF2020E0, 0xA0B06020
_KEYS = {
    "ArrowLeft": (-1, 0, 0),
    "ArrowRight": (1, 0, 0),
    "ArrowUp": (0, 1, 0),
    "ArrowDown": (0, -1, 0),
    "PageUp": (0, 0, -1),
    "PageDown": (0, 0, 1),
}
"""Right, up and toward the eye."""


class Probing:
    """One view's hand on the model's probe, which all views share."""

    def __init__(self, view: View, clock: Callable[[], float] = time.perf_counter) -> None:
        self.view = view
        self.settings = ProbeSettings()
        self._clock = clock
        self._replay: list[list[float]] = []
        self._begun = 0.0
        self._shown = 0

    @property
    def probe(self) -> Probe | None:
        return self.view.model.probe

    def toggle(self) -> None:
        """Put a probe where the camera looks, moved out of the atoms, or take it away."""
        model = self.view.model
        if model.probe is not None:
            model.set_probe(None)
            return
        self.renew(self.view.camera.target)

    def renew(self, start: Any) -> None:
        """A probe with the present settings."""
        model = self.view.model
        try:
            model.set_probe(Probe(model.scene, self.settings, start))
        except ImportError:
            model.message = str(MissingExtraError("Probes", "viewer"))
        except ScuroError as error:
            model.message = str(error)

    def change(self, settings: ProbeSettings) -> None:
        """Take other settings; the atoms are sorted anew only if it must be."""
        before, self.settings = self.settings, settings
        probe = self.probe
        if probe is None:
            return
        if (before.radius, before.select) != (settings.radius, settings.select):
            self.renew(probe.position)
        else:
            probe.settings = settings
            self.view.model.probe_moved()

    # --- hands -------------------------------------------------------------------------------

    def key(self, key: str) -> bool:
        """Take a key; whether it was the probe's."""
        if key.lower() == "p":
            self.toggle()
            return True
        if self.probe is None or key not in _KEYS:
            return False
        offset = np.array(_KEYS[key]) @ self.view.camera.view_from_world()[:3, :3] * STEP
        self.probe.move(self.probe.position + offset)
        self.view.model.probe_moved()
        return True

    def press(self, point: Size, size: Size) -> bool:
        """Take hold of the probe, if it is there."""
        if self.probe is None:
            return False
        x, y, depth = navigate.project(self.view.camera, [self.probe.position], size)[0]
        reach = self._pixels(size, depth) + 4
        return bool(depth > 0 and np.hypot(x - point[0], y - point[1]) <= reach)

    def drag(self, last: Size, now: Size, size: Size) -> None:
        """Move the hand in the plane of the picture."""
        if self.probe is None:
            return
        camera = self.view.camera
        depth = float(navigate.project(camera, [self.probe.target], size)[0, 2])
        step = navigate.pixel_size(camera, size, depth)
        right, up, _ = camera.view_from_world()[:3, :3]
        move = ((now[0] - last[0]) * right - (now[1] - last[1]) * up) * step
        self.probe.move(self.probe.target + move)
        self.view.model.probe_moved()

    def release(self) -> bool:
        """Let go: the hand springs back to the probe."""
        if self.probe is not None and (self.probe.force != 0).any():
            self.probe.rest()
            self.view.model.probe_moved()
        return False

    def _pixels(self, size: Size, depth: float) -> float:
        """Radius of the probe on the screen."""
        radius = self.settings.radius
        return radius / navigate.pixel_size(self.view.camera, size, max(depth, 1e-6))

    # --- path --------------------------------------------------------------------------------

    def replay(self) -> None:
        """Go along the recorded path again."""
        if self.probe is not None and self.probe.path:
            self.probe.recording = False
            self._replay, self._begun, self._shown = list(self.probe.path), self._clock(), -1

    @property
    def wait(self) -> float | None:
        """Seconds until the replay goes on; ``None`` if there is none."""
        return 1 / REPLAY if self._replay else None

    def tick(self) -> None:
        """Take the replay to the present time."""
        if not self._replay or self.probe is None:
            self._replay = []
            return
        index = int((self._clock() - self._begun) * REPLAY)
        if index >= len(self._replay):
            index, self._replay, places = len(self._replay) - 1, [], self._replay
        else:
            places = self._replay
        if index != self._shown:
            self._shown = index
            self.probe.move(places[index])
            self.view.model.probe_moved()

    # --- drawing -----------------------------------------------------------------------------

    def draw(self, size: Size) -> None:
        """The probe, the hand, the force and the path, over the picture."""
        from imgui_bundle import imgui

        from scuro.viewer.overlay import arrow

        probe = self.probe
        if probe is None:
            return
        paper, camera = imgui.get_background_draw_list(), self.view.camera
        if len(probe.path) > 1:
            places = navigate.project(camera, probe.path, size)
            for a, b in itertools.pairwise(places):
                if a[2] > 0 and b[2] > 0:
                    paper.add_line(tuple(a[:2]), tuple(b[:2]), _PATH, 2.0)
        (x, y, depth), hand = navigate.project(camera, [probe.position, probe.target], size)
        if depth <= 0:
            return
        radius = self._pixels(size, depth)
        paper.add_circle_filled((x, y), radius, _BALL, 48)
        paper.add_circle((x, y), radius, _RIM, 48, 2.0)
        if (probe.force != 0).any() and hand[2] > 0:
            paper.add_circle_filled((hand[0], hand[1]), 3.0, _HAND)
            arrow(paper, self.view, size, probe.position, _FORCE * probe.force, _ARROW)

    def panel(
        self,
        group: Callable[[str, Any], tuple[bool, Any]],
        save: Callable[[str, Callable[[Path], None]], None],
    ) -> None:
        """The probe's part of the panel."""
        from imgui_bundle import imgui

        if not imgui.collapsing_header("Probe"):
            return
        changed, _ = imgui.checkbox("probe in the scene", self.probe is not None)
        if changed:
            self.toggle()
        changed, settings = group("probe", self.settings)
        if changed:
            self.change(settings)
        probe = self.probe
        if probe is None:
            return
        x, y, z = probe.position
        imgui.text(f"at {x:.2f}, {y:.2f}, {z:.2f} Å")
        imgui.text(f"force {float(np.linalg.norm(probe.force)):.3g} pN")
        _, probe.recording = imgui.checkbox("record its path", probe.recording)
        imgui.text(f"{len(probe.path)} places")
        for word, act in (
            ("Replay", self.replay),
            ("Save path", lambda: save("probe-path.json", probe.save_path)),
            ("Forget", probe.path.clear),
        ):
            if imgui.small_button(word):
                act()
            imgui.same_line()
        imgui.new_line()


def stream_handler(model: Any) -> Callable[[Any], Any]:
    """Offer the probe to another program over a WebSocket.

    Each message ``{"target": [x, y, z]}`` moves the hand; the answer is :meth:`Probe.state`. An
    empty object asks without moving.
    """

    async def handle(socket: Any) -> None:
        shown = 0.0
        async for message in socket:
            try:
                if model.probe is None:
                    raise SettingsError("there is no probe in the scene")
                values = json.loads(message.data)
                if not isinstance(values, dict):
                    raise ValueError
                target = values.get("target")
                if target is not None:
                    place = np.array(target, np.float64)
                    if place.shape != (3,) or not np.isfinite(place).all():
                        raise ValueError
                    model.probe.move(place)
                    # a device moves a thousand times a second; pictures need a sixtieth of that
                    if time.perf_counter() - shown > 1 / 60:
                        shown = time.perf_counter()
                        model.probe_moved()
                answer = model.probe.state()
            except SettingsError as error:
                answer = {"error": str(error)}
            except (ValueError, TypeError, OverflowError):
                answer = {"error": 'send {"target": [x, y, z]} in ångström'}
            await socket.send_str(json.dumps(answer))
        if model.probe is not None:
            model.probe_moved()

    return handle
