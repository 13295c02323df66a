"""Semantic occlusion against known answers: plates and balls in one region or in two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scuro.errors import SettingsError
from scuro.passes.frame import view_uniform
from scuro.passes.semantic.pipeline import halton_points
from scuro.passes.semantic.smooth import taps
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.scene.camera import Camera
from scuro.scene.geometry import Body, Geometry, Material
from scuro.scene.regions import Divided, Division, hierarchy_of, level_at
from scuro.scene.scene import Scene

SIZE = (96, 72)
MATTE = Material(specular=0.0)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def plate(z: float, half: float, color, path: tuple[str, ...], x: float = 0.0) -> Body:
    """A square in the plane z that faces +z."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float32) * half
    corners[:, 0] += x
    vertices = np.concatenate([corners, np.full((4, 1), z, np.float32)], axis=1)
    triangles = vertices[[[0, 1, 2], [0, 2, 3]]]
    normals = np.zeros_like(triangles)
    normals[..., 2] = 1
    colors = np.tile(np.array([*color, 255], np.uint8), (2, 3, 1))
    geometry = Geometry(
        triangles=triangles,
        triangle_normals=normals,
        triangle_colors=colors,
        triangle_ids=np.zeros((2, 3), np.int32),
    )
    return Body(geometry, name=path[-1], path=path, material=MATTE)


def ball(center, radius: float, color, path: tuple[str, ...]) -> Body:
    geometry = Geometry(
        spheres=np.array([[*center, radius]], np.float32),
        sphere_colors=np.array([[*color, 255]], np.uint8),
        sphere_ids=np.zeros(1, np.int32),
    )
    return Body(geometry, name=path[-1], path=path, material=MATTE)


def scene_of(*bodies: Body) -> Scene:
    """The bodies, and below them, unseen, a second compartment: so there are two levels."""
    scene = Scene()
    scene.extra_bodies += bodies
    scene.extra_bodies.append(ball((0, 0, -5), 0.5, (9, 9, 9), ("root", "B", "hidden")))
    return scene


def plate_under_plate(upper_path: tuple[str, ...]) -> Scene:
    """A wide plate with a small one 2 above its middle."""
    return scene_of(
        plate(0, 20, (200, 200, 200), ("root", "A", "floor")),
        plate(2, 3, (200, 80, 80), upper_path),
    )


def settings_of(**changes) -> Settings:
    base = {
        "mode": "screen",
        "samples": 64,
        "thresholds": (50.0, 40.0),
        "far_radius": 0.1,
        "bounce": 0.0,
        "shadow": 0.0,
        "calm": 0.0,
    } | changes
    semantic = {f"semantic__{k}": v for k, v in base.items()}
    return Settings(size=SIZE).replace(antialias__method="none", **semantic)


CAMERA = Camera((0, 0, 60), (0, 0, 0), (0, 1, 0), 30)
"""From straight above, beyond the first threshold."""


def buffers(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings, *names: str):
    image = renderer.render(scene, camera, settings)
    return [
        renderer.gpu.read_texture(image._frame.resources[name]).astype(np.float64)
        for name in names
    ]  # fmt: skip


BESIDE = (slice(34, 38), slice(56, 58))
"""Pixels of the lower plate just beside the edge of the upper one."""


def visibility_beside(renderer: Renderer, scene: Scene, settings: Settings, camera=CAMERA) -> float:
    return buffers(renderer, scene, camera, settings, "gathered")[0][BESIDE][..., 3].mean()


def test_only_another_region_occludes(renderer):
    other = visibility_beside(renderer, plate_under_plate(("root", "B", "lid")), settings_of())
    same = visibility_beside(renderer, plate_under_plate(("root", "A", "lid")), settings_of())
    assert same == pytest.approx(1.0, abs=1e-3)
    assert other < 0.95


def test_without_semantics_both_occlude_alike(renderer):
    plain = settings_of(mode="plain")
    other = visibility_beside(renderer, plate_under_plate(("root", "B", "lid")), plain)
    same = visibility_beside(renderer, plate_under_plate(("root", "A", "lid")), plain)
    assert other == pytest.approx(same, abs=1e-6)
    assert other < 0.95


@pytest.mark.parametrize("mode", ["screen", "traced"])
def test_between_thresholds_the_two_levels_results_are_interpolated(renderer, mode):
    # one region on the first level, two on the second
    scene = scene_of(
        plate(0, 20, (200, 200, 200), ("root", "A", "floor")),
        plate(2, 3, (200, 80, 80), ("root", "A", "lid")),
    )
    camera = Camera((0, 0, 45.0), (0, 0, 0), (0, 1, 0), 30)
    beside = (slice(34, 38), slice(58, 61))
    center = np.asarray(renderer.accelerator(scene).center)
    away = float(np.linalg.norm(np.subtract(camera.position, center)))

    def visible(first: float, second: float) -> np.ndarray:
        settings = settings_of(mode=mode, rays=128, thresholds=(first, second), blur_occlusion=0)
        return buffers(renderer, scene, camera, settings, "gathered")[0][beside][..., 3]

    coarse = visible(away, away / 2)
    fine = visible(2 * away, away)
    half = visible(1.5 * away, 0.5 * away)
    assert coarse.mean() > fine.mean() + 0.03
    # near occlusion fades with depth too, but a flat plate has none at this distance
    if mode == "traced":  # each ray belongs to one level, by chance: true in the mean
        coarse, fine, half = (values.mean() for values in (coarse, fine, half))
    np.testing.assert_allclose(half, (coarse + fine) / 2, atol=0.02 if mode == "screen" else 0.01)


def test_regions_buffer_holds_both_levels(renderer):
    scene = scene_of(
        plate(0, 20, (200, 200, 200), ("root", "A", "floor")),
        plate(2, 3, (200, 80, 80), ("root", "A", "lid")),
        plate(1, 3, (90, 80, 80), ("root", "B", "step"), x=10),
    )
    (regions,) = buffers(renderer, scene, CAMERA, settings_of(), "regions")
    floor, lid, step = regions[36, 20], regions[36, 48], regions[36, 71]
    assert floor[0] == lid[0] != step[0]
    assert len({floor[1], lid[1], step[1]}) == 3


def test_bounce_carries_the_senders_colour(renderer):
    # a white and a red ball side by side: each lights the other's flank
    scene = scene_of(
        ball((-1, 0, 0), 1.0, (255, 255, 255), ("root", "A", "white")),
        ball((1, 0, 0), 1.0, (255, 0, 0), ("root", "A", "red")),
    )
    camera = Camera((0, 0, 9), (0, 0, 0), (0, 1, 0), 30)
    bright = settings_of(bounce=1.0, thresholds=(100.0, 50.0), near_radius=1.5)
    bounce, ids = buffers(renderer, scene, camera, bright, "bounce", "ids")
    on_white, on_red = bounce[ids[..., 2] == 0], bounce[ids[..., 2] == 1]
    assert on_white[:, 0].sum() > 0.25
    assert on_white[:, 1].sum() < 0.05 * on_white[:, 0].sum(), "red light falls on the white ball"
    assert on_red[:, 1].sum() > 0.5 * on_red[:, 0].sum(), "white light falls on the red ball"
    distant = bright.replace(semantic__thresholds=(10.0, 5.0))
    (far,) = buffers(renderer, scene, camera, distant, "bounce")
    assert far[..., :3].max() == 0, "the bounce fades out with distance"


def wall_beside_floor() -> Scene:
    """A floor z = 0 for x > 0, and a red wall x = 0 at its edge, for z > 0."""
    floor = plate(0, 20, (255, 255, 255), ("root", "A", "floor"), x=20)
    wall = plate(0, 20, (255, 40, 40), ("root", "A", "wall"))
    corners = wall.geometry.triangles.reshape(-1, 3)
    # (x, y, 0) to (0, y, 20 - x): its front then looks along +x
    turned = np.stack([0 * corners[:, 0], corners[:, 1], 20 - corners[:, 0]], axis=1)
    normals = np.zeros_like(wall.geometry.triangle_normals)
    normals[..., 0] = 1
    standing = replace(
        wall.geometry,
        triangles=turned.reshape(2, 3, 3).astype(np.float32),
        triangle_normals=normals,
    )
    return scene_of(floor, Body(standing, name="wall", path=wall.path, material=MATTE))


def sum_of_equation_3_2(away: float, reach: float, skin: float) -> float:
    """Share of a wall's light that a floor so far from it gets, by a dense grid of samples."""
    u = (np.stack(np.meshgrid(*[np.arange(64)] * 3, indexing="ij"), axis=-1) + 0.5) / 64
    radius, turn = np.sqrt(u[..., 0]), 2 * np.pi * u[..., 1]
    x, y, z = radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - u[..., 0])
    step = reach * u[..., 2]
    # seen along (-1, 0, -1): what is behind the wall shows the wall beside it
    behind = -(away + step * x)
    occluded = behind * np.sqrt(2) > skin
    range_ = np.sqrt(away**2 + (step * y) ** 2 + (step * z + behind) ** 2)
    form = z * np.maximum(-x, 0) * reach / np.maximum(range_, 0.1 * reach)
    return float((occluded * form).mean())


@pytest.mark.parametrize("strength", [1.0, 2.0])
def test_a_wall_lights_a_floor_by_the_sum_of_equation_3_2(renderer, strength):
    size, height = (192, 144), 12.0
    settings = settings_of(bounce=strength, samples=256, thresholds=(100.0, 50.0), near_radius=6.0)
    settings = settings.replace(size=size)
    camera = Camera((30, 0, 30), (0, 0, 0), (0, 1, 0), height=height)
    scene = wall_beside_floor()
    bounce, diffuse, ids = buffers(renderer, scene, camera, settings, "bounce", "diffuse", "ids")
    reach, pixel = 6.0 * renderer.accelerator(scene).primitive_radius, height / size[1]
    assert reach == pytest.approx(3.0)
    rows = slice(36, 108, 2)
    assert (ids[rows, 60:95, 2] == 1).all() and (ids[rows, 97:140, 2] == 0).all()
    lit = diffuse[rows, 60:95, :3].mean(axis=(0, 1))
    for column in (98, 100, 104):
        away = (column + 0.5 - size[0] / 2) * pixel * np.sqrt(2)
        expected = strength * lit * sum_of_equation_3_2(away, reach, 0.5 * pixel)
        assert expected[0] > 0.005
        np.testing.assert_allclose(
            bounce[rows, column, :3].mean(axis=0), expected, rtol=0.06, atol=1e-4
        )


def test_a_bounce_is_spread_to_all_pixels_between_those_that_found_it(renderer):
    settings = settings_of(bounce=4.0, thresholds=(100.0, 50.0), near_radius=6.0, blur_bounce=6)
    camera = Camera((30, 0, 30), (0, 0, 0), (0, 1, 0), height=12.0)
    color, albedo, light, bounce, ids = buffers(
        renderer, wall_beside_floor(), camera, settings,
        "color", "albedo", "gathered_blurred", "bounce_blurred", "ids",
    )  # fmt: skip
    assert not bounce[1::2].any() and not bounce[:, 1::2].any()
    floor = np.s_[20:53, 50:81]
    assert (ids[floor][..., 2] == 0).all()
    spread = (color / np.maximum(albedo, 1e-3) - light)[floor][..., :3]
    found = bounce[floor][::2, ::2, :3]
    assert np.ptp(found[..., 0]) > 0.05
    beside = (found[:, :-1] + found[:, 1:]) / 2
    below = (found[:-1] + found[1:]) / 2
    np.testing.assert_allclose(spread[::2, ::2], found, atol=4e-3)
    np.testing.assert_allclose(spread[::2, 1::2], beside, atol=4e-3)
    np.testing.assert_allclose(spread[1::2, ::2], below, atol=4e-3)
    np.testing.assert_allclose(spread[1::2, 1::2], (beside[:-1] + beside[1:]) / 2, atol=4e-3)


def test_shadows_fall_between_regions_only(renderer):
    shade = settings_of(shadow=1.0, blur_shadow=0)
    high = ("root", "B", "lid")
    camera = Camera((0, 0, 60), (0, 0, 0), (0, 1, 0), 30)

    def darkest(path):
        scene = scene_of(
            plate(0, 20, (200, 200, 200), ("root", "A", "floor")), plate(3, 3, (200, 80, 80), path)
        )
        return buffers(renderer, scene, camera, shade, "lit")[0].min()

    assert darkest(high) == 0.0
    assert darkest(("root", "A", "lid")) == 1.0


def test_a_shadow_lies_where_the_way_to_the_light_goes_under_another_region(renderer):
    scene = plate_under_plate(("root", "B", "lid"))
    shade = settings_of(shadow=1.0, blur_shadow=0, shadow_steps=512)
    image = renderer.render(scene, CAMERA, shade)
    resources = image._frame.resources
    lit, ids = (renderer.gpu.read_texture(resources[name]) for name in ("lit", "ids"))
    towards = -np.asarray(resources["lights"]["list"][0]["direction"])
    # points of the floor, and those on their ways up to the lid
    pixel = 2 * 60 * CAMERA.half_height() / SIZE[1]
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    floor = np.stack([x - SIZE[0] / 2, SIZE[1] / 2 - y, 0 * x], axis=-1) * pixel
    ways = floor[..., None, :] + np.linspace(0, 2, 200)[:, None] * towards / towards[2]
    # what they are hidden by from the camera, 60 above: the lid, 2 above the floor
    seen = ways[..., :2] * 58 / (60 - ways[..., 2:])
    dark = (np.abs(seen) < 3).all(axis=-1).any(axis=-1)
    # away from borders, on the floor
    around = np.lib.stride_tricks.sliding_window_view(dark, (3, 3))
    sure = around.all(axis=(2, 3)) | ~around.any(axis=(2, 3))
    sure &= (np.lib.stride_tricks.sliding_window_view(ids[..., 2], (3, 3)) == 0).all(axis=(2, 3))
    # one pixel of four is looked at
    sure[::2] = sure[:, ::2] = False
    dark, found = dark[1:-1, 1:-1][sure], lit[1:-1, 1:-1][sure] == 0
    assert dark.sum() > 8
    np.testing.assert_array_equal(found, dark)


def test_shadows_reach_gaps_between_the_pixels_that_look_for_them(renderer):
    # a gap of one pixel between two lids, in a column of odd number
    scene = scene_of(
        plate(0, 20, (200, 200, 200), ("root", "A", "floor")),
        plate(2, 3, (200, 80, 80), ("root", "B", "lid"), x=-2.55),
        plate(2, 3, (200, 80, 80), ("root", "B", "lid"), x=3.85),
    )
    names = ("color", "ids", "gathered_blurred")
    color, ids, light = buffers(renderer, scene, CAMERA, settings_of(shadow=1.0), *names)
    gap, beside = np.s_[32:40, 49], np.s_[32:40, 47]
    assert (ids[gap][..., 2] == 0).all() and (ids[beside][..., 2] > 0).all()
    assert light[gap].min() > 0.1 and color[beside][:, 0].min() > 0.1
    assert color[gap][:, :3].max() == 0.0


def under_a_lid() -> tuple[Scene, Camera, Settings]:
    """Far away, with shadows but without bounce."""
    settings = settings_of(shadow=0.5, blur_occlusion=0, blur_shadow=0)
    return plate_under_plate(("root", "B", "lid")), CAMERA, settings


def side_by_side() -> tuple[Scene, Camera, Settings]:
    """So near that there are bounces but no shadows."""
    scene = scene_of(
        ball((-1, 0, 0), 1.0, (255, 255, 255), ("root", "A", "white")),
        ball((1, 0, 0), 1.0, (255, 0, 0), ("root", "A", "red")),
    )
    near = settings_of(bounce=1.0, thresholds=(100.0, 50.0), near_radius=1.5)
    near = near.replace(semantic__blur_occlusion=0, semantic__blur_bounce=0)
    return scene, Camera((0, 0, 9), (0, 0, 0), (0, 1, 0), 30), near


@pytest.mark.parametrize("case", [under_a_lid, side_by_side])
def test_combine_is_colour_times_light_times_shadow_plus_bounce(renderer, case):
    scene, camera, settings = case()
    names = ("color", "albedo", "gathered", "lit", "bounce", "surface")
    color, albedo, gathered, lit, bounce, surface = buffers(
        renderer, scene, camera, settings, *names
    )
    assert lit.min() < 0.9 or bounce[..., :3].max() > 0.1
    expected = albedo[..., :3] * (gathered[..., :3] * lit[..., None] + bounce[..., :3])
    there = surface[..., 3] > 0
    # other pixels have shadow and bounce of these about them
    color, expected, there = (buffer[::2, ::2] for buffer in (color, expected, there))
    np.testing.assert_allclose(color[there][:, :3], expected[there], rtol=4e-3, atol=2e-3)


def blurred_by_hand(source, surface, amount, depth_limit, normal_limit):
    """Algorithm 3 along x, in numpy; wide kernels leave pixels out."""
    stride = 1 + amount // 5
    offsets = [0, *(sign * i for i in range(1, amount + 1, stride) for sign in (-1, 1))]
    out = np.zeros_like(source)
    height, width = source.shape[:2]
    for y in range(height):
        for x in range(width):
            total = weights = 0.0
            for i in offsets:
                if not 0 <= x + i < width:
                    continue
                here, there = surface[y, x], surface[y, x + i]
                if abs(there[3] - here[3]) < depth_limit and there[:3] @ here[:3] > normal_limit:
                    w = np.exp(-((i / (max(amount, 1) * 1.5)) ** 2))
                    total, weights = total + w * source[y, x + i], weights + w
            out[y, x] = total / weights
    return out


def blurred_on_the_gpu(renderer, entry, constants, weights, surface, source, lit):
    """One dispatch of blur.wgsl along x."""
    gpu = renderer.gpu
    height, width = surface.shape[:2]
    out = gpu.texture((width, height), "rgba16float")
    tiles = np.array(
        [x | y << 16 for y in range(-(-height // 8)) for x in range(-(-width // 8))], np.uint32
    )
    blur = {"step": (1, 0), "taps": len(weights), "weights": weights or [(0,) * 4]}
    gpu.compute(
        "passes/semantic/blur.wgsl",
        entry,
        (8 * len(tiles), 8 if entry == "main" else 2),
        {
            "tile_list": gpu.buffer(tiles),
            "view": view_uniform(CAMERA, np.zeros(3), (width, height)),
            "blur": blur | {"depth_limit": 0.4, "normal_limit": -0.2},
            "surface": gpu.texture_from(surface, "rgba32float"),
            "source": gpu.texture_from(source, "rgba16float"),
            "lit": gpu.texture_from(lit, "rgba16float"),
            "blurred": out,
        },
        constants=constants,
    )
    return gpu.read_texture(out)


def random_surface(rng, height, width):
    surface = rng.normal(size=(height, width, 4)).astype(np.float32)
    surface[..., :3] /= np.linalg.norm(surface[..., :3], axis=-1, keepdims=True)
    surface[..., 3] = rng.uniform(5, 6, (height, width))
    return surface


@pytest.mark.parametrize("amounts", [(3, 5), (10, 3), (0, 4), (4, 0)])
def test_blur_is_algorithm_3_with_a_radius_for_each(renderer, amounts):
    rng = np.random.default_rng(3)
    light, lit = (rng.random((9, 17, 4)).astype(np.float16) for _ in range(2))
    surface = random_surface(rng, 9, 17)
    constants = {"HAS_SHADOW": True, "SHADOW_APART": True}
    found = blurred_on_the_gpu(renderer, "main", constants, taps(*amounts), surface, light, lit)
    expected = [
        blurred_by_hand(source.astype(float), surface, amount, 0.4, -0.2)
        for source, amount in zip((light, lit), amounts, strict=True)
    ]
    np.testing.assert_allclose(found[..., :3], expected[0][..., :3], atol=2e-3)
    np.testing.assert_allclose(found[..., 3], expected[1][..., 0], atol=2e-3)


def test_a_thin_blur_is_that_of_a_picture_of_half_the_size(renderer):
    rng = np.random.default_rng(5)
    source = rng.random((9, 17, 4)).astype(np.float16)
    surface = random_surface(rng, 9, 17)
    found = blurred_on_the_gpu(renderer, "thinly", {}, taps(3), surface, source, source)
    half = source[::2, ::2].astype(float)
    expected = blurred_by_hand(half, surface[::2, ::2], 3, 0.4, -0.2)
    np.testing.assert_allclose(found[::2, ::2, :3], expected[..., :3], atol=2e-3)
    assert not found[1::2].any() and not found[:, 1::2].any()


def test_far_pixels_spread_as_a_gaussian_and_near_ones_stay(renderer):
    gpu, rng = renderer.gpu, np.random.default_rng(4)
    color = rng.random((16, 24, 4)).astype(np.float16)
    view = view_uniform(CAMERA, np.zeros(3), (24, 16))
    pixel = 2 * view["half_extent"][1] / 16
    # two atoms a pixel on the left, a quarter of one on the right; nothing between
    depth = np.zeros((16, 24))
    depth[:, :10], depth[:, 14:] = 2 / pixel, 0.25 / pixel
    surface = np.zeros((16, 24, 4), np.float32)
    surface[..., 3] = depth
    replaced = gpu.texture((24, 16), "rgba16float")
    tiles = np.array([x | y << 16 for y in range(2) for x in range(3)], np.uint32)
    gpu.compute(
        "passes/semantic/still.wgsl",
        "main",
        (8 * len(tiles), 8),
        {
            "tile_list": gpu.buffer(tiles),
            "view": view,
            "still": {"spread": 0.4, "most": 0.7, "atom": 1.0},
            "surface": gpu.texture_from(surface, "rgba32float"),
            "color": gpu.texture_from(color, "rgba16float"),
            "replaced": replaced,
        },
    )
    found = gpu.read_texture(replaced).astype(float)
    weights = np.exp(-0.5 * (np.arange(-1, 2) / (0.4 * 1.5)) ** 2)
    kernel = np.outer(weights, weights) / weights.sum() ** 2
    around = np.lib.stride_tricks.sliding_window_view(color.astype(float), (3, 3), axis=(0, 1))
    expected = (around * kernel).sum(axis=(-2, -1))
    np.testing.assert_allclose(found[1:-1, 1:11], expected[:, :10], atol=2e-3)
    np.testing.assert_array_equal(found[:, 11:], color[:, 11:])


def test_zooming_never_jumps(renderer):
    rng = np.random.default_rng(0)
    bodies = [
        ball(rng.normal(size=3) * 6, 1.0, rng.integers(60, 255, 3), ("root", c, f"{c}{i}"))
        for c in "AB"
        for i in range(30)
    ]
    scene = scene_of(plate(-3, 40, (200, 200, 200), ("root", "C", "floor")), *bodies)
    settings = settings_of(
        thresholds=None, distance_to="target", bounce=0.5, shadow=0.5, samples=16
    )
    means = []
    for distance in np.geomspace(120, 40, 25):
        image = renderer.render(scene, Camera((0, 0, distance), (0, 0, 0), (0, 1, 0), 10), settings)
        means.append(np.asarray(image)[..., :3].mean() / 255)
    assert np.abs(np.diff(means)).max() < 0.02


def test_levels_and_blend_between_thresholds():
    steps = (100.0, 50.0, 10.0)
    assert level_at(200, steps) == (0, 0.0)
    assert level_at(75, steps) == (0, 0.5)
    assert level_at(50, steps) == (1, 0.0)
    assert level_at(20, steps) == (1, 0.75)
    assert level_at(1, steps) == (2, 0.0)


def test_thresholds_out_of_order_or_too_many_are_refused(renderer):
    with pytest.raises(SettingsError, match="far to near"):
        settings_of(thresholds=(10.0, 20.0))
    with pytest.raises(SettingsError, match="4 thresholds for 2 levels"):
        renderer.render(
            plate_under_plate(("root", "B", "lid")),
            CAMERA,
            settings_of(thresholds=(4.0, 3.0, 2.0, 1.0)),
        )


def body_at(*path: str, instances: int = 1) -> Body:
    geometry = Geometry(
        spheres=np.array([[0, 0, 0, 1], [3, 0, 0, 1]], np.float32),
        sphere_colors=np.zeros((2, 4), np.uint8),
        sphere_ids=np.arange(2, dtype=np.int32),
    )
    return Body(
        geometry,
        np.tile(np.array([0, 0, 0, 1], np.float32), (instances, 1)),
        np.zeros((instances, 3)),
        name=path[-1],
        path=path,
    )


def test_hierarchy_levels_refine_and_skip_what_divides_nothing():
    chains = Division("chain", np.array([0, 1], np.int32))
    found = hierarchy_of(
        [
            Divided(body_at("root", "plasma", "albumin", instances=3), (chains,)),
            Divided(body_at("root", "virus", "shell", "env"), (chains,)),
            Divided(body_at("root", "virus", "capsid", "inside", "rt"), (chains,)),
            Divided(body_at("root", "virus", "capsid", "inside", "nc"), (chains,)),
        ]
    )
    assert [level.name for level in found.levels] == [
        "compartment 1", "compartment 2", "ingredient", "instance", "chain",
    ]  # fmt: skip
    assert found.labels.tolist() == [[0, 1, 1, 1], [0, 1, 2, 2], [0, 1, 2, 3]]


def test_a_single_molecule_is_divided_by_its_chains():
    found = hierarchy_of(
        [Divided(body_at("mol"), (Division("chain", np.array([0, 1], np.int32)),))]
    )
    assert [level.name for level in found.levels] == ["chain"]


def test_traced_rays_pass_through_their_own_region(renderer):
    traced = settings_of(mode="traced", rays=64, shadow=1.0, blur_shadow=0)
    for path, open_ in ((("root", "B", "lid"), False), (("root", "A", "lid"), True)):
        scene = plate_under_plate(path)
        gathered, lit = buffers(renderer, scene, CAMERA, traced, "gathered", "lit")
        assert (gathered[BESIDE][..., 3].mean() > 0.999) == open_
        assert (lit.min() == 1.0) == open_


def test_traced_parts_of_one_molecule_shade_each_other():
    # two balls in one geometry: one region while they are one chain, two when they are two
    spheres = np.array([[0, 0, 0, 5], [0, 0, 7, 2]], np.float32)
    geometry = Geometry(
        spheres=spheres,
        sphere_colors=np.full((2, 4), 200, np.uint8),
        sphere_ids=np.arange(2, dtype=np.int32),
    )

    class Item:
        def __init__(self, *chains: int) -> None:
            self.chains = Division("chain", np.array(chains, np.int32))
            self.body = Body(geometry, name="pair", path=("pair",), material=MATTE)

        def bodies(self):
            return [self.body]

        def divided(self, parts):
            return [Divided(self.body, (self.chains,))]

    renderer = Renderer()
    settings = settings_of(mode="traced", rays=32, thresholds=(10.0,), far_radius=0.3)
    dark = []
    for chains in ((0, 0), (0, 1)):
        scene = Scene([Item(*chains)])
        gathered, surface = buffers(
            renderer, scene, Camera((0, -30, 40), (0, 0, 2), (0, 1, 0), 30), settings,
            "gathered", "surface",
        )  # fmt: skip
        dark.append((1 - gathered[..., 3])[surface[..., 3] > 0].max())
    assert dark[0] < 0.01 < 0.3 < dark[1]


def test_halton_points_are_radical_inverses():
    found = halton_points(1, 6)[:, :3]
    np.testing.assert_allclose(found[:, 0], [1 / 2, 1 / 4, 3 / 4, 1 / 8, 5 / 8, 3 / 8])
    np.testing.assert_allclose(found[:3, 1], [1 / 3, 2 / 3, 1 / 9], rtol=1e-6)
    np.testing.assert_array_equal(halton_points(4, 3), halton_points(1, 6)[3:])


@pytest.mark.parametrize("mode", ["screen", "traced"])
def test_frames_of_a_resting_camera_are_one_frame_of_all_their_samples(renderer, mode):
    scene = plate_under_plate(("root", "B", "lid"))
    few = settings_of(mode=mode, samples=4, rays=4, blur_occlusion=0)

    def accumulated(camera: Camera, settings: Settings) -> np.ndarray:
        frame = renderer.frame(scene, camera, settings, accumulate=True)
        frame.recorder.submit()
        return renderer.gpu.read_texture(frame.resources["gathered"])

    renderer.restart()
    for _ in range(8):
        mean = accumulated(CAMERA, few)
    many = settings_of(mode=mode, samples=32, rays=32, blur_occlusion=0)
    (at_once,) = buffers(renderer, scene, CAMERA, many, "gathered")
    np.testing.assert_allclose(mean, at_once, atol=2e-3)
    # a moved camera and other settings start anew: as far from the truth as a frame alone
    moved = Camera((0, 5, 60), (0, 0, 0), (0, 1, 0), 30)
    for camera, changes in ((moved, {}), (moved, {"semantic__far_radius": 0.05})):
        first = accumulated(camera, few.replace(**changes))
        (truth,) = buffers(renderer, scene, camera, many.replace(**changes), "gathered")
        (alone,) = buffers(renderer, scene, camera, few.replace(**changes), "gathered")
        there = truth[..., 3] > 0
        assert np.abs(first - truth)[there].mean() < 1.3 * np.abs(alone - truth)[there].mean()
