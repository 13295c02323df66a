"""Ray-primitive intersections against closed forms in double precision."""

import numpy as np
import pytest
from harness import evaluate

NOTHING = 1e38
SPAN = "vec4f(value.near, value.far, 0.0, 0.0)"


def _rows(n, seed=1):
    """Rays around the origin: random, parallel to an axis, and in coordinate planes."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(n, 3))
    directions[: n // 4] = np.eye(3)[rng.integers(0, 3, n // 4)] * rng.choice([-1, 1], (n // 4, 1))
    directions[np.arange(n // 4, n // 2), rng.integers(0, 3, n // 2 - n // 4)] = 0
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    aim = rng.normal(size=(n, 3)) * 0.7
    origins = aim - directions * rng.uniform(-1, 12, (n, 1))  # a twelfth starts beyond or inside
    return np.float32(origins), np.float32(directions)


def _sphere(o, d, c, r):
    """Entry and exit, NaN for a miss, of the ray's line; d may be a rounded unit vector."""
    d = d / np.linalg.norm(d, axis=-1, keepdims=True)
    to = c - o
    along = np.sum(to * d, axis=-1)
    square = r**2 - np.sum((to - along[..., None] * d) ** 2, axis=-1)
    half = np.sqrt(np.where(square >= 0, square, np.nan))
    return along - half, along + half, square


def _double(*arrays):
    return [np.asarray(a, np.float64) for a in arrays]


@pytest.mark.parametrize(("scale", "away"), [(1, 0), (100, 0), (1, 1000)])
def test_sphere_span(scale, away):
    """Also spheres a hundred times larger, and a thousand radii away: no cancellation."""
    o, d = _rows(4000)
    rng = np.random.default_rng(2)
    r = np.float32(rng.uniform(0.3, 2, len(o)) * scale)
    o = np.float32(o * scale - away * d)
    c = np.float32(rng.normal(size=o.shape) * 0.2 * scale)
    got = evaluate("ray.wgsl", "sphere_span(Ray(a.xyz, b.xyz), c.xyz, c.w)", result=SPAN,
                   a=o, b=d, c=np.column_stack([c, r]))  # fmt: skip
    near, far, square = _sphere(*_double(o, d, c), r.astype(float))
    size = np.abs(o).max(axis=1) + r
    clear = np.abs(square) > 1e-5 * size * r  # grazing rays may go either way
    assert clear.mean() > 0.9
    hit = np.isfinite(near)
    assert np.array_equal((got[:, 0] < NOTHING)[clear], hit[clear])
    both = clear & hit
    # an error of e across the ray moves the entry by e * off / half
    steep = np.maximum(1, r / np.sqrt(np.abs(square)))
    assert np.all(np.abs(got[:, 0] - near)[both] <= (1e-6 * size * steep)[both])
    assert np.all(np.abs(got[:, 1] - far)[both] <= (1e-6 * size * steep)[both])


def _march(inside, o, d, reach=20.0, steps=1000):
    """First and last distance in [-reach, reach] inside a solid, refined by bisection."""
    t = np.linspace(-reach, reach, steps)
    state = inside(o[:, None] + t[None, :, None] * d[:, None])
    found = state.any(axis=1)
    first, last = state.argmax(axis=1), steps - 1 - state[:, ::-1].argmax(axis=1)

    def edge(out, into):
        for _ in range(40):
            middle = (out + into) / 2
            here = inside(o[:, None] + middle[:, None, None] * d[:, None])[:, 0]
            into, out = np.where(here, middle, into), np.where(here, out, middle)
        return into

    return (
        found,
        edge(t[np.maximum(first - 1, 0)], t[first]),
        edge(t[np.minimum(last + 1, steps - 1)], t[last]),
    )


def _ends(n, seed):
    rng = np.random.default_rng(seed)
    a = np.float32(rng.normal(size=(n, 3)) * 0.5)
    axis = rng.normal(size=(n, 3))
    axis[: n // 3] = np.eye(3)[rng.integers(0, 3, n // 3)]
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    return a, np.float32(a + axis * rng.uniform(0.5, 2.5, (n, 1))), rng


def _compare_solid(got, inside, o, d):
    """Entry and exit of a convex solid against bisection; chords below the march's step aside."""
    got = got.astype(np.float64)
    found, near, far = _march(inside, *_double(o, d))
    hit = got[:, 0] < NOTHING
    chord = np.where(found, far - near, np.where(hit, got[:, 1] - got[:, 0], 0))
    clear = (chord > 0.1) | (~found & ~hit)
    assert clear.mean() > 0.9
    assert np.array_equal(hit[clear], found[clear])
    both = clear & found
    assert both.sum() > 100
    assert np.abs(got[:, 0] - near)[both].max() < 5e-5
    assert np.abs(got[:, 1] - far)[both].max() < 5e-5


def test_cylinder_span():
    o, d = _rows(600, 3)
    a, b, rng = _ends(len(o), 4)
    d[:60] = np.float32((b - a) / np.linalg.norm(b - a, axis=1, keepdims=True))[
        :60
    ]  # down the axis
    r = np.float32(rng.uniform(0.2, 1, len(o)))
    got = evaluate("ray.wgsl", "cylinder_span(Ray(a.xyz, b.xyz), c.xyz, d.xyz, c.w)", result=SPAN,
                   a=o, b=d, c=np.column_stack([a, r]), d=b)  # fmt: skip
    a64, b64 = _double(a, b)
    axis = b64 - a64
    length = np.linalg.norm(axis, axis=1)
    axis /= length[:, None]

    def inside(p):
        h = np.einsum("nkj,nj->nk", p - a64[:, None], axis)
        off = p - a64[:, None] - h[..., None] * axis[:, None]
        return (h >= 0) & (h <= length[:, None]) & (np.linalg.norm(off, axis=2) <= r[:, None])

    _compare_solid(got, inside, o, d)


def test_a_cylinder_without_length_is_missed():
    o, d = _rows(8)
    got = evaluate("ray.wgsl", "cylinder_span(Ray(a.xyz, b.xyz), c.xyz, c.xyz, 1.0)", result=SPAN,
                   a=o, b=d, c=np.zeros_like(o))  # fmt: skip
    assert np.all(got[:, 0] > NOTHING)


def test_cone_span():
    """The rounded cone is the union of the spheres from end to end: its distance field."""
    o, d = _rows(600, 5)
    a, b, rng = _ends(len(o), 6)
    ra, rb = (np.float32(rng.uniform(0.2, 0.9, len(o))) for _ in range(2))
    ra[:20] = rb[:20] + 2.8  # one end swallows the other
    got = evaluate("ray.wgsl", "cone_span(Ray(a.xyz, b.xyz), c.xyz, d.xyz, c.w, d.w)", result=SPAN,
                   a=o, b=d, c=np.column_stack([a, ra]), d=np.column_stack([b, rb]))  # fmt: skip
    _compare_solid(got, lambda p: rounded_cone(p, a, b, ra, rb) <= 0, o, d)


def rounded_cone(p, a, b, ra, rb):
    """Signed distance of points (n, k, 3) to n rounded cones (Quilez, 'rounded cone')."""
    a, b, ra, rb = _double(a, b, ra, rb)
    ba = (b - a)[:, None]
    pa = p - a[:, None]
    l2 = np.sum(ba * ba, axis=2)
    rr = (ra - rb)[:, None]
    a2 = l2 - rr * rr
    y = np.sum(pa * ba, axis=2)
    z = y - l2
    cross = pa * l2[..., None] - ba * y[..., None]
    x2 = np.sum(cross * cross, axis=2)
    y2, z2 = y * y * l2, z * z * l2
    k = np.sign(rr) * rr * rr * x2
    with np.errstate(invalid="ignore"):
        side = (np.sqrt(x2 * np.maximum(a2, 0) / l2) + y * rr) / l2 - ra[:, None]
    at_b, at_a = np.sqrt(x2 + z2) / l2 - rb[:, None], np.sqrt(x2 + y2) / l2 - ra[:, None]
    out = np.where(np.sign(z) * a2 * z2 > k, at_b, np.where(np.sign(y) * a2 * y2 < k, at_a, side))
    return np.where(a2 > 0, out, np.minimum(at_a, at_b))


def test_cone_normal_is_the_gradient_of_the_distance():
    a, b, rng = _ends(600, 7)
    ra, rb = (np.float32(rng.uniform(0.2, 0.6, len(a))) for _ in range(2))
    p = np.float32(a + rng.normal(size=a.shape))
    step = 1e-5 * np.eye(3)
    gradient = (
        np.stack(
            [
                rounded_cone((p + s)[:, None], a, b, ra, rb)[:, 0]
                - rounded_cone((p - s)[:, None], a, b, ra, rb)[:, 0]
                for s in step
            ],
            1,
        )
        / 2e-5
    )
    # onto the surface along the gradient
    p = np.float32(p - rounded_cone(p[:, None], a, b, ra, rb) * gradient)
    got = evaluate("ray.wgsl", "cone_normal(a.xyz, b.xyz, c.xyz, b.w, c.w)",
                   result="vec4f(value, 0.0)", a=p,
                   b=np.column_stack([a, ra]), c=np.column_stack([b, rb]))  # fmt: skip
    outside = np.linalg.norm(gradient, axis=1) > 0.99
    assert outside.mean() > 0.9
    assert np.quantile(np.sum(got[:, :3] * gradient, axis=1)[outside], 0.01) > 0.9999


def test_triangle_hit():
    o, d = _rows(4000, 8)
    rng = np.random.default_rng(9)
    a, b, c = (np.float32(rng.normal(size=o.shape) * 2) for _ in range(3))
    got = evaluate("ray.wgsl", "triangle_hit(Ray(a.xyz, b.xyz), c.xyz, d.xyz, e.xyz)",
                   result="vec4f(value, 0.0)", a=o, b=d, c=a, d=b, e=c)  # fmt: skip
    # o + t d = a + u (b - a) + v (c - a), by a 3 x 3 solve
    o64, d64, a64, b64, c64 = _double(o, d, a, b, c)
    t, u, v = np.linalg.solve(np.stack([-d64, b64 - a64, c64 - a64], 2), (o64 - a64)[..., None])[
        ..., 0
    ].T
    w = np.minimum(np.minimum(u, v), 1 - u - v)
    clear = np.abs(w) > 1e-4
    hit = got[:, 0] < NOTHING
    assert np.array_equal(hit[clear], (w >= 0)[clear])
    both = hit & clear
    assert both.sum() > 300
    error = np.abs(got[:, :3] - np.stack([t, u, v], 1))[both] / (1 + np.abs(t[both]))[:, None]
    assert np.quantile(error, 0.99) < 1e-4


def test_a_ray_in_the_plane_of_a_triangle_misses_it():
    o = np.float32([[-5, 0.2, 0]])
    got = evaluate("ray.wgsl", "triangle_hit(Ray(a.xyz, b.xyz), c.xyz, d.xyz, e.xyz)",
                   result="vec4f(value, 0.0)", a=o, b=np.float32([[1, 0, 0]]),
                   c=np.float32([[0, 0, 0]]), d=np.float32([[1, 0, 0]]),
                   e=np.float32([[0, 1, 0]]))  # fmt: skip
    assert got[0, 0] > NOTHING
