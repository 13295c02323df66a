"""Reuse over time: what noisy passes find is averaged over frames.

While the camera rests, each pixel keeps the running mean of its frames: exact, so that no dither is
left and the picture converges to the reference. When the camera moves, what is known of a surface
point is looked up where the frame before showed it and rejected where that frame showed another
surface. Smoothing weakens with the samples that are behind each value, and ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from scuro.passes.filter.smooth import smooth
from scuro.passes.frame import Frame

_SHADER = "passes/filter/temporal.wgsl"
_PATIENCE = 8
"""Over frames smoothing ends later, so that it fades instead of stopping."""
_MOVING_MOST = 8
"""Frames that values from a moving camera are trusted to average."""


@dataclass
class _Signal:
    """What is known of one texture's values."""

    key: Any
    frames: int = 0
    """Averaged since the camera rests."""
    number: int = -1
    """Of the last frame that had them."""
    turn: int = 0


class History:
    """What earlier frames of a picture found; of one renderer and one size.

    The life of a frame: :meth:`begin`, then :func:`settle` of each noisy texture, then :meth:`end`.
    """

    def __init__(self) -> None:
        self._signals: dict[str, _Signal] = {}
        self._before: dict[str, Any] | None = None
        self._place: Any = None
        self.moved = True
        self.number = 0
        """Frames drawn since all was forgotten: what sequences go on from."""
        self.frames = 0
        """Frames since the camera rests."""

    def begin(self, view: dict[str, Any], size: tuple[int, int]) -> int:
        """Start a frame of a camera; gives its number, for sequences of samples.

        Args:
            view: Field values of ``View`` (wgsl/view.wgsl).
            size: Width and height of what is drawn, in samples.
        """
        place = (size, *(tuple(np.asarray(view[k]).tolist()) for k in ("size", "origin")))
        if place != self._place:
            self.__init__()  # type: ignore[misc]
            self._place = place
        self.moved = self._before is None or any(
            not np.array_equal(view[name], self._before[name]) for name in _CAMERA
        )
        self.frames = 1 if self.moved else self.frames + 1
        return self.number

    def end(self, frame: Frame) -> None:
        """Remember where the frame's surfaces were seen."""
        frame.recorder.copy_texture(frame.resources["surface"], _surface_before(frame))
        self._before = dict(frame.resources["view"])
        # what this frame did not ask for begins anew, and its key holds a scene
        self._signals = {n: held for n, held in self._signals.items() if held.number == self.number}
        self.number += 1

    def averaged(self, frame: Frame, signal: str, key: Any) -> int:
        """Frames at rest, this one counted, that a texture's values will be averaged over.

        Args:
            frame: Between :meth:`begin` and :meth:`end`.
            signal: What the values are called from frame to frame.
            key: Everything but the camera that they depend on; all is forgotten if it changes.
        """
        held = self._signals.get(signal)
        if held is None or held.key != key or held.number != self.number - 1:
            held = self._signals[signal] = _Signal(key)
            for turn in range(2):
                frame.recorder.clear_texture(_known(frame, signal, turn), (0, 0, 0, 0))
        held.frames = 1 if self.moved else held.frames + 1
        held.number = self.number
        return held.frames

    def gather(self, frame: Frame, name: str, signal: str, *, unknown: float) -> None:
        """Replace the texture ``name`` by all that is known of its values, at full resolution.

        Args:
            frame: Between :meth:`begin` and :meth:`end`, after :meth:`averaged`.
            name: A one-channel texture, full or half resolution; values below 0 are unknown.
            signal: What the values are called from frame to frame.
            unknown: Value where nothing is known.
        """
        source = frame.resources[name]
        held = self._signals[signal]
        half = tuple(source.size[:2]) != tuple(frame.size)
        frame.compute_tiles(
            _SHADER,
            {
                "temporal": {
                    "moved": int(self.moved),
                    "block": 2 if half else 1,
                    "offset": self.number % 4,
                    "unknown": unknown,
                },
                "before": self._before or frame.resources["view"],
                "surface_before": _surface_before(frame),
                "source": source,
                "known": _known(frame, signal, held.turn),
                "joined": _known(frame, signal, 1 - held.turn),
                "result": frame.target(f"{name} gathered", "r32float", clear=(1, 1, 1, 1)),
            },
            label="accumulate",
        )
        held.turn = 1 - held.turn
        frame.resources[name] = frame.resources[f"{name} gathered"]


def _known(frame: Frame, signal: str, turn: int) -> Any:
    return frame.targets.get(f"{signal} known {turn}", frame.size, "rgba32float", True, True)


def _surface_before(frame: Frame) -> Any:
    return frame.targets.get("surface before", frame.size, "rgba32float", True, True)


_CAMERA = ("view_from_scene", "half_extent", "orthographic", "jitter")


def settle(
    frame: Frame,
    name: str,
    key: Any,
    samples: int,
    *,
    kind: str = "auto",
    enough: int = 64,
    radius: int = 6,
    guide: Any = None,
    signal: str = "",
) -> None:
    """What every noisy texture ends with: averaging over frames, then smoothing.

    Args:
        frame: With ``surface`` filled.
        name: A one-channel texture, full or half resolution; values below 0 are unknown.
        key: Everything but the camera that the values depend on.
        samples: Behind each value of this frame.
        kind: Of smoothing; see :func:`scuro.passes.filter.smooth.smooth`.
        enough: So many samples need no smoothing.
        radius: Of the smoothing.
        guide: A one-channel texture at full resolution; the ratio to it is smoothed.
        signal: What the values are called from frame to frame; ``name`` by default.
    """
    history = frame.history
    signal = signal or name
    behind = float(samples)
    if history is not None:
        half = tuple(frame.resources[name].size[:2]) != tuple(frame.size)
        frames = history.averaged(frame, signal, key)
        behind = samples * frames * (0.25 if half else 1.0)
        enough *= _PATIENCE
        if behind >= enough:
            kind = "none"
        elif kind == "auto":
            radius = max(1, round(radius * math.sqrt(1 - behind / enough)))
        unknown = -2.0 if half else -1.0
        history.gather(frame, name, signal, unknown=1.0 if kind == "none" else unknown)
        behind *= min(_MOVING_MOST, 1 + history.number) if history.moved else 1
    smooth(frame, name, kind, radius=radius, guide=guide, samples=max(1.0, behind))
