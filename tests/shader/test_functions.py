"""Codecs, colour, sampling and the camera's functions against closed forms and numpy twins."""

import numpy as np
import pytest
from harness import evaluate

from scuro.passes.frame import view_uniform
from scuro.scene.camera import Camera
from scuro.trace.pack import morton, octahedral

VECTOR = "vec4f(value, 0.0)"


def _units(n, seed=1):
    v = np.random.default_rng(seed).normal(size=(n, 3))
    v[:6] = np.concatenate([np.eye(3), -np.eye(3)])
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def test_octahedral_codec_returns_the_vector_and_agrees_with_numpy():
    n = _units(3000)
    back = evaluate("octahedral.wgsl", "octahedral_decode(octahedral_encode(n.xyz))",
                    result=VECTOR, n=n)[:, :3]  # fmt: skip
    assert np.abs(back - n).max() < 1e-4
    ours = evaluate("octahedral.wgsl", "octahedral_decode(bitcast<u32>(n.x))",
                    result=VECTOR, n=octahedral(n))[:, :3]  # fmt: skip
    assert np.abs(ours - n).max() < 1e-4


def test_srgb_is_the_standard_and_its_own_inverse():
    linear = np.linspace(0, 1, 500)[:, None] * np.ones(3)
    wanted = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    got = evaluate("color.wgsl", "srgb_from_linear(c.xyz)", result=VECTOR, c=linear)[:, :3]
    assert np.abs(got - wanted).max() < 2e-6
    back = evaluate("color.wgsl", "linear_from_srgb(c.xyz)", result=VECTOR, c=got)[:, :3]
    assert np.abs(back - linear).max() < 2e-6


def test_luminance_of_white_is_one():
    got = evaluate("color.wgsl", "luminance(c.xyz)", c=np.ones((1, 3)))
    assert got[0, 0] == pytest.approx(1, abs=1e-6)


def test_cosine_directions_are_cosine_weighted():
    """Mean of cos is 2/3 and of cos² is 1/2; all around the normal alike."""
    count = 20_000
    normal = np.tile(_units(9)[8], (count, 1))
    u = np.random.default_rng(3).random((count, 2))
    got = evaluate("sampling.wgsl", "cosine_direction(n.xyz, sphere_direction(u.xy))",
                   result=VECTOR, n=normal, u=u)[:, :3]  # fmt: skip
    cosine = np.sum(got * normal, axis=1)
    assert cosine.min() >= -1e-6
    assert np.allclose(np.linalg.norm(got, axis=1), 1, atol=1e-5)
    assert cosine.mean() == pytest.approx(2 / 3, abs=4 * 0.236 / np.sqrt(count))
    assert (cosine**2).mean() == pytest.approx(1 / 2, abs=4 * 0.289 / np.sqrt(count))
    # P(cos² < x) = x: Kolmogorov-Smirnov at 0.1 %
    steps = np.sort(cosine**2)
    assert np.abs(steps - (np.arange(count) + 0.5) / count).max() < 1.95 / np.sqrt(count)
    side = got - cosine[:, None] * normal
    assert np.abs(side.mean(axis=0)).max() < 4 * 0.5 / np.sqrt(count)


def test_r2_points_fill_the_square_evenly():
    points = evaluate("sampling.wgsl", "r2_point(bitcast<u32>(n.x), vec2u(7u, 9u))",
                      result="vec4f(value, 0.0, 0.0)", n=np.arange(1024))[:, :2]  # fmt: skip
    assert points.min() >= 0 and points.max() < 1
    counts, _, _ = np.histogram2d(*points.T, bins=16, range=((0, 1), (0, 1)))
    assert counts.min() >= 2 and counts.max() <= 6, "random points would spread from 0 to 10"


def test_tangent_frames_are_right_handed_and_orthonormal():
    n = _units(1000, 5)
    columns = [
        evaluate("sampling.wgsl", f"tangent_frame(n.xyz)[{k}]", result=VECTOR, n=n)[:, :3]
        for k in range(3)
    ]
    frame = np.stack(columns, 2)
    assert np.abs(np.einsum("nij,nik->njk", frame, frame) - np.eye(3)).max() < 1e-5
    assert np.abs(np.linalg.det(frame) - 1).max() < 1e-5
    assert np.abs(columns[2] - n).max() < 1e-6


@pytest.mark.parametrize("height", [None, 7.0], ids=["perspective", "orthographic"])
def test_a_pixel_and_its_ray_and_position_agree_with_the_camera(height):
    """view_ray, view_position and pixel_from_view against the camera's 4 x 4 matrices."""
    camera = Camera((3, 4, 9), (0.5, 0, 0), (0.1, 1, 0), 40.0, height)
    size, tile, jitter = (640, 360), (32, 16), (0.25, -0.125)
    uniform = view_uniform(camera, np.zeros(3), size, tile=tile, jitter=jitter)
    rng = np.random.default_rng(1)
    pixel = rng.random((500, 2)) * 200
    depth = rng.uniform(1, 30, (500, 1))
    shared = {"resources": {"view": uniform}, "p": np.hstack([pixel, depth])}
    position = evaluate("view.wgsl", "view_position(p.xy, p.z)", result=VECTOR, **shared)[:, :3]
    back = evaluate("view.wgsl", "pixel_from_view(view_position(p.xy, p.z))", result=VECTOR,
                    **shared)[:, :3]  # fmt: skip
    assert np.abs(back - shared["p"]).max() < 1e-3
    assert np.allclose(position[:, 2], -depth[:, 0], rtol=1e-6)
    # by matrices: the picture's place in clip space, y up
    clip = np.column_stack([position, np.ones(500)]) @ camera.clip_from_view(16 / 9, 0.1, 50.0).T
    picture = clip[:, :2] / clip[:, 3:]
    place = (picture * [1, -1] * 0.5 + 0.5) * size
    assert np.abs(place - (pixel + tile + jitter)).max() < 1e-3
    # the ray passes through the position
    ray = [
        evaluate("view.wgsl", f"scene_ray(p.xy).{part}", result=VECTOR, **shared)[:, :3]
        for part in ("origin", "direction")
    ]
    world = np.column_stack([position, np.ones(500)]) @ np.linalg.inv(camera.view_from_world()).T
    to = world[:, :3] - ray[0]
    off = to - np.sum(to * ray[1], axis=1, keepdims=True) * ray[1]
    assert np.linalg.norm(off, axis=1).max() < 1e-4
    t = evaluate("view.wgsl", "ray_distance(p.xy, p.z)", **shared)[:, 0]
    assert np.abs(ray[0] + t[:, None] * ray[1] - world[:, :3]).max() < 1e-4


def test_picture_interval_bounds_a_sphere_tightly():
    """Against the silhouette of many directions on the sphere's tangent cone."""
    rng = np.random.default_rng(4)
    along, ahead, radius = (
        rng.uniform(-6, 6, 300),
        rng.uniform(2.5, 20, 300),
        rng.uniform(0.1, 2, 300),
    )
    camera = Camera()
    got = evaluate("view.wgsl", "picture_interval(s.x, s.y, s.z)",
                   result="vec4f(value, 0.0, 0.0)", s=np.column_stack([along, ahead, radius]),
                   resources={"view": view_uniform(camera, np.zeros(3), (64, 64))})  # fmt: skip
    middle = np.arctan2(along, ahead)
    half = np.arcsin(radius / np.hypot(along, ahead))
    assert np.abs(got[:, 0] - np.tan(middle - half)).max() < 1e-4
    assert np.abs(got[:, 1] - np.tan(middle + half)).max() < 1e-4


def test_quaternions_turn_as_their_matrices_do():
    from scuro.scene.geometry import rotation_matrices

    rng = np.random.default_rng(6)
    q = rng.normal(size=(200, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    v = rng.normal(size=(200, 3))
    got = _turn(q, v)
    assert np.abs(got - np.einsum("nij,nj->ni", rotation_matrices(q), v)).max() < 1e-5


def _turn(q, v):
    """``rotate`` is in a file that declares the whole scene: bind a small one."""
    from harness import gpu

    from scuro.scene.clip import Clip
    from scuro.trace import build_accelerator

    resources, constants = build_accelerator(gpu(), [], np.zeros(3)).clipped(Clip())
    return evaluate("scene.wgsl", "rotate(q, v.xyz)", result=VECTOR, q=q, v=v,
                    resources=resources, constants=constants)[:, :3]  # fmt: skip


def test_morton_codes_interleave_bits():
    cells = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1023, 1023, 1023], [2, 0, 1]], np.uint32)
    assert morton(cells).tolist() == [1, 2, 4, (1 << 30) - 1, 0b1100]
