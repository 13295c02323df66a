"""Anti-aliasing: FXAA, or true supersampling with a Mitchell–Netravali filter."""

from __future__ import annotations

from scuro.passes.frame import Frame
from scuro.settings import SettingsGroup, setting


class AntialiasSettings(SettingsGroup):
    """Smooth edges."""

    method: str = setting(
        "fxaa",
        "fxaa smooths the finished picture; 2x, 3x and 4x draw it so many times larger and filter "
        "it down",
        choices=("none", "fxaa", "2x", "3x", "4x"),
        main=True,
    )

    @property
    def scale(self) -> int:
        """Samples along a pixel's edge."""
        return int(self.method[0]) if self.method.endswith("x") else 1


FILTER_RADIUS = 2
"""Of the reconstruction filter, in output pixels."""


def filter_down(frame: Frame) -> None:
    """Bring ``color`` from samples to output pixels, first across, then down."""
    if frame.scale == 1:
        return
    width, height = frame.size
    small = (width // frame.scale, height // frame.scale)
    uniform = {"mitchell": {"scale": frame.scale}}
    for entry, size in (("across", (small[0], height)), ("down", small)):
        result = frame.target(f"filtered_{entry}", "rgba16float", size=size)
        frame.compute(
            "passes/post/mitchell.wgsl",
            uniform | {"source": frame.resources["color"], "result": result},
            entry=entry,
            threads=size,
            label="antialias",
        )
        frame.resources["color"] = result
