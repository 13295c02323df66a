"""Ray casting of volumes and the Gaussian cones, against closed forms and numpy twins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scuro.passes.frame import view_uniform
from scuro.passes.volume.cone_sections import cone_sections, section_amplitude
from scuro.passes.volume.draw import VolumePicture
from scuro.passes.volume.settings import VolumeSettings
from scuro.render import Renderer
from scuro.scene.camera import Camera
from scuro.scene.clip import Clip, Plane
from scuro.scene.lights import Light, Lighting
from scuro.scene.volume import Volume
from scuro.style.transfer import TransferFunction

PLAIN = VolumeSettings(shading="none", jitter=0.0, cutoff=0.0).replace(occlusion__on=False)
WHITE = ((0.0, 1.0, 1.0, 1.0), (1.0, 1.0, 1.0, 1.0))


@pytest.fixture(scope="module")
def gpu():
    return Renderer().gpu


def ramp(opacity: float) -> TransferFunction:
    """White; opacity rises with the value, from 0 at 0 to ``opacity`` at 1."""
    return TransferFunction(WHITE, ((0.0, 0.0), (1.0, opacity)))


def draw(
    gpu, volume, settings, transfer, *, camera=None, size=(32, 32), clip=None, lighting=None, **more
):
    """(height, width, 4) premultiplied linear colour and opacity, depths, and the picture kept."""
    from scuro.passes.compose.lighting import lights_uniform

    center = volume.bounds.mean(axis=0)
    camera = camera or Camera.fitted(volume.bounds, orthographic=True, margin=1.0)
    lighting = lighting or Lighting((), ambient=1.0)
    picture = VolumePicture(gpu, volume, center)
    color, depth = gpu.texture(size, "rgba16float"), gpu.texture(size, "r32float")
    record = gpu.recorder()
    picture.draw(
        record,
        settings,
        transfer,
        view=view_uniform(camera, center, size),
        lights=lights_uniform(lighting, camera, center, shadows=settings.shadow.on),
        size=size,
        color=color,
        depth=depth,
        clip=clip,
        **more,
    )
    record.submit()
    return gpu.read_texture(color).astype(float), gpu.read_texture(depth), picture


def solid(shape=(24, 24, 24), value=1.0, **fields) -> Volume:
    values = np.full(shape, value, np.float32)
    values[0, 0, 0] = 0.0  # gives the values a range
    return Volume(values, **fields)


def ball(n=48, radius=16.0, matrix=None) -> Volume:
    """Values fall linearly from 1 in the middle through 0.5 on a sphere (in voxels)."""
    z, y, x = np.indices((n, n, n)) - (n - 1) / 2
    distance = np.sqrt(x * x + y * y + z * z)
    values = np.clip(1 - 0.5 * distance / radius, 0, 1).astype(np.float32)
    return Volume(values, np.eye(4) if matrix is None else matrix)


@pytest.mark.parametrize("jitter", [0.0, 1.0])
@pytest.mark.parametrize("step", [0.5, 1.7, 6.0])
def test_a_shell_thinner_than_a_step_is_neither_missed_nor_found_twice(gpu, step, jitter):
    """Where values are linear along rays the integral over a segment is that over its values."""
    count = 40
    values = np.broadcast_to(np.linspace(0, 1, count)[:, None, None], (count, 8, 8))
    volume = Volume(np.ascontiguousarray(values, np.float32))
    points = ((0.0, 0.0), (0.59, 0.0), (0.6, 0.9), (0.61, 0.0))
    shell = TransferFunction(WHITE, points)
    settings = PLAIN.replace(step=step, jitter=jitter)
    color, _, _ = draw(gpu, volume, settings, shell, size=(16, 16))
    extinction = -np.log1p(-shell.table(0.0, 1.0, 1024)[:, 3].astype(float))
    expected = 1 - np.exp(-(count - 1) * np.trapezoid(extinction, dx=1 / 1023))
    assert 0.2 < expected < 0.8
    # values are half floats: one in 2,000
    np.testing.assert_allclose(color[6:10, 6:10, 3], expected, atol=4e-3)


@pytest.mark.parametrize("high", [0.8, 0.86, 0.93])
def test_thin_matter_is_not_lost_behind_values_of_dense_matter(gpu, high):
    """The integrals' differences stay exact where the sum before them is large."""
    count = 40
    values = np.full((count, 8, 8), 0.75, np.float32)
    values[::2] = high
    values[0, 0, 0], values[0, 0, 1] = 0.0, 1.0  # give the values their whole range
    opacity = 5e-5
    points = ((0.0, 0.999), (0.5, 0.999), (0.51, 0.0), (0.6, 0.0), (0.7, opacity), (1.0, opacity))
    color, _, _ = draw(gpu, Volume(values), PLAIN, TransferFunction(WHITE, points), size=(16, 16))
    assert color[6:10, 6:10, 3].mean() == pytest.approx(count * opacity, rel=0.01)


@pytest.mark.parametrize("step", [0.25, 0.5, 1.0])
def test_transmittance_of_a_constant_medium(gpu, step):
    """24 voxels of opacity 0.1 leave 0.9^24, whatever the step."""
    image, _, _ = draw(gpu, solid(), PLAIN.replace(step=step), ramp(0.1))
    assert image[16, 16, 3] == pytest.approx(1 - 0.9**24, abs=2e-3)
    np.testing.assert_allclose(image[16, 16, :3], image[16, 16, 3], rtol=1e-3)


def test_skipping_empty_space_does_not_change_the_picture(gpu):
    rng = np.random.default_rng(5)
    values = np.zeros((40, 36, 44), np.float32)
    for z, y, x in rng.integers(2, 34, (25, 3)):
        values[z : z + 3, y : y + 2, x : x + 3] = rng.random()
    volume, transfer = Volume(values), ramp(0.6)
    camera = Camera.fitted(volume.bounds).orbited(33, 21)
    settings = PLAIN.replace(step=0.37)
    skipped, _, picture = draw(gpu, volume, settings, transfer, camera=camera)
    distances = gpu.read_buffer(
        picture.classified(transfer, settings).distances, np.uint32
    )  # fmt: skip
    assert distances.max() >= 3, "nothing to skip in this test"
    # opacity that nobody can see makes every block count as occupied
    faint = TransferFunction(WHITE, ((0.0, 1e-7), (1.0, 0.6)))
    walked, _, picture = draw(gpu, volume, settings, faint, camera=camera)
    assert gpu.read_buffer(picture.classified(faint, settings).distances, np.uint32).max() == 0
    np.testing.assert_allclose(skipped, walked, atol=2e-3)


def test_distances_are_chebyshev_distances(gpu):
    from scipy.ndimage import distance_transform_cdt

    values = np.zeros((64, 48, 80), np.float32)
    values[30, 20, 50] = values[5, 40, 9] = 1.0
    volume = Volume(values)
    _, _, picture = draw(gpu, volume, PLAIN, ramp(0.5), size=(4, 4))
    found = gpu.read_buffer(picture.classified(ramp(0.5), PLAIN).distances, np.uint32)
    blocks = picture.grid.blocks
    found = found[: math.prod(blocks)].reshape(blocks[::-1])
    expected = distance_transform_cdt(found > 0, metric="chessboard")
    np.testing.assert_array_equal(found, expected)
    assert (found == 0).sum() <= 16


def test_voxels_that_are_not_cubes(gpu):
    """A ball of voxels 1 × 2 × 0.5 is an ellipsoid: its silhouette's axes are as 1 to 2."""
    volume = ball(matrix=np.diag([1.0, 2.0, 0.5, 1.0]))
    camera = Camera((0, 0, 500), (23.5, 47, 12), height=110.0)
    camera = Camera((23.5, 47.0, 500.0), (23.5, 47.0, 12.0), height=110.0)
    settings = PLAIN.replace(iso=0.5)
    image, depth, _ = draw(gpu, volume, settings, ramp(1.0), camera=camera, size=(220, 220))
    seen = image[..., 3] > 0.5
    # half a scene unit a pixel: radius 16 voxels along x and y
    assert np.ptp(np.nonzero(seen.any(axis=0))[0]) / 2 == pytest.approx(32, abs=1.5)
    assert np.ptp(np.nonzero(seen.any(axis=1))[0]) / 2 == pytest.approx(64, abs=1.5)
    # and half of 16 deep along z
    assert depth[110, 110] == pytest.approx(500 - 23.5 / 2 - 8, abs=0.1)


def test_isosurface_depth_is_refined(gpu):
    volume = ball()
    camera = Camera((23.5, 23.5, 200.0), (23.5, 23.5, 23.5), height=50.0)
    _, depth, _ = draw(gpu, volume, PLAIN.replace(iso=0.5, step=1.0), ramp(1), camera=camera)
    x = (np.arange(32) + 0.5 - 16) / 32 * 50
    expected = 200 - 23.5 - np.sqrt(np.clip(16**2 - x[16] ** 2 - x**2, 0, None))
    middle = slice(9, 23)
    np.testing.assert_allclose(depth[16, middle], expected[middle], atol=0.08)


def test_clipping_cuts_and_lights_the_cut_face(gpu):
    volume = solid((32, 32, 32))
    camera = Camera.fitted(volume.bounds, orthographic=True, margin=1.0)
    clip = Clip((Plane((16, 16, 10), (0, 0, -1)),))
    image, _, _ = draw(gpu, volume, PLAIN, ramp(0.1), clip=clip, camera=camera)
    assert image[16, 16, 3] == pytest.approx(1 - 0.9**10.5, abs=2e-3)
    # the cut face has the plane's normal: a light along the view lights it fully
    lit = PLAIN.replace(shading="phong", specular=0.0)
    lighting = Lighting((Light(direction=(0, 0, -1), intensity=0.75),), ambient=0.0)
    image, _, _ = draw(gpu, volume, lit, ramp(1.0), clip=clip, camera=camera, lighting=lighting)
    assert image[16, 16, 0] == pytest.approx(0.75, abs=0.02)


def test_gap_of_sections_follows_appendix_a():
    sections = cone_sections(20.0, 200.0, most_cones=7)
    spacing, level, _, weight = sections.table.T
    assert sections.counts == (1, 3, len(level) - 4) and sections.starts[0] == 3.0
    sigma = 2.0**level
    np.testing.assert_allclose(spacing[:-1], 1.25 * (sigma[:-1] + sigma[1:]))
    assert weight[0] == pytest.approx(0.5 * math.sqrt(2 * math.pi))
    np.testing.assert_allclose(weight[1:], 1.25 * (sigma[:-1] + sigma[1:]) / 2)
    # every section but those of the last level is at most 2 sigma wide
    distance = 3 + np.concatenate([[0], np.cumsum(spacing)[:-1]])
    ratio = np.repeat([1, 2 * math.sqrt(3) - 3, 1 / 3], sections.counts)
    assert (distance * math.tan(math.radians(20)) * ratio <= 2 * sigma + 1e-5).all()
    assert (np.diff(level) >= 0).all() and (level[:4] == 0).all()


def test_amplitude_of_narrow_sections_tends_to_its_limit():
    assert section_amplitude(1e-9, 1.0) == pytest.approx(4 / math.pi, rel=1e-6)
    # 68.27 % of a Gaussian lies within one deviation
    assert section_amplitude(1.0, 1.0) == pytest.approx(0.682689**2 * 2, rel=1e-5)


def test_pyramid_is_a_gaussian_pyramid(gpu):
    """Each level of an opacity impulse is a Gaussian twice as wide, and keeps the sum."""
    from scipy.ndimage import gaussian_filter

    values = np.zeros((64, 64, 64), np.float32)
    values[31:33, 31:33, 31:33] = 1.0
    settings = PLAIN.replace(occlusion__on=True)
    transfer = ramp(0.8)
    _, _, picture = draw(gpu, Volume(values), settings, transfer, size=(4, 4))
    pyramid = picture.pyramid(picture.classified(transfer, settings), settings, Clip())
    assert pyramid.bytes <= 2 * values.size * (1 + 1 / 7)
    for level, factor in ((0, 1), (1, 2), (2, 4)):
        found = 1 - np.exp(-gpu.read_texture(pyramid.texture, mip=level).astype(float))
        smooth = gaussian_filter(values * 0.8, factor, truncate=6)
        # texel centres of a level lie between voxels
        expected = smooth.reshape(64 // factor, factor, 64 // factor, factor, -1, factor)
        expected = expected.mean(axis=(1, 3, 5))
        assert found.sum() * factor**3 == pytest.approx(0.8 * 8, rel=0.03)
        np.testing.assert_allclose(found, expected, atol=0.15 * expected.max())


def test_pyramid_is_isotropic_in_space(gpu):
    """Voxels of 1 × 1 × 3: the blur is a third as many voxels wide along z."""
    values = np.zeros((24, 48, 48), np.float32)
    values[12, 24, 24] = 1.0
    volume = Volume(values, np.diag([1.0, 1.0, 3.0, 1.0]))
    settings = PLAIN.replace(occlusion__on=True)
    _, _, picture = draw(gpu, volume, settings, ramp(0.9), size=(4, 4))
    pyramid = picture.pyramid(picture.classified(ramp(0.9), settings), settings, Clip())
    level = 1 - np.exp(-gpu.read_texture(pyramid.texture, mip=0).astype(float))
    sigma_x = math.sqrt((level * (np.arange(48) - 24) ** 2).sum() / level.sum())
    assert sigma_x == pytest.approx(5 / 3, rel=0.05)


def light_of(gpu, volume, transfer, at, **settings):
    """Precomputed visibility and shadow at a world position."""
    chosen = VolumeSettings(shading="none", light_all=True, light_resolution=1.0).replace(
        occlusion__attenuation=1.0, shadow__attenuation=1.0, **settings
    )
    lighting = Lighting((Light(direction=(0, 0, -1), intensity=1.0),), ambient=0.5)
    _, _, picture = draw(gpu, volume, chosen, transfer, lighting=lighting, size=(8, 8))
    texels = gpu.read_texture(picture.keep("light", picture.grid.size, None).texture)
    texels = texels.astype(float)
    x, y, z = np.rint(np.linalg.inv(volume.world_from_index) @ [*at, 1])[:3].astype(int)
    return texels[z, y, x]


@pytest.mark.parametrize("orthographic", [True, False])
@pytest.mark.parametrize("size", [5, 12, 40])
def test_pictures_of_any_size_find_all_light_they_read(gpu, size, orthographic):
    x = np.indices((64, 64, 64)) / 63.0
    volume = Volume(np.float32(0.5 + 0.5 * np.sin(9 * x).prod(axis=0)), np.eye(4))
    camera = Camera.fitted(
        volume.bounds, direction=(0.5, 0.3, -1.0), orthographic=orthographic, margin=1.0
    )
    lighting = Lighting((Light(direction=(0, -1, -1), intensity=1.0),), ambient=0.5)
    pictures = [
        draw(
            gpu,
            volume,
            PLAIN.replace(occlusion__on=True, shadow__on=True, light_all=light_all),
            ramp(0.05),
            camera=camera,
            lighting=lighting,
            size=(size, size),
        )[0]
        for light_all in (True, False)
    ]
    np.testing.assert_allclose(pictures[1], pictures[0], atol=1e-3)


def met_in_a_slab(sections, tau: float, thickness: float) -> float:
    """Optical depth along a cone's axis from inside constant matter (numpy twin of A-1)."""
    spacing, level, amplitude, weight = sections.table.T.astype(float)
    distance = sections.starts[0] + np.concatenate([[0], np.cumsum(spacing)[:-1]])
    beyond = np.clip(distance - thickness, 0, None)
    now = tau * amplitude * np.exp(-0.5 * (beyond / 2**level) ** 2)
    return float((weight * (now + np.append(0.0, now[:-1]))).sum())


@pytest.mark.parametrize("cones", [1, 3, 7])
def test_cones_in_a_constant_medium(gpu, cones):
    """With weights exact for constants, a cone lets through what Beer's law says."""
    volume = solid((60, 60, 60))
    light = light_of(
        gpu, volume, ramp(0.02), (29, 29, 29), constant_exact=True, occlusion__angle=10.0,
        occlusion__cones=cones, shadow__on=True, shadow__angle=2.0, shadow__length=2.0,
    )  # fmt: skip
    tau = -math.log(0.98)
    diagonal = 60 * math.sqrt(3)
    for found, angle, length, most in zip(
        light[:2], (10.0, 2.0), (0.5, 2.0), (cones, 1), strict=True
    ):
        sections = cone_sections(angle, length * diagonal, most_cones=most, constant_exact=True)
        # the texel's middle lies half a voxel from the volume's
        assert -math.log(found) == pytest.approx(met_in_a_slab(sections, tau, 30.5), rel=0.03)
    # no falloff to speak of with narrow cones: the face less the gap, and half a sample's reach
    assert -math.log(light[1]) == pytest.approx(tau * (30.5 - 3 + 1.25), rel=0.06)


def test_the_thesis_weights_let_constant_media_through_too_light(gpu):
    """The bias that the thesis admits (section 3.5.1), and that ``constant_exact`` removes."""
    volume = solid((60, 60, 60))
    thesis = light_of(gpu, volume, ramp(0.02), (29, 29, 29), occlusion__cones=7)[0]
    exact = light_of(
        gpu, volume, ramp(0.02), (29, 29, 29), occlusion__cones=7, constant_exact=True
    )[0]
    assert -math.log(thesis) < 0.85 * -math.log(exact)


def test_open_and_covered(gpu):
    values = np.zeros((64, 64, 64), np.float32)
    values[40:44] = 1.0
    volume = Volume(values)
    above = light_of(gpu, volume, ramp(0.95), (32, 32, 50), shadow__on=True)
    below = light_of(gpu, volume, ramp(0.95), (32, 32, 20), shadow__on=True)
    np.testing.assert_allclose(above[:2], 1.0, atol=1e-3)
    assert (below[:2] < 0.05).all()


def test_image_and_object_space_agree(gpu):
    volume = ball(32, 8.0)
    settings = VolumeSettings(shading="none", jitter=0.0, light_resolution=1.0).replace(
        occlusion__attenuation=1.0
    )
    transfer = TransferFunction(WHITE, ((0.0, 0.0), (0.5, 0.0), (0.7, 0.4)))
    one, _, _ = draw(gpu, volume, settings, transfer)
    two, _, _ = draw(gpu, volume, settings.replace(light="image"), transfer)
    assert one[..., 0].max() > 0.3 and (one[16, 16, 0] < 0.98 * one[16, 16, 3])
    np.testing.assert_allclose(one, two, atol=0.03)


def test_monte_carlo_agrees_with_beer_lambert(gpu):
    """A slab seen from the front: the visibility of its last sample is the slab's transmittance."""
    volume = solid((20, 40, 40))
    settings = VolumeSettings(shading="none", jitter=0.0, light="monte-carlo", samples=64).replace(
        occlusion__angle=1.0, occlusion__length=2.0
    )
    image, _, _ = draw(gpu, volume, settings, ramp(0.1), size=(8, 8))
    tau = -math.log(0.9)
    # what each depth emits, attenuated by the ray and by its cone, which starts a voxel on
    depth = np.linspace(0, 20, 4001)
    cone = np.exp(-tau * np.clip(depth - 1, 0, None))
    expected = np.trapezoid(tau * np.exp(-tau * depth) * cone, depth)
    assert image[4, 4, 0] == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("method", ["voxel-cones", "summed-area", "local-sphere"])
def test_peers_in_a_constant_medium(gpu, method):
    """Every method weighs uniform matter by Beer's law, each over its own length."""
    volume = solid((60, 60, 60))
    found = light_of(
        gpu, volume, ramp(0.02), (29, 29, 29), light=method, occlusion__angle=5.0, radius=8.0
    )[0]  # fmt: skip
    length = 8 - 3 if method == "local-sphere" else 30.5 - 3
    assert -math.log(found) == pytest.approx(-math.log(0.98) * length, rel=0.06)


def test_summed_tables_are_exact(gpu):
    from scuro.passes.volume.summed import summed_table

    values = np.random.default_rng(7).random((20, 30, 25)).astype(np.float32)
    _, _, picture = draw(gpu, Volume(values), PLAIN, ramp(0.9), size=(4, 4))
    classified = picture.classified(ramp(0.9), PLAIN)
    table = gpu.read_buffer(summed_table(classified, picture.uniform(PLAIN, Clip(), classified)),
                            np.uint32)[: values.size].reshape(values.shape)  # fmt: skip
    box = np.diff(np.diff(np.diff(table.astype(np.int64), axis=0), axis=1), axis=2) / 1024
    expected = -np.log1p(-0.9 * values[1:, 1:, 1:])
    np.testing.assert_allclose(box, expected, atol=0.02)


def test_light_made_in_pieces_is_the_same(gpu, monkeypatch):
    monkeypatch.setattr("scuro.passes.volume.light.PIECE", 0.0)
    monkeypatch.setattr("scuro.passes.volume.light.FIRST_BRICKS", 7)
    x = np.indices((24, 24, 24)) / 23.0
    volume = Volume(np.float32(0.5 + 0.5 * np.sin(9 * x).prod(axis=0)), np.eye(4))
    settings = PLAIN.replace(occlusion__on=True)
    shares: list[float] = []
    whole, _, _ = draw(gpu, volume, settings, ramp(0.2))
    cut, _, _ = draw(gpu, volume, settings, ramp(0.2), breathe=shares.append)
    np.testing.assert_array_equal(cut, whole)
    assert len(shares) > 10 and shares == sorted(shares) and shares[-1] == 1.0
