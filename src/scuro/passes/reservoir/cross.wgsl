// Where a ray crosses a cell whose six faces are two triangles each.
//
// Corners are seen in a plane across the ray, with the ray at its origin: a triangle is hit where
// three cross products have one sign. Cells that share corners form the same products, so that no
// ray slips between them. Diagonals are the same from both sides of a face.

//#include "cells.wgsl"

// A ray and two directions across it.
struct Probe {
    ray: Ray,
    u: vec3f,
    v: vec3f,
}

fn probe_of(ray: Ray) -> Probe {
    let d = ray.direction;
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), abs(d.z) < 0.7);
    let u = normalize(cross(d, helper));
    return Probe(ray, u, cross(d, u));
}

// A column's pillars in the probe's axes: place at z = 0 and change over z, along u, v and the ray.
struct Seen {
    u: vec4f,
    v: vec4f,
    d: vec4f,
    slope_u: vec4f,
    slope_v: vec4f,
    slope_d: vec4f,
}

fn seen_from(probe: Probe, frame: Frame) -> Seen {
    let x = frame.x - probe.ray.origin.x;
    let y = frame.y - probe.ray.origin.y;
    let z = -probe.ray.origin.z;
    let d = probe.ray.direction;
    return Seen(
        x * probe.u.x + y * probe.u.y + z * probe.u.z,
        x * probe.v.x + y * probe.v.y + z * probe.v.z,
        x * d.x + y * d.y + z * d.z,
        frame.slope_x * probe.u.x + frame.slope_y * probe.u.y + probe.u.z,
        frame.slope_x * probe.v.x + frame.slope_y * probe.v.y + probe.v.z,
        frame.slope_x * d.x + frame.slope_y * d.y + d.z,
    );
}

const TOP: i32 = 4;
const BOTTOM: i32 = 5;
const NO_FACE: i32 = -1;

// Entry and exit: distance and parametric coordinates; the face of the exit (sides as in cells.wgsl).
struct Passage {
    near: f32,
    far: f32,
    near_at: vec3f,
    far_at: vec3f,
    far_face: i32,
}

// Hits of four triangles at once: distances, and two parametric coordinates on the face.
struct Hits {
    near: vec4f,
    far: vec4f,
    near_u: vec4f,
    near_v: vec4f,
    far_u: vec4f,
    far_v: vec4f,
}

// Barycentric weights of four triangles, not normalised; a hit where all have one sign.
struct Weights {
    sum: vec4f,
    hit: vec4<bool>,
}

fn weigh(a: vec4f, b: vec4f, c: vec4f) -> Weights {
    let sum = a + b + c;
    let low = min(a, min(b, c));
    let high = max(a, max(b, c));
    let one_sign = (low >= vec4f(0.0)) | (high <= vec4f(0.0));
    let hit = one_sign & (sum != vec4f(0.0));
    return Weights(select(vec4f(1.0), sum, hit), hit);
}

fn one_sided(a: vec4f, b: vec4f) -> bool {
    let low = min(a, b);
    let high = max(a, b);
    return min(min(low.x, low.y), min(low.z, low.w)) > 0.0
        || max(max(high.x, high.y), max(high.z, high.w)) < 0.0;
}

// A surface's four corners in the probe's axes.
struct Corners {
    u: vec4f,
    v: vec4f,
    d: vec4f,
}

fn corners_at(seen: Seen, z: vec4f) -> Corners {
    return Corners(
        seen.u + z * seen.slope_u,
        seen.v + z * seen.slope_v,
        seen.d + z * seen.slope_d,
    );
}

// Whether all corners lie on one side of the ray: a quick test before crossing.
fn misses(top: Corners, bottom: Corners) -> bool {
    return one_sided(top.u, bottom.u) || one_sided(top.v, bottom.v);
}

// Cross the solid between two surfaces of a column. Of exits equally far (thin cells) one by another
// face than `entered` is taken: that one counts as nearer by `slack`.
fn cross_cell(top: Corners, bottom: Corners, entered: i32, slack: f32) -> Passage {
    let tu = top.u;
    let tv = top.v;
    let td = top.d;
    let bu = bottom.u;
    let bv = bottom.v;
    let bd = bottom.d;
    // sides run from corner p to corner q, in the same sense on both sides of a shared face
    let edge_top = tu.xywx * tv.yzzw - tv.xywx * tu.yzzw;
    let edge_bottom = bu.xywx * bv.yzzw - bv.xywx * bu.yzzw;
    let down = tu * bv - tv * bu;
    let diagonal = tu.xywx * bv.yzzw - tv.xywx * bu.yzzw;
    let faces = vec4i(0, 1, 2, 3);
    let sides = side_hits(td, bd, edge_top, edge_bottom, down, diagonal,
        select(vec4f(0.0), vec4f(slack), faces == vec4i(entered)));
    let caps = cap_hits(td, bd, edge_top, edge_bottom,
        tu.x * tv.z - tv.x * tu.z, bu.x * bv.z - bv.x * bu.z,
        select(vec4f(0.0), vec4f(slack), vec4i(TOP, TOP, BOTTOM, BOTTOM) == vec4i(entered)));

    var near = Choice(sides.near.x, sides.near_u.x, sides.near_v.x, 0);
    near = nearer(near, Choice(sides.near.y, sides.near_u.y, sides.near_v.y, 1));
    near = nearer(near, Choice(sides.near.z, sides.near_u.z, sides.near_v.z, 2));
    near = nearer(near, Choice(sides.near.w, sides.near_u.w, sides.near_v.w, 3));
    near = nearer(near, Choice(caps.near.x, caps.near_u.x, caps.near_v.x, TOP));
    near = nearer(near, Choice(caps.near.y, caps.near_u.y, caps.near_v.y, TOP));
    near = nearer(near, Choice(caps.near.z, caps.near_u.z, caps.near_v.z, BOTTOM));
    near = nearer(near, Choice(caps.near.w, caps.near_u.w, caps.near_v.w, BOTTOM));
    // the farthest is the nearest of negated distances
    var far = Choice(-sides.far.x, sides.far_u.x, sides.far_v.x, 0);
    far = nearer(far, Choice(-sides.far.y, sides.far_u.y, sides.far_v.y, 1));
    far = nearer(far, Choice(-sides.far.z, sides.far_u.z, sides.far_v.z, 2));
    far = nearer(far, Choice(-sides.far.w, sides.far_u.w, sides.far_v.w, 3));
    far = nearer(far, Choice(-caps.far.x, caps.far_u.x, caps.far_v.x, TOP));
    far = nearer(far, Choice(-caps.far.y, caps.far_u.y, caps.far_v.y, TOP));
    far = nearer(far, Choice(-caps.far.z, caps.far_u.z, caps.far_v.z, BOTTOM));
    far = nearer(far, Choice(-caps.far.w, caps.far_u.w, caps.far_v.w, BOTTOM));
    let missed = far.t >= NOTHING;
    let back = select(0.0, slack, far.face == entered);
    return Passage(
        near.t,
        back - far.t,
        face_at(near),
        face_at(far),
        select(far.face, NO_FACE, missed),
    );
}

struct Choice {
    t: f32,
    u: f32,
    v: f32,
    face: i32,
}

fn nearer(a: Choice, b: Choice) -> Choice {
    let second = b.t < a.t;
    return Choice(
        select(a.t, b.t, second),
        select(a.u, b.u, second),
        select(a.v, b.v, second),
        select(a.face, b.face, second),
    );
}

// Parametric coordinates of a place on a face.
fn face_at(at: Choice) -> vec3f {
    if (at.face >= TOP) {
        return vec3f(at.u, at.v, f32(at.face - TOP));
    }
    let along_s = (at.face & 1) == 0;
    let end = select(0.0, 1.0, at.face == 1 || at.face == 2);
    return vec3f(select(end, at.u, along_s), select(at.u, end, along_s), at.v);
}

// The four sides, each of triangles (p above, q above, q below) and (p above, q below, p below).
fn side_hits(
    td: vec4f, bd: vec4f, edge_top: vec4f, edge_bottom: vec4f, down: vec4f, diagonal: vec4f,
    slack: vec4f,
) -> Hits {
    let p_d = td.xywx;
    let q_below = bd.yzzw;
    let a = weigh(down.yzzw, -diagonal, edge_top);
    let a_scale = 1.0 / a.sum;
    let a_t = (down.yzzw * p_d - diagonal * td.yzzw + edge_top * q_below) * a_scale;
    let a_v = edge_top * a_scale;
    let a_u = a_v - diagonal * a_scale;
    let b = weigh(-edge_bottom, -down.xywx, diagonal);
    let b_scale = 1.0 / b.sum;
    let b_t = (diagonal * bd.xywx - edge_bottom * p_d - down.xywx * q_below) * b_scale;
    let b_u = -down.xywx * b_scale;
    let b_v = b_u + diagonal * b_scale;
    let a_near = select(vec4f(NOTHING), a_t, a.hit);
    let b_near = select(vec4f(NOTHING), b_t, b.hit);
    let a_far = select(vec4f(-NOTHING), a_t - slack, a.hit);
    let b_far = select(vec4f(-NOTHING), b_t - slack, b.hit);
    let first = a_near <= b_near;
    let last = a_far >= b_far;
    return Hits(
        min(a_near, b_near),
        max(a_far, b_far),
        select(b_u, a_u, first),
        select(b_v, a_v, first),
        select(b_u, a_u, last),
        select(b_v, a_v, last),
    );
}

// Top and bottom, each of triangles (0, 1, 2) and (0, 2, 3).
fn cap_hits(
    td: vec4f, bd: vec4f, edge_top: vec4f, edge_bottom: vec4f, diagonal_top: f32,
    diagonal_bottom: f32, slack: vec4f,
) -> Hits {
    let a = vec4f(edge_top.y, -edge_top.z, edge_bottom.y, -edge_bottom.z);
    let b = vec4f(-diagonal_top, -edge_top.w, -diagonal_bottom, -edge_bottom.w);
    let c = vec4f(edge_top.x, diagonal_top, edge_bottom.x, diagonal_bottom);
    let w = weigh(a, b, c);
    let scale = 1.0 / w.sum;
    let d0 = vec4f(td.xx, bd.xx);
    let d1 = vec4f(td.yz, bd.yz);
    let d2 = vec4f(td.zw, bd.zw);
    let t = (a * d0 + b * d1 + c * d2) * scale;
    let far = (b + c) * scale;
    let even = vec4<bool>(true, false, true, false);
    let u = select(b * scale, far, even);
    let v = select(far, c * scale, even);
    return Hits(
        select(vec4f(NOTHING), t, w.hit),
        select(vec4f(-NOTHING), t - slack, w.hit),
        u, v, u, v,
    );
}
