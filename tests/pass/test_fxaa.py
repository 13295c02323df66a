"""FXAA against a twin in numpy, and what it shares with the passes around it."""

from __future__ import annotations

import numpy as np
import pytest

from scuro import Camera, Settings
from scuro.export.formats import display
from scuro.render import Renderer
from scuro.scene.geometry import Body, Geometry
from scuro.scene.scene import Scene

SIZE = (163, 117)
"""Neither a multiple of tiles nor of the blocks in which edges are looked for."""
CAMERA = Camera((0, 0, 40), (0, 0, 0), height=12.0)
PLAIN = {"lighting__preset": "simple", "occlusion__technique": "none"}
CUES = {
    "borders__width": 1.6, "halos__width": 9.0, "fog__strength": 0.4, "toon__steps": 4,
}  # fmt: skip


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Overlapping balls of many colours, some of them cut by the picture's edge."""
    rng = np.random.default_rng(7)
    rows = np.c_[rng.normal(size=(60, 3)) * [5, 3.5, 3], rng.uniform(0.3, 1.5, 60)]
    colors = rng.integers(30, 255, (60, 4)).astype(np.uint8)
    colors[:, 3] = 255
    made = Scene()
    geometry = Geometry(rows.astype(np.float32), colors, np.arange(60, dtype=np.int32))
    made.extra_bodies.append(Body(geometry, name="balls"))
    return made


def drawn(renderer, scene, **changes):
    settings = Settings(size=SIZE).replace(**(PLAIN | changes))
    return renderer.render(scene, CAMERA, settings)


def twin(color: np.ndarray, brightness: np.ndarray) -> np.ndarray:
    """FXAA of (h, w, 4) with its (h, w) brightness, pixel by pixel in plain numpy."""
    height, width = brightness.shape
    result = color.copy()

    def luma(y: int, x: int) -> float:
        return float(brightness[min(max(y, 0), height - 1), min(max(x, 0), width - 1)])

    for y in range(height):
        for x in range(width):
            near = {(i, j): luma(y + i, x + j) for i in (-1, 0, 1) for j in (-1, 0, 1)}
            m, n, s = near[0, 0], near[-1, 0], near[1, 0]
            w, e = near[0, -1], near[0, 1]
            contrast = max(m, n, s, w, e) - min(m, n, s, w, e)
            if contrast < max(0.0312, 0.166 * max(m, n, s, w, e)):
                continue
            corners = [near[i, j] for i in (-1, 1) for j in (-1, 1)]
            mean = (2 * (n + s + w + e) + sum(corners)) / 12
            t = min(abs(mean - m) / contrast, 1)
            stray = t * t * (3 - 2 * t)

            def bend(i: int, j: int, near=near) -> float:  # second differences along an axis
                line = [near[k * i, k * j] for k in (-1, 0, 1)]
                sides = [
                    abs(near[i + a * j, j + a * i] + near[-i + a * j, -j + a * i]
                        - 2 * near[a * j, a * i]) for a in (-1, 1)
                ]  # fmt: skip
                return sum(sides) + 2 * abs(line[0] + line[2] - 2 * line[1])

            horizontal = bend(1, 0) >= bend(0, 1)
            side, along = ((1, 0), (0, 1)) if horizontal else ((0, 1), (1, 0))
            before, after = near[-side[0], -side[1]], near[side]
            sign = 1 if abs(after - m) >= abs(before - m) else -1
            other = after if sign > 0 else before
            ends = []
            for way in (1, -1):
                for step in range(1, 10):
                    i, j = y + way * step * along[0], x + way * step * along[1]
                    jump = luma(i, j) + luma(i + sign * side[0], j + sign * side[1]) - m - other
                    if abs(jump) >= 0.5 * abs(other - m):
                        break
                ends.append((step, jump))
            nearest = min(ends, key=lambda end: end[0])
            crosses = (nearest[1] < 0) != (m < other)
            share = 0.5 - nearest[0] / (ends[0][0] + ends[1][0]) if crosses else 0.0
            share = max(share, 0.75 * stray * stray)
            beside = color[min(max(y + sign * side[0], 0), height - 1),
                           min(max(x + sign * side[1], 0), width - 1)]  # fmt: skip
            result[y, x] = (1 - share) * color[y, x] + share * beside
    return result


@pytest.mark.parametrize("changes", [{}, CUES, {"background": "transparent"}])
def test_fxaa_is_its_twin(renderer, scene, changes):
    image = drawn(renderer, scene, antialias__method="fxaa", **changes)
    resources = image._current_frame().resources
    color = renderer.gpu.read_texture(resources["color"]).astype(np.float64)
    brightness = renderer.gpu.read_texture(resources["brightness"])
    expected = twin(color, brightness)
    back = image.buffer("linear").astype(np.float64)
    if changes.get("background") != "transparent":
        expected += 1 - expected[..., 3:]  # over white
    off = np.abs(back - expected).max(axis=-1)
    assert (np.abs(expected - color).max(axis=-1) > 0.02).mean() > 0.02  # it does something
    # at symmetric corners, where both axes bend alike, rounding decides
    assert np.quantile(off, 0.995) < 2e-3


@pytest.mark.parametrize("changes", [{}, CUES, {"background": "transparent"}])
def test_the_picture_and_its_light_are_smoothed_alike(renderer, scene, changes):
    """The picture is smoothed as it is encoded, its light when someone asks for it."""
    image = drawn(renderer, scene, antialias__method="fxaa", **changes)
    again = np.round(display(image.buffer("linear")).clip(0, 1) * 255).astype(int)
    off = np.abs(again - image.pixels)
    # light is kept in halves: what a dark edge covers of white is known to 1/2048
    assert off.max() <= 2 and (off > 1).mean() < 1e-3


def test_tiles_leave_nothing_out(renderer, scene):
    """A pass between that may write everywhere makes the rest work everywhere, with one result."""
    changes = {"antialias__method": "fxaa", "background": "#204060"}
    tiled = drawn(renderer, scene, **changes).pixels.astype(int)
    whole = drawn(renderer, scene, depth_of_field__blur=1e-4, **changes).pixels.astype(int)
    assert np.abs(tiled - whole).max() <= 1
    # and with brightness stored by the cues, or by a pass of its own from light kept in halves
    tiled = drawn(renderer, scene, **CUES, **changes).pixels.astype(int)
    whole = drawn(renderer, scene, depth_of_field__blur=1e-4, **CUES, **changes).pixels.astype(int)
    assert np.abs(tiled - whole).max() <= 1


def test_edges_between_hues_of_equal_luminance_are_smoothed(renderer):
    """Colours of a hierarchy are equally light: their edges were left jagged."""
    corners = np.array([[-30, -3, 0], [30, 3, 0], [0, 40, 0], [0, -40, 0]], np.float32)
    triangles = corners[[[0, 1, 2], [1, 0, 3]]]
    # sRGB of pink and green, Y = 0.27 both
    colors = np.array([[207, 112, 150, 255], [80, 156, 101, 255]], np.uint8)
    made = Scene()
    geometry = Geometry(
        triangles=triangles,
        triangle_normals=np.broadcast_to(np.float32([0, 0, 1]), triangles.shape).copy(),
        triangle_colors=np.repeat(colors[:, None], 3, axis=1),
        triangle_ids=np.zeros((2, 3), np.int32),
    )
    made.extra_bodies.append(Body(geometry, name="halves"))

    def off(method: str) -> float:
        ideal = drawn(renderer, made, antialias__method="4x").pixels[..., :3].astype(float)
        found = drawn(renderer, made, antialias__method=method).pixels[..., :3]
        return float(np.sqrt(((found - ideal) ** 2).mean()))

    assert off("fxaa") < 0.5 * off("none")
