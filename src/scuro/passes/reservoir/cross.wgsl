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

fn meet(passage: ptr<function, Passage>, t: f32, at: vec3f, face: i32, entered: i32, slack: f32) {
    if (t < (*passage).near) {
        (*passage).near = t;
        (*passage).near_at = at;
    }
    // of exits equally far (thin cells), one by another face than the ray came in by
    if (t - select(0.0, slack, face == entered) > (*passage).far) {
        (*passage).far = t;
        (*passage).far_at = at;
        (*passage).far_face = face;
    }
}

fn inside(a: f32, b: f32, c: f32) -> bool {
    let sum = a + b + c;
    return (min(a, min(b, c)) >= 0.0 || max(a, max(b, c)) <= 0.0) && sum != 0.0;
}

fn side_at(face: i32, along: f32, down: f32) -> vec3f {
    switch face {
        case 0 { return vec3f(along, 0.0, down); }
        case 1 { return vec3f(1.0, along, down); }
        case 2 { return vec3f(along, 1.0, down); }
        default { return vec3f(0.0, along, down); }
    }
}

fn one_sided(a: vec4f, b: vec4f) -> bool {
    let low = min(a, b);
    let high = max(a, b);
    return min(min(low.x, low.y), min(low.z, low.w)) > 0.0
        || max(max(high.x, high.y), max(high.z, high.w)) < 0.0;
}

// Whether all corners lie on one side of the ray: a quick test before crossing.
fn misses(seen: Seen, top: vec4f, bottom: vec4f) -> bool {
    return one_sided(seen.u + top * seen.slope_u, seen.u + bottom * seen.slope_u)
        || one_sided(seen.v + top * seen.slope_v, seen.v + bottom * seen.slope_v);
}

// Cross the solid between two surfaces of a column, given their heights at the pillars.
fn cross_cell(seen: Seen, top: vec4f, bottom: vec4f, entered: i32, slack: f32) -> Passage {
    let tu = seen.u + top * seen.slope_u;
    let tv = seen.v + top * seen.slope_v;
    let td = seen.d + top * seen.slope_d;
    let bu = seen.u + bottom * seen.slope_u;
    let bv = seen.v + bottom * seen.slope_v;
    let bd = seen.d + bottom * seen.slope_d;
    var out = Passage(NOTHING, -NOTHING, vec3f(0.0), vec3f(0.0), NO_FACE);
    // sides run from corner p to corner q, in the same sense on both sides of a shared face
    let p_d = td.xywx;
    let q_d = td.yzzw;
    let p_below = bd.xywx;
    let q_below = bd.yzzw;
    let edge_top = tu.xywx * tv.yzzw - tv.xywx * tu.yzzw;
    let edge_bottom = bu.xywx * bv.yzzw - bv.xywx * bu.yzzw;
    let down = tu * bv - tv * bu;
    let down_p = down.xywx;
    let down_q = down.yzzw;
    let diagonal = tu.xywx * bv.yzzw - tv.xywx * bu.yzzw;
    for (var n = 0; n < 4; n++) {
        // corners p, q above and q below
        if (inside(down_q[n], -diagonal[n], edge_top[n])) {
            let w = vec3f(down_q[n], -diagonal[n], edge_top[n]) / (down_q[n] - diagonal[n] + edge_top[n]);
            let t = dot(w, vec3f(p_d[n], q_d[n], q_below[n]));
            meet(&out, t, side_at(n, w.y + w.z, w.z), n, entered, slack);
        }
        // corner p above, q and p below
        if (inside(-edge_bottom[n], -down_p[n], diagonal[n])) {
            let w = vec3f(-edge_bottom[n], -down_p[n], diagonal[n])
                / (diagonal[n] - edge_bottom[n] - down_p[n]);
            let t = dot(w, vec3f(p_d[n], q_below[n], p_below[n]));
            meet(&out, t, side_at(n, w.y, w.y + w.z), n, entered, slack);
        }
    }
    cross_cap(&out, edge_top, tu.x * tv.z - tv.x * tu.z, td, TOP, entered, slack);
    cross_cap(&out, edge_bottom, bu.x * bv.z - bv.x * bu.z, bd, BOTTOM, entered, slack);
    return out;
}

// The top or bottom face: triangles (0, 1, 2) and (0, 2, 3).
fn cross_cap(
    out: ptr<function, Passage>, edges: vec4f, diagonal: f32, d: vec4f, face: i32, entered: i32,
    slack: f32,
) {
    let r = f32(face - TOP);
    if (inside(edges.y, -diagonal, edges.x)) {
        let w = vec3f(edges.y, -diagonal, edges.x) / (edges.x + edges.y - diagonal);
        meet(out, dot(w, d.xyz), vec3f(w.y + w.z, w.z, r), face, entered, slack);
    }
    if (inside(-edges.z, -edges.w, diagonal)) {
        let w = vec3f(-edges.z, -edges.w, diagonal) / (diagonal - edges.z - edges.w);
        meet(out, dot(w, d.xzw), vec3f(w.y, w.y + w.z, r), face, entered, slack);
    }
}
