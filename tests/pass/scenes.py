"""Small scenes with known answers, and a renderer that all tests of passes share."""

from __future__ import annotations

from functools import cache

import numpy as np

from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.geometry import Body, Geometry, Material
from scuro.scene.scene import Scene

WHITE = (255, 255, 255, 255)


@cache
def renderer() -> Renderer:
    return Renderer()


def spheres(*rows: tuple[float, float, float, float], color=WHITE, **material) -> Body:
    """Spheres (x, y, z, radius) of one material."""
    table = np.array(rows, np.float32).reshape(-1, 4)
    colors = np.tile(np.array(color, np.uint8), (len(table), 1))
    ids = np.arange(len(table), dtype=np.int32)
    return Body(Geometry(table, colors, ids), material=Material(specular=0, **material))


def floor(height: float = 0.0, half: float = 20.0, color=WHITE) -> Body:
    """A square in the plane z = height, facing +z."""
    a, b, c, d = (
        np.array([x * half, y * half, height]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    )
    triangles = np.array([[a, b, c], [a, c, d]], np.float32)
    normals = np.broadcast_to(np.array([0, 0, 1], np.float32), (2, 3, 3)).copy()
    colors = np.broadcast_to(np.array(color, np.uint8), (2, 3, 4)).copy()
    geometry = Geometry(
        triangles=triangles,
        triangle_normals=normals,
        triangle_colors=colors,
        triangle_ids=np.zeros((2, 3), np.int32),
    )
    return Body(geometry, material=Material(specular=0))


def scene_of(*bodies: Body, lighting=None) -> Scene:
    scene = Scene()
    scene.extra_bodies += bodies
    scene.lighting = lighting
    return scene


def oblique(distance: float = 12.0, target=(0, 0, 0)) -> Camera:
    """From the side and above, so that a sphere does not hide all of its shadow."""
    return Camera((distance, 0, 0.9 * distance), target, (0, 0, 1))


def draw(scene: Scene, camera: Camera, size=(96, 72), **changes):
    """The picture; its buffers are behind it until the next one is drawn."""
    settings = Settings(size=size).replace(antialias__method="none")
    return renderer().render(scene, camera, settings.replace(**changes))


def walls(half: float, top: float) -> Body:
    """Four upright squares' worth of wall around the square |x|, |y| < half, from z = 0 to top."""
    quads = []
    for turn in range(4):
        c, s = np.cos(turn * np.pi / 2), np.sin(turn * np.pi / 2)
        rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        a, b = np.array([half, -half, 0]), np.array([half, half, 0])
        up = np.array([0, 0, top])
        quads += [rotation @ np.array(t).T for t in ((a, b + up, b), (a, a + up, b + up))]
    triangles = np.array([q.T for q in quads], np.float32)
    edges = triangles[:, 1:] - triangles[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    geometry = Geometry(
        triangles=triangles,
        triangle_normals=np.repeat(normals[:, None], 3, axis=1).astype(np.float32),
        triangle_colors=np.full((8, 3, 4), 255, np.uint8),
        triangle_ids=np.zeros((8, 3), np.int32),
    )
    return Body(geometry, material=Material(specular=0))
