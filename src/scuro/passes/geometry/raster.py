"""Primary visibility by rasterised impostors."""

from scuro.passes.frame import Frame


def rasterise(frame: Frame) -> None:
    """Draw spheres, rods and triangles into ``visible``."""
    frame.target("visible", "rg32uint", attachment=True)
    frame.compute("passes/geometry/raycast.wgsl")
