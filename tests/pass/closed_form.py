"""Primary visibility by brute force in double precision: the truth for tests of the tracer.

Every primitive of every instance is intersected with every ray by its own closed form, written
apart from the shaders'.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scuro.scene.clip import Clip
from scuro.scene.geometry import Body, rotation_matrices


@dataclass
class Seen:
    """What each of n rays sees first; ``t`` is infinite where nothing."""

    t: NDArray
    normal: NDArray
    element: NDArray
    instance: NDArray
    object: NDArray
    cap: NDArray
    depth: NDArray = field(repr=False)
    """How deep a cap lies in its solid, 0 at the middle."""
    inside: NDArray = field(repr=False)
    """Whether the surface is a mesh seen from behind."""


def rays(view_from_world: NDArray, clip_from_view: NDArray, size: tuple[int, int]):
    """Origins and unit directions (h w, 3) through pixel centres, from the camera's matrices."""
    width, height = size
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    world_from_clip = np.linalg.inv(clip_from_view @ view_from_world)

    def at(depth: float) -> NDArray:
        clip = np.stack([2 * x - 1, 1 - 2 * y, np.full_like(x, depth), np.ones_like(x)], -1)
        world = clip.reshape(-1, 4) @ world_from_clip.T
        return world[:, :3] / world[:, 3:]

    direction = at(0.5) - at(1.0)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    eye = np.linalg.inv(view_from_world)
    if clip_from_view[3, 3] == 0:
        return np.broadcast_to(eye[:3, 3], direction.shape), direction
    start = at(1.0)
    back = np.sum((start - eye[:3, 3]) * eye[:3, 2], axis=1)
    return start - back[:, None] * eye[:3, 2], direction


def trace(bodies: list[Body], clip: Clip, o: NDArray, d: NDArray) -> Seen:
    """The first surface along each ray."""
    n = len(o)
    seen = Seen(
        np.full(n, np.inf), np.zeros((n, 3)), *(np.full(n, -1) for _ in range(3)),
        np.zeros(n, bool), np.full(n, np.inf), np.zeros(n, bool),
    )  # fmt: skip
    near, far, plane_normal = _kept(clip, o, d)
    instance = 0
    for index, body in enumerate(bodies):
        low, high, face = (near, far, plane_normal) if body.clipped else (
            np.full(n, -np.inf), np.full(n, np.inf), plane_normal)  # fmt: skip
        for matrix, position in zip(rotation_matrices(body.rotations), body.positions, strict=True):
            for solid in _solids(body, matrix, position):
                _consider(seen, solid, o, d, low, high, face, (instance, index))
            instance += 1
    # the far wall of a closed mesh that a plane opens: the ray passes the plane inside the mesh
    clipped = np.array([*(b.clipped for b in bodies), False])[seen.object]
    cap = seen.inside & clipped & (near > 0)
    seen.t = np.where(cap, near, seen.t)
    seen.normal = np.where(cap[:, None], plane_normal, seen.normal)
    return seen


def _kept(clip: Clip, o: NDArray, d: NDArray):
    near, far = np.full(len(o), -np.inf), np.full(len(o), np.inf)
    normal = np.zeros_like(o)
    for plane in clip.equations():
        height, slope = o @ plane[:3] + plane[3], d @ plane[:3]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -height / slope
        entering = (slope > 0) & (t > near)
        near, normal = np.where(entering, t, near), np.where(entering[:, None], -plane[:3], normal)
        far = np.where(slope < 0, np.minimum(far, t), far)
        far = np.where((slope == 0) & (height < 0), -np.inf, far)
    return near, far, normal


def _consider(seen, solid, o, d, low, high, face, ids):
    entry, leave = solid.span(o, d)
    start = np.maximum(low, 0)
    open_ = (entry >= start) & (entry < high) & (entry < seen.t)
    cap = (low > 0) & (entry < low) & (leave > low) & (low < high) & solid.solid
    point = o + np.where(cap, low, 0)[:, None] * d
    depth = np.where(cap, solid.inner(point), np.inf)
    cap &= (low < seen.t) | ((low == seen.t) & (depth < seen.depth))
    t = np.where(cap, low, entry)
    for chosen, capped in ((open_ & ~cap, False), (cap, True)):
        if not chosen.any():
            continue
        p = o[chosen] + t[chosen, None] * d[chosen]
        seen.t[chosen] = t[chosen]
        seen.normal[chosen] = face[chosen] if capped else solid.normal(p, d[chosen])
        seen.element[chosen] = solid.element(p)
        seen.instance[chosen], seen.object[chosen] = ids
        seen.cap[chosen] = capped
        seen.depth[chosen] = depth[chosen]
        seen.inside[chosen] = False
        if not (capped or solid.solid):
            seen.inside[chosen] = solid.from_behind(d[chosen])


def _solids(body: Body, matrix: NDArray, position: NDArray):
    def place(points):
        return np.asarray(points, np.float64) @ matrix.T + position

    g = body.geometry
    for row, element in zip(g.spheres.astype(float), g.sphere_ids, strict=True):
        yield Sphere(place(row[:3]), row[3], element)
    for (a, b), elements in zip(g.rods.astype(float), g.rod_ids, strict=True):
        kind = Cylinder if a[3] == b[3] else Cone
        yield kind(place(a[:3]), place(b[:3]), a[3], b[3], elements)
    for corners, normals, elements in zip(
        g.triangles, g.triangle_normals, g.triangle_ids, strict=True
    ):
        yield Triangle(place(corners), normals.astype(float) @ matrix.T, elements)


def _quadratic(a, b, c):
    """Roots of a t² + 2 b t + c, NaN where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        return (-b - root) / a, (-b + root) / a


def _span(*candidates):
    """Least and greatest of what is a number; (inf, -inf) where nothing is."""
    table = np.stack(candidates)
    return (
        np.where(np.isnan(table), np.inf, table).min(axis=0),
        np.where(np.isnan(table), -np.inf, table).max(axis=0),
    )


@dataclass
class Sphere:
    center: NDArray
    radius: float
    id: int
    solid = True

    def span(self, o, d):
        to = o - self.center
        return _span(*_quadratic(1.0, np.sum(to * d, 1), np.sum(to * to, 1) - self.radius**2))

    def normal(self, p, d):
        return (p - self.center) / self.radius

    def element(self, p):
        return self.id

    def inner(self, p):
        return np.linalg.norm(p - self.center, axis=1) / self.radius


@dataclass
class Cylinder:
    a: NDArray
    b: NDArray
    ra: float
    rb: float
    ids: NDArray
    solid = True

    def __post_init__(self):
        self.length = np.linalg.norm(self.b - self.a)
        self.axis = (self.b - self.a) / self.length

    def _along(self, p):
        return (p - self.a) @ self.axis

    def span(self, o, d):
        h, k = self._along(o), d @ self.axis
        po, pd = o - self.a - h[:, None] * self.axis, d - k[:, None] * self.axis
        near, far = _quadratic(
            np.sum(pd * pd, 1), np.sum(po * pd, 1), np.sum(po * po, 1) - self.ra**2
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.sort(np.stack([-h / k, (self.length - h) / k]), axis=0)
        near, far = np.maximum(near, ends[0]), np.minimum(far, ends[1])
        missed = ~(near <= far)
        return np.where(missed, np.inf, near), np.where(missed, -np.inf, far)

    def normal(self, p, d):
        h = self._along(p)[:, None]
        side = (p - self.a - h * self.axis) / self.ra
        end = np.where(h > self.length / 2, self.axis, -self.axis)
        # on which of the two surfaces the point lies better: a rim's width must not be guessed
        off_side = self.ra * np.abs(np.linalg.norm(side, axis=1, keepdims=True) - 1)
        off_end = np.minimum(np.abs(h), np.abs(h - self.length))
        return np.where(off_end < off_side, end, side)

    def element(self, p):
        return self.ids[(self._along(p) > self.length / 2).astype(int)]

    def inner(self, p):
        h = np.clip(self._along(p) / self.length, 0, 1)[:, None]
        radius = (1 - h[:, 0]) * self.ra + h[:, 0] * self.rb
        return np.linalg.norm(p - self.a - h * (self.b - self.a), axis=1) / radius


class Cone(Cylinder):
    """The convex hull of two spheres."""

    def __post_init__(self):
        super().__post_init__()
        self.sine = (self.ra - self.rb) / self.length
        self.cosine = np.sqrt(1 - self.sine**2)

    def span(self, o, d):
        spheres = [*Sphere(self.a, self.ra, 0).span(o, d), *Sphere(self.b, self.rb, 0).span(o, d)]
        spheres = [np.where(np.isinf(t), np.nan, t) for t in spheres]
        # the side: |across| cos = ra - h sin
        h, k = self._along(o), d @ self.axis
        po, pd = o - self.a - h[:, None] * self.axis, d - k[:, None] * self.axis
        c2, s = self.cosine**2, self.sine
        roots = _quadratic(
            c2 * np.sum(pd * pd, 1) - (s * k) ** 2,
            c2 * np.sum(po * pd, 1) + (self.ra - s * h) * s * k,
            c2 * np.sum(po * po, 1) - (self.ra - s * h) ** 2,
        )
        sides = []
        for t in roots:
            height = h + t * k
            between = (height > self.ra * s) & (height < self.length + self.rb * s)
            sides.append(np.where(between, t, np.nan))
        return _span(*spheres, *sides)

    def normal(self, p, d):
        h = self._along(p)
        across = p - self.a - h[:, None] * self.axis
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-30)
        side = self.cosine * across + self.sine * self.axis
        at_a, at_b = (p - self.a) / self.ra, (p - self.b) / self.rb
        below, above = h <= self.ra * self.sine, h >= self.length + self.rb * self.sine
        return np.where(below[:, None], at_a, np.where(above[:, None], at_b, side))


@dataclass
class Triangle:
    corners: NDArray
    normals: NDArray
    ids: NDArray
    solid = False

    def _weights(self, p):
        a, b, c = self.corners
        basis = np.stack([b - a, c - a], 1)
        uv = np.linalg.lstsq(basis, (p - a).T, rcond=None)[0].T
        return np.column_stack([1 - uv.sum(axis=1), uv])

    def span(self, o, d):
        a, b, c = self.corners
        flat = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = ((a - o) @ flat) / (d @ flat)
        finite = np.isfinite(t)
        within = self._weights(o + np.where(finite, t, 0)[:, None] * d).min(axis=1) >= 0
        t = np.where(finite & within, t, np.inf)
        return t, np.where(np.isinf(t), -np.inf, t)

    def from_behind(self, d):
        a, b, c = self.corners
        return d @ np.cross(b - a, c - a) > 0

    def normal(self, p, d):
        n = self._weights(p) @ self.normals
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        return np.where(np.sum(n * d, 1, keepdims=True) > 0, -n, n)

    def element(self, p):
        return self.ids[self._weights(p).argmax(axis=1)]

    def inner(self, p):
        return np.full(len(p), np.inf)
