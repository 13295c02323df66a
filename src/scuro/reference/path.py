"""The judge: a progressive path tracer (Kajiya 1986; Easdon 2013, section 5.6).

Unbiased up to the bounce limit for the light it accounts for: lights are found by next-event
estimation only, so that mirrors and glass show the environment but not the lights' discs, and glass
casts a full shadow. A limit on contributions (``path.limit``) is the one bias on offer.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.passes.frame import Frame
from scuro.passes.shadow.ray import default_spread
from scuro.settings import SettingsGroup, setting

MOST_SAMPLES = 1 << 16
"""Length of the sequences in wgsl/sobol.wgsl."""

_SHADER = "reference/path.wgsl"
_UNLIMITED = 3e38


class PathSettings(SettingsGroup):
    """The path tracer (``--renderer path``)."""

    samples: int = setting(64, "paths a pixel", low=1, high=MOST_SAMPLES)
    seconds: float | None = setting(
        None, "stop after this time, if it comes before the samples", low=0, unit="s",
        switch=True,
    )  # fmt: skip
    bounces: int = setting(4, "times a path may scatter; 1 is direct light", low=1, high=64)
    environment: str = setting(
        "constant",
        "ambient light around the scene: equal everywhere, or brighter from above",
        choices=("constant", "gradient"),
    )
    antialias: bool = setting(True, "spread the samples over each pixel")
    limit: float | None = setting(
        None, "cut brighter contributions to this: fewer sparks, but biased", low=0, switch=True
    )


class PathTracer:
    """Keeps a picture's running sums, so that a further frame of the same adds to them."""

    def __init__(self) -> None:
        self._key: Any = None
        self._recolored = False
        self.samples = 0
        """Paths a pixel in the sums."""

    def draw(self, frame: Frame, colors: NDArray[np.uint32] | None = None) -> None:
        """Fill ``color`` with the mean of at least one and at most ``path.samples`` samples.

        ``colors`` replace those of objects: sRGB, one for each, alpha 0 where it keeps its own.
        """
        settings = frame.settings.path
        self._recolored = colors is not None
        shown = np.zeros(1, np.uint32) if colors is None else colors
        frame.resources["object_colors"] = frame.gpu.buffer(shown, label="colours")
        key = path_key(frame)
        if key != self._key or self.samples > settings.samples:
            self._key, self.samples = key, 0
        width, height = frame.size
        frame.scratch("sums", 16 * width * height)
        frame.target("color", "rgba16float", clear=(0, 0, 0, 0))
        start = time.perf_counter()
        while self.samples < settings.samples:
            self._key = None  # until the sample is whole: drawing may be broken off within it
            self._run(frame, "add", self.samples)
            self._key = key
            self.samples += 1
            # one sample at a time: no adapter must work for seconds on a single submission
            frame.recorder.flush()
            frame.gpu.finish()
            if settings.seconds is not None and time.perf_counter() - start >= settings.seconds:
                break
        self._run(frame, "mean", self.samples)

    def _run(self, frame: Frame, entry: str, index: int) -> None:
        settings = frame.settings.path
        kinds = {body.material.kind for body in frame.accelerator.bodies}
        uniform = {
            "size": frame.size,
            "index": index,
            "bounces": settings.bounces,
            "spread": default_spread(frame),
            "limit": _UNLIMITED if settings.limit is None else settings.limit,
            "gradient": 0.7 if settings.environment == "gradient" else 0.0,
            "antialias": int(settings.antialias),
        }
        frame.compute_tiles(
            _SHADER,
            {"paths": uniform},
            entry=entry,
            constants={
                "SHINY": bool(kinds - {"diffuse"}),
                "HAS_GLASS": "glass" in kinds,
                "RECOLORED": self._recolored,
            },
            label="path",
        )


def path_key(frame: Frame) -> Any:
    """Everything that means over a pixel's samples depend on."""
    planes = np.asarray(frame.resources["scene"]["planes"]).tobytes()
    lights = frame.resources["lights"]
    table = [{k: np.asarray(v).tolist() for k, v in light.items()} for light in lights["list"]]
    view = frame.resources["view"]
    return (
        frame.accelerator,
        *(tuple(np.asarray(view[name]).tolist()) for name in ("size", "origin", "jitter")),
        frame.camera,
        frame.settings.replace(path__samples=1, path__seconds=None),
        planes,
        np.asarray(lights["ambient"]).tolist(),
        table,
    )
