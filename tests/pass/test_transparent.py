"""Transparent objects: they dim and do not block, in every technique; the picture shows layers."""

import numpy as np
import pytest
from scenes import draw, floor, oblique, renderer, scene_of, spheres

from scuro.errors import SettingsError
from scuro.scene.camera import Camera
from scuro.scene.lights import Light, Lighting
from scuro.scene.scene import Scene

SKY = Lighting((), ambient=1.0)
RED, GREEN = (255, 0, 0, 255), (0, 255, 0, 255)
ABOVE = Camera((0, 0, 12), (0, 0, 0), (0, 1, 0), fov=25)


def _roof(opacity):
    """A ball over a floor, seen obliquely; the floor's pixels near its middle."""
    return scene_of(floor(half=60), spheres((0, 0, 3, 1), opacity=opacity), lighting=SKY)


def _floor_visibility(opacity, **changes):
    image = draw(_roof(opacity), oblique(), **changes)
    position = image.buffer("position")
    if changes.get("renderer") == "path":
        found = image.buffer("linear")[..., 0]
    else:
        found = image.buffer("visibility")
    return found, (np.abs(position[..., 2]) < 1e-3) & (
        np.hypot(position[..., 0], position[..., 1]) < 2
    )


RAY = {"occlusion__technique": "ray", "occlusion__samples": 256, "occlusion__filter": "none"}
PATH = {"renderer": "path", "path__samples": 256, "path__bounces": 1, "path__antialias": False}


@pytest.mark.parametrize("changes", [RAY, PATH], ids=["ray", "path"])
def test_half_an_occluder_occludes_half(changes):
    solid, near = _floor_visibility(1.0, **changes)
    half, near_half = _floor_visibility(0.5, **changes)
    both = near & near_half
    # behind the ball the eye sees through it in one picture and not in the other
    assert both.sum() > 100
    assert np.mean(1 - half[both]) == pytest.approx(0.5 * np.mean(1 - solid[both]), abs=0.01)


def test_the_closed_form_and_the_bake_know_of_opacity():
    pair = ((0, 0, 0, 1), (1.5, 0, 0, 1))
    for technique, bound in (("analytic", 0.01), ("baked", 0.02)):
        occluded = {}
        for opacity in (1.0, 0.4):
            scene = scene_of(spheres(*pair, opacity=opacity), lighting=SKY)
            image = draw(
                scene, ABOVE, background="black", occlusion__technique=technique,
                occlusion__baked__directions=512,
            )  # fmt: skip
            white = image.buffer("linear")[..., 0]
            occluded[opacity] = 1 - white[white > 0.1].mean() / opacity
        assert occluded[1.0] > 0.02
        assert occluded[0.4] == pytest.approx(0.4 * occluded[1.0], abs=bound)


@pytest.mark.parametrize("technique", ["hard", "soft", "area", "mapped"])
def test_shadows_of_transparent_objects_are_as_light_as_they_are_clear(technique):
    light = Light(direction=(0, 0, -1), relative_to="world", size=0.01)
    scene = scene_of(
        floor(),
        spheres((-1, 0, 3, 1), opacity=0.3),
        spheres((1, 0, 3, 1), opacity=0.5),
        spheres((1, 0, 6, 1), opacity=0.5),
        lighting=Lighting((light,), ambient=0.0),
    )
    image = draw(scene, oblique(), (160, 120), shadows__technique=technique)
    position, shadow = image.buffer("position"), np.atleast_3d(image.buffer("shadow"))[..., 0]
    on_floor = np.abs(position[..., 2]) < 1e-3

    def below(x):
        found = on_floor & (np.hypot(position[..., 0] - x, position[..., 1]) < 0.35)
        return shadow[found].mean()

    assert below(-1) == pytest.approx(0.7, abs=0.01)
    assert below(1) == pytest.approx(0.25, abs=0.01)


def test_layers_blend_from_the_nearest_whatever_the_order_of_objects():
    bodies = [
        spheres((0, 0, -4, 2.5), color=(0, 0, 255, 255)),
        spheres((0, 0, 0, 1.5), color=GREEN, opacity=0.5),
        spheres((0, 0, 4, 1), color=RED, opacity=0.4),
    ]
    camera = Camera((0, 0, 20), (0, 0, 0), fov=20)
    pictures = []
    for order in ((0, 1, 2), (2, 1, 0), (1, 2, 0)):
        scene = scene_of(*(bodies[i] for i in order), lighting=SKY)
        image = draw(scene, camera, (65, 65), occlusion__technique="none")
        pictures.append(image.buffer("linear").copy())
    assert np.allclose(pictures[0], pictures[1], atol=2e-3)
    assert np.allclose(pictures[0], pictures[2], atol=2e-3)
    red, green, blue, alpha = pictures[0][32, 32]
    assert (red, green, blue, alpha) == pytest.approx((0.4, 0.3, 0.3, 1), abs=0.01)


def test_a_transparent_object_alone_is_so_in_the_files_alpha():
    scene = scene_of(spheres((0, 0, 0, 2), opacity=0.3), lighting=SKY)
    pixels = draw(scene, ABOVE, background="transparent").pixels
    assert pixels[36, 48, 3] == pytest.approx(0.3 * 255, abs=1)
    assert (pixels[36, 48, :3] > 250).all()


def test_the_picture_agrees_with_the_path_tracer():
    scene = scene_of(floor(half=60), spheres((0, 0, 2, 2), color=RED, opacity=0.4), lighting=SKY)
    deferred = draw(scene, oblique(), occlusion__technique="ray", occlusion__samples=256)
    found = deferred.buffer("linear").copy()
    truth = draw(scene, oblique(), **PATH).buffer("linear")
    assert np.sqrt(np.mean((found - truth)[..., :3] ** 2)) < 0.05
    assert np.abs((found - truth)[..., :3].mean(axis=(0, 1))).max() < 0.01


def test_no_opacity_is_nothing_and_opaque_scenes_pay_nothing():
    lone = scene_of(floor(half=60), lighting=SKY)
    found, _ = draw(_roof(0.0), oblique(), **RAY).pixels, None
    assert np.abs(found.astype(int) - draw(lone, oblique(), **RAY).pixels).max() <= 1
    opaque = renderer().accelerator(_roof(1.0)).constants
    assert not opaque["HAS_OPACITY"]


def test_wrong_opacities_are_said(tmp_path):
    from scuro.load import load

    path = tmp_path / "one.xyz"
    path.write_text("1\n\nC 0 0 0\n")
    scene = Scene().add(load(path))
    for wrong in (-0.1, 1.5, float("nan")):
        with pytest.raises(SettingsError, match="opacity must lie between 0 and 1"):
            scene.show("spacefill", opacity=wrong)
    assert scene.show("spacefill", opacity=0.3).bodies()[0].material.opacity == 0.3
