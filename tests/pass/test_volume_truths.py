"""Path traced volumes and slice-based occlusion, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_volume import PLAIN, WHITE, draw, ramp, solid

from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.lights import Light, Lighting
from scuro.style.transfer import TransferFunction

PATHS = PLAIN.replace(light="path", samples=256)
SKY = Lighting((), ambient=1.0)


@pytest.fixture(scope="module")
def gpu():
    return Renderer().gpu


def test_white_furnace(gpu):
    """Matter that absorbs nothing cannot be told from an environment that is equal everywhere."""
    chosen = PATHS.replace(samples=32, path__bounces=2048)
    image, _, _ = draw(gpu, solid((16, 16, 16)), chosen, ramp(0.4), size=(8, 8), lighting=SKY)
    assert image[..., 3].max() > 0.9
    np.testing.assert_allclose(image[..., :3], image[..., 3:].repeat(3, -1), atol=2e-3)


def test_furnace_with_a_phase_function(gpu):
    chosen = PATHS.replace(samples=32, path__bounces=2048, path__anisotropy=0.7)
    image, _, _ = draw(gpu, solid((16, 16, 16)), chosen, ramp(0.4), size=(8, 8), lighting=SKY)
    np.testing.assert_allclose(image[..., :3], image[..., 3:].repeat(3, -1), atol=2e-3)


def test_opacity_of_paths_is_beer_lamberts(gpu):
    """20 voxels of opacity 0.1; black matter sends nothing back."""
    black = TransferFunction(((0.0, 0.0, 0.0, 0.0),), ((0.0, 0.0), (1.0, 0.1)))
    image, depth, _ = draw(gpu, solid((20, 24, 24)), PATHS, black, size=(16, 16), lighting=SKY)
    middle = image[4:12, 4:12]
    assert middle[..., 3].mean() == pytest.approx(1 - 0.9**20, abs=0.01)
    assert middle[..., :3].max() == 0
    # mean free path, cut at the far side; the camera's distance to the near side is that of the
    # first photons
    tau = -math.log(0.9)
    mean = 1 / tau - 20 * 0.9**20 / (1 - 0.9**20)
    front = Camera.fitted(np.array([[0, 0, 0], [23, 23, 19]]), orthographic=True)
    assert front.orthographic and depth[4:12, 4:12].std() < 0.3 * mean


@pytest.mark.parametrize("anisotropy", [0.0, 0.5])
def test_single_scattering_of_a_slab(gpu, anisotropy):
    """Light along the view: back-scattered once, attenuated on both ways."""
    lighting = Lighting((Light(direction=(0, 0, -1), intensity=1.0),), ambient=0.0)
    chosen = PATHS.replace(path__bounces=1, path__anisotropy=anisotropy, samples=512)
    image, _, _ = draw(
        gpu, solid((20, 40, 40)), chosen, ramp(0.1), size=(16, 16), lighting=lighting
    )
    g = anisotropy
    phase = (1 - g * g) / (4 * math.pi * (1 + g) ** 3)
    expected = math.pi * phase * 0.5 * (1 - 0.9**40)
    assert image[5:11, 5:11, 0].mean() == pytest.approx(expected, rel=0.02)


def test_more_bounces_bring_more_light_and_never_more_than_there_is(gpu):
    found = [
        draw(gpu, solid((16, 16, 16)), PATHS.replace(path__bounces=n, samples=64), ramp(0.3),
             size=(8, 8), lighting=SKY)[0][2:6, 2:6, 0].mean()
        for n in (1, 4, 64)
    ]  # fmt: skip
    assert found[0] < 0.8 * found[1] < 0.8 * found[2] <= 0.8


@pytest.mark.parametrize("light", ["path", "monte-carlo"])
def test_further_samples_are_added(light):
    """A picture of 2 samples on the way to 16 is not thrown away, and ends as 16 from scratch."""
    from scuro.render_settings import Settings
    from scuro.scene.items import VolumeItem
    from scuro.scene.scene import Scene

    volume = solid((12, 12, 12))
    scene = Scene([VolumeItem(volume, ramp(0.4))])
    scene.lighting = Lighting((), ambient=0.6)
    settings = Settings(size=(12, 12)).replace(volume__light=light, volume__samples=16)
    renderer = Renderer()
    camera = renderer.fitted(scene, settings)
    renderer.render(scene, camera, settings.replace(volume__samples=2))
    grown = renderer.render(scene, camera, settings).pixels
    renderer.restart()
    fresh = renderer.render(scene, camera, settings).pixels
    fewer = renderer.render(scene, camera, settings.replace(volume__samples=2)).pixels
    assert np.abs(grown.astype(int) - fresh).max() <= 1
    assert np.abs(grown.astype(int) - fewer).max() > 1


SLICES = PLAIN.replace(light="slices", occlusion__on=True, occlusion__attenuation=1.0, step=0.25)


def test_narrow_slices_attenuate_by_beers_law(gpu):
    """With no aperture, what a depth emits is attenuated by what lies before it, twice."""
    chosen = SLICES.replace(occlusion__slice_angle=0.1)
    image, _, _ = draw(gpu, solid((20, 24, 24)), chosen, ramp(0.1), size=(8, 8))
    assert image[4, 4, 3] == pytest.approx(1 - 0.9**20, abs=0.01)
    # a slice's own matter does not occlude it: half a step less than the integral
    assert image[4, 4, 0] == pytest.approx(0.5 * (1 - 0.9**40), rel=0.03)


def test_slices_blur_openness_by_the_disc(gpu):
    """Under the rim of a half plane, openness is an error function of the disc's moments."""
    from scipy.special import ndtr

    n, gap = 64, 24
    values = np.zeros((40, n, n), np.float32)
    values[36:38, :, : n // 2] = 1.0  # opaque, towards the viewer
    values[36 - gap - 2 : 36 - gap] = 0.4
    volume_transfer = TransferFunction(
        WHITE, ((0.0, 0.0), (0.39, 0.0), (0.4, 0.05), (0.41, 0.0), (0.9, 0.0), (1.0, 0.99))
    )
    from scuro.scene.volume import Volume

    chosen = SLICES.replace(occlusion__angle=60.0, step=0.5)
    camera = Camera((31.5, 31.5, 300.0), (31.5, 31.5, 20.0), height=64.0)
    image, _, _ = draw(gpu, Volume(values), chosen, volume_transfer, camera=camera, size=(64, 64))
    row = image[32, 32:, 0] / np.maximum(image[32, 32:, 3], 1e-6)
    # each of the slices between adds r²/4 to the variance, r = step tan θ
    sigma = math.sqrt((gap + 1) / 0.5 * (0.5 * math.tan(math.radians(60))) ** 2 / 4)
    x = np.arange(32) + 0.5
    np.testing.assert_allclose(row[2:20], ndtr(x / sigma)[2:20], atol=0.03)


def test_slices_heed_clipping(gpu):
    chosen = SLICES.replace(occlusion__on=True, occlusion__slice_angle=0.1)
    clip = Clip((Plane((12, 12, 9.5), (0, 0, -1)),))
    image, _, _ = draw(gpu, solid((20, 24, 24)), chosen, ramp(0.1), size=(8, 8), clip=clip)
    assert image[4, 4, 3] == pytest.approx(1 - 0.9**10, abs=0.01)


@pytest.mark.parametrize("light", ["monte-carlo", "image"])
def test_deep_matter_is_marched_to_its_end(gpu, light):
    """More iterations than a software adapter grants one invocation: rays go on in pieces."""
    volume = solid((300, 20, 20))
    chosen = PLAIN.replace(
        light=light, step=0.25, samples=4, occlusion__on=True, occlusion__angle=1.0,
        occlusion__attenuation=1.0, occlusion__length=2.0, constant_exact=True, occlusion__gap=1.75,
    )  # fmt: skip
    image, _, _ = draw(gpu, volume, chosen, ramp(0.01), size=(4, 4))
    assert image[2, 2, 3] == pytest.approx(1 - 0.99**300, abs=2e-3)
    tau = -math.log(0.99)
    depth = np.linspace(0, 300, 20001)
    seen = np.exp(-tau * (depth + np.clip(depth - 1, 0, None)))
    assert image[2, 2, 0] == pytest.approx(tau * np.trapezoid(seen, depth), rel=0.03)
