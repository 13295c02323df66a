"""A volume and surfaces in one picture: each stops, occludes and shadows the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scuro.passes.volume.solids import solid_fraction
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.geometry import Body, Geometry, Material
from scuro.scene.items import VolumeItem
from scuro.scene.lights import Light, Lighting
from scuro.scene.scene import Scene
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

SIZE = (64, 64)
GREY = TransferFunction(((0.0, 0.5, 0.5, 0.5),), ((0.0, 0.0), (1.0, 0.9)))
DOWN = Lighting((Light(direction=(0, -1, 0), intensity=1.0, relative_to="world"),), ambient=0.3)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def ball(center, radius) -> Body:
    return Body(
        Geometry(
            spheres=np.array([[*center, radius]], np.float32),
            sphere_colors=np.full((1, 4), 200, np.uint8),
            sphere_ids=np.zeros(1, np.int32),
        ),
        material=Material(specular=0.0),
    )


def context(center, radius) -> Body:
    return replace(ball(center, radius), context=True)


def slab(axis: int, low: int, high: int) -> VolumeItem:
    """40³ voxels, dense between two planes across an axis of (x, y, z)."""
    values = np.zeros((40, 40, 40), np.float32)
    index: list = [slice(None)] * 3
    index[2 - axis] = slice(low, high)
    values[tuple(index)] = 1.0
    return VolumeItem(Volume(values), GREY)


def picture(renderer, items, bodies, lighting=DOWN, **changes):
    scene = Scene(items)
    scene.extra_bodies = list(bodies)
    scene.lighting = lighting
    camera = Camera((20.0, 20.0, 300.0), (20.0, 20.0, 20.0), height=44.0)
    settings = Settings(size=SIZE, background="black").replace(**changes)
    return renderer.render(scene, camera, settings).pixels[..., :3].astype(float).mean(axis=2)


def test_surfaces_stop_rays_and_are_covered(renderer):
    """A ball before the slab is seen whole, one behind it not at all."""
    empty = picture(renderer, [slab(2, 15, 25)], [])
    before = picture(renderer, [slab(2, 15, 25)], [ball((20, 20, 34), 4)])
    behind = picture(renderer, [slab(2, 15, 25)], [ball((20, 20, 5), 4)])
    alone = picture(renderer, [slab(2, 0, 0)], [ball((20, 20, 34), 4)])
    assert abs(before[30, 32] - empty[30, 32]) > 10
    np.testing.assert_allclose(before[28:31, 30:34], alone[28:31, 30:34], atol=25)
    np.testing.assert_allclose(behind[28:36, 28:36], empty[28:36, 28:36], atol=20)


def test_each_shadows_the_other(renderer):
    """Light from above: a dense layer over a ball darkens it; a ball over a layer leaves a spot."""
    changes = {"volume__shadow__on": True, "volume__shading": "none"}
    free = picture(renderer, [slab(1, 0, 0)], [ball((20, 12, 20), 5)], **changes)
    under = picture(renderer, [slab(1, 28, 34)], [ball((20, 12, 20), 5)], **changes)
    row = 63 - int(15 / 44 * 64)
    assert under[row, 32] < 0.75 * free[row, 32]
    plain = picture(renderer, [slab(1, 4, 10)], [], **changes)
    below = picture(renderer, [slab(1, 4, 10)], [ball((20, 26, 36), 6)], **changes)
    # the layer's front face, under the ball and far to its side
    row = 63 - int((9 + 2) / 44 * 64)
    assert below[row, 32] < 0.95 * plain[row, 32]
    assert below[row, 6] == pytest.approx(plain[row, 6], abs=3)


def test_a_volume_and_context_leave_each_others_light(renderer):
    """As :func:`test_each_shadows_the_other`, but for a ball in simple light."""
    changes = {"volume__shadow__on": True, "volume__shading": "none"}
    free = picture(renderer, [slab(1, 0, 0)], [context((20, 12, 20), 5)], **changes)
    under = picture(renderer, [slab(1, 28, 34)], [context((20, 12, 20), 5)], **changes)
    row = 63 - int(15 / 44 * 64)
    assert under[row, 32] == pytest.approx(free[row, 32], abs=0.5)
    plain = picture(renderer, [slab(1, 4, 10)], [], **changes)
    below = picture(renderer, [slab(1, 4, 10)], [context((20, 26, 36), 6)], **changes)
    row = 63 - int((9 + 2) / 44 * 64)
    assert below[row] == pytest.approx(plain[row], abs=3)


def test_solids_fill_the_balls_space():
    world_from_texture = np.diag([40.0, 20.0, 30.0, 1.0])
    size = (80, 40, 60)
    big, small = ball((20, 10, 15), 6.0), ball((5, 5, 5), 0.2)
    filled = solid_fraction([big], np.linalg.inv(world_from_texture), size).astype(float)
    assert filled.sum() / 8 == pytest.approx(4 / 3 * np.pi * 6**3, rel=0.02)
    assert filled[30, 20, 40] == 1 and filled[30, 20, 60] == 0
    filled = solid_fraction([small], np.linalg.inv(world_from_texture), size).astype(float)
    assert filled.sum() / 8 == pytest.approx(4 / 3 * np.pi * 0.2**3, rel=0.02)


def test_monte_carlo_sees_surfaces_as_cones_do(renderer):
    """The spot that a ball leaves on the layer under it, by 32 rays a cone."""
    changes = {
        "volume__shadow__on": True,
        "volume__shading": "none",
        "volume__light": "monte-carlo",
        "volume__samples": 32,
        "volume__occlusion__on": False,
    }
    plain = picture(renderer, [slab(1, 4, 10)], [], **changes)
    below = picture(renderer, [slab(1, 4, 10)], [ball((20, 26, 36), 6)], **changes)
    row = 63 - int((9 + 2) / 44 * 64)
    assert below[row, 32] < 0.95 * plain[row, 32]
    assert below[row, 6] == pytest.approx(plain[row, 6], abs=3)
