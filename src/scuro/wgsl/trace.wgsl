// The one tracer. Two levels of uniform grids (Amanatides & Woo 1987): a grid over instances, whose
// entries are rejected by bounding sphere, and a grid over each geometry's primitives.
//
//   trace_nearest(ray, t_min, t_max)       the first surface, caps of clipped solids included
//   trace_any(ray, t_min, t_max)           whether anything lies between
//
// Rays are in scene space (world minus scene center) with unit directions. Clipping planes bound
// every ray from the start: culled matter is not hit by any ray.

//#include "ray.wgsl"
//#include "scene.wgsl"

const NEAREST: u32 = 0u;
const ANY: u32 = 1u;

struct Hit {
    t: f32,
    // kind and slot; NO_PRIMITIVE for a miss
    primitive: u32,
    instance: u32,
    // 1 + index of the clipping plane on which a cap lies, 0 for a true surface
    cap: u32,
    // how deep the cap point lies in its solid, 0 at the center: decides between overlapping solids
    depth: f32,
}

const NO_HIT = Hit(NOTHING, NO_PRIMITIVE, 0u, 0u, 2.0);

// The part of a ray that the clipping planes keep.
struct Kept {
    near: f32,
    far: f32,
    // 1 + index of the plane through which the ray enters
    entry: u32,
}

fn kept_interval(ray: Ray) -> Kept {
    var kept = Kept(-NOTHING, NOTHING, 0u);
    for (var i = 0u; i < scene.plane_count; i += 1u) {
        let plane = scene.planes[i];
        let height = dot(plane.xyz, ray.origin) + plane.w;
        let slope = dot(plane.xyz, ray.direction);
        if (slope > 0.0) {
            let t = -height / slope;
            if (t > kept.near) {
                kept.near = t;
                kept.entry = i + 1u;
            }
        } else if (slope < 0.0) {
            kept.far = min(kept.far, -height / slope);
        } else if (height < 0.0) {
            kept.far = -NOTHING;
        }
    }
    return kept;
}

// Entry and exit of one primitive.
fn primitive_span(ray: Ray, primitive: u32) -> Span {
    let slot = slot_of(primitive);
    let a = slot_at(slot);
    let kind = kind_of(primitive);
    if (HAS_RODS && kind == ROD) {
        let b = slot_at(slot + 1u);
        return cylinder_span(ray, a.xyz, b.xyz, a.w);
    }
    if (HAS_RODS && kind == CONE) {
        let b = slot_at(slot + 1u);
        return cone_span(ray, a.xyz, b.xyz, a.w, b.w);
    }
    if (HAS_TRIANGLES && kind == TRIANGLE) {
        let t = triangle_hit(ray, a.xyz, slot_at(slot + 1u).xyz, slot_at(slot + 2u).xyz).x;
        return Span(t, t);
    }
    return sphere_span(ray, a.xyz, a.w);
}

// How deep p lies in a solid primitive: 0 on its axis or center, 1 on its surface.
fn primitive_depth(p: vec3f, primitive: u32) -> f32 {
    let slot = slot_of(primitive);
    let a = slot_at(slot);
    var center = a;
    if (HAS_RODS && kind_of(primitive) != SPHERE) {
        let b = slot_at(slot + 1u);
        let axis = b.xyz - a.xyz;
        let h = saturate(dot(p - a.xyz, axis) / dot(axis, axis));
        center = mix(a, b, h);
    }
    return distance(p, center.xyz) / center.w;
}

// Take a primitive's hit if it is nearer than the best so far.
fn consider(ray: Ray, primitive: u32, instance: u32, t_min: f32, kept: Kept, best: ptr<function, Hit>) {
    let span = primitive_span(ray, primitive);
    let last = min((*best).t, kept.far);
    if (span.near > last || span.far < t_min) {
        return;
    }
    if (CLIPPED && kept.near > t_min && span.near < kept.near) {
        // the plane cuts it: solid inside, a cap on the plane
        if (span.far > kept.near) {
            let depth = primitive_depth(ray.origin + kept.near * ray.direction, primitive);
            if (kept.near < (*best).t || (kept.near == (*best).t && depth < (*best).depth)) {
                *best = Hit(kept.near, primitive, instance, kept.entry, depth);
            }
        }
        return;
    }
    // the entry only: a ray that starts inside a solid leaves it unseen
    if (span.near >= t_min && span.near < (*best).t) {
        *best = Hit(span.near, primitive, instance, 0u, 2.0);
    }
}

// One over each component; a zero becomes huge, so that no NaN arises in slab tests.
fn safe_inverse(d: vec3f) -> vec3f {
    let tiny = vec3f(1e-20);
    return 1.0 / select(d, select(-tiny, tiny, d >= vec3f(0.0)), abs(d) < tiny);
}

// State of a 3-D digital differential analyser in one grid.
struct Walk {
    cell: i32,
    stride: vec3i,
    t_next: vec3f,
    t_step: vec3f,
    t_end: f32,
}

// Start where the ray enters the grid's box within [t_min, t_max]; t_end < 0 ... no cell at all.
fn walk_start(grid: Grid, ray: Ray, t_min: f32, t_max: f32) -> Walk {
    let inverse = safe_inverse(ray.direction);
    let size = vec3f(grid.dims) * grid.cell;
    let to_low = (grid.origin - ray.origin) * inverse;
    let to_high = (grid.origin + size - ray.origin) * inverse;
    let enter = min(to_low, to_high);
    let leave = max(to_low, to_high);
    let t0 = max(max(enter.x, enter.y), max(enter.z, t_min));
    let t1 = min(min(leave.x, leave.y), min(leave.z, t_max));
    var walk: Walk;
    walk.t_end = -NOTHING;
    if (t0 > t1) {
        return walk;
    }
    let place = (ray.origin + t0 * ray.direction - grid.origin) / grid.cell;
    let last = vec3i(grid.dims) - 1;
    let cell = clamp(vec3i(floor(place)), vec3i(0), last);
    let forward = ray.direction >= vec3f(0.0);
    let edge = grid.origin + vec3f(cell + select(vec3i(0), vec3i(1), forward)) * grid.cell;
    let row = i32(grid.dims.x);
    let layer = row * i32(grid.dims.y);
    walk.cell = i32(grid.cells) + cell.x + row * cell.y + layer * cell.z;
    walk.stride = select(vec3i(-1, -row, -layer), vec3i(1, row, layer), forward);
    walk.t_next = (edge - ray.origin) * inverse;
    walk.t_step = abs(grid.cell * inverse);
    // a sliver less: crossings are sums of steps, and must not round to one more step out of the grid
    walk.t_end = t1 - 1e-3 * grid.cell;
    return walk;
}

// Go on to the next cell along the ray.
fn walk_on(walk: ptr<function, Walk>) {
    let t = (*walk).t_next;
    let x = t.x <= t.y && t.x <= t.z;
    let y = !x && t.y <= t.z;
    (*walk).t_next = t + select(vec3f(0.0), (*walk).t_step, vec3<bool>(x, y, !(x || y)));
    (*walk).cell += select(select((*walk).stride.z, (*walk).stride.y, y), (*walk).stride.x, x);
}

// Trace the primitives of one instance, in its local frame.
fn trace_geometry(
    grid: Grid, ray: Ray, instance: u32, t_min: f32, kept: Kept, mode: u32, best: ptr<function, Hit>,
) {
    var walk = walk_start(grid, ray, max(t_min, kept.near), min((*best).t, kept.far));
    if (walk.t_end < -1.0e38) {
        return;
    }
    // Three loops, each of one kind of work: adapters that run lanes in lockstep pay for every
    // branch of an iteration, taken or not.
    loop {
        var first = cell_at(u32(walk.cell));
        var t_exit = min(walk.t_next.x, min(walk.t_next.y, walk.t_next.z));
        loop {
            if (first != EMPTY_CELL || t_exit >= walk.t_end) {
                break;
            }
            walk_on(&walk);
            first = cell_at(u32(walk.cell));
            t_exit = min(walk.t_next.x, min(walk.t_next.y, walk.t_next.z));
        }
        if (first == EMPTY_CELL) {
            return;
        }
        loop {
            let reference = ref_at(first);
            consider(ray, reference & ~LAST_OF_CELL, instance, t_min, kept, best);
            first += 1u;
            if ((reference & LAST_OF_CELL) != 0u || (mode == ANY && (*best).t < NOTHING)) {
                break;
            }
        }
        if (t_exit >= walk.t_end || t_exit > (*best).t || (mode == ANY && (*best).t < NOTHING)) {
            return;
        }
        walk_on(&walk);
    }
}

fn trace_instance(
    ray: Ray, index: u32, t_min: f32, kept: Kept, mode: u32, best: ptr<function, Hit>,
) {
    let instance = instance_at(index);
    let object = traced_object(instance.object);
    let to_center = instance.center - ray.origin;
    let along = dot(to_center, ray.direction);
    let off = to_center - along * ray.direction;
    let square = object.radius * object.radius - dot(off, off);
    if (square < 0.0) {
        return;
    }
    let half = sqrt(square);
    if (along - half > (*best).t || along + half < t_min) {
        return;
    }
    let inverse = conjugate(instance.rotation);
    let local = Ray(rotate(inverse, -to_center), rotate(inverse, ray.direction));
    var bounds = kept;
    if (CLIPPED && (object.flags & UNCLIPPED) != 0u) {
        bounds = Kept(-NOTHING, NOTHING, 0u);
    }
    trace_geometry(object.grid, local, index, t_min, bounds, mode, best);
}

fn trace(ray: Ray, t_min: f32, t_max: f32, mode: u32) -> Hit {
    var best = NO_HIT;
    best.t = NOTHING;
    var kept = Kept(-NOTHING, t_max, 0u);
    if (CLIPPED) {
        kept = kept_interval(ray);
        kept.far = min(kept.far, t_max);
    }
    if (!HAS_TOP_LEVEL) {
        // one instance: everything about it is in the uniform
        let inverse = conjugate(scene.rotation);
        let local = Ray(rotate(inverse, ray.origin - scene.center), rotate(inverse, ray.direction));
        if (CLIPPED && scene.spared != 0u) {
            kept = Kept(-NOTHING, t_max, 0u);
        }
        trace_geometry(scene.top, local, 0u, t_min, kept, mode, &best);
        return best;
    }
    var around = kept;
    if (CLIPPED && scene.spared != 0u) {
        around = Kept(-NOTHING, t_max, 0u);
    }
    var walk = walk_start(scene.top, ray, max(t_min, around.near), around.far);
    if (walk.t_end < -1.0e38) {
        return best;
    }
    // the last two instances seen need no second look
    var seen = vec2u(NO_PRIMITIVE);
    loop {
        let first = cell_at(u32(walk.cell));
        if (first != EMPTY_CELL) {
            var index = first;
            loop {
                let reference = ref_at(index);
                let instance = reference & ~LAST_OF_CELL;
                if (instance != seen.x && instance != seen.y) {
                    trace_instance(ray, instance, t_min, kept, mode, &best);
                    seen = vec2u(seen.y, instance);
                }
                index += 1u;
                if ((reference & LAST_OF_CELL) != 0u || (mode == ANY && best.t < NOTHING)) {
                    break;
                }
            }
        }
        let t_exit = min(walk.t_next.x, min(walk.t_next.y, walk.t_next.z));
        if (t_exit >= walk.t_end || t_exit > best.t || (mode == ANY && best.t < NOTHING)) {
            return best;
        }
        walk_on(&walk);
    }
    return best;
}

fn trace_nearest(ray: Ray, t_min: f32, t_max: f32) -> Hit {
    return trace(ray, t_min, t_max, NEAREST);
}

fn trace_any(ray: Ray, t_min: f32, t_max: f32) -> bool {
    return trace(ray, t_min, t_max, ANY).t < NOTHING;
}

// How far above a surface point secondary rays start: a few units in the last place of the
// coordinates that made it, so that no constant in world units is tuned to one scene.
fn surface_offset(position: vec3f, depth: f32) -> f32 {
    let largest = max(max(abs(position.x), abs(position.y)), max(abs(position.z), depth));
    return 3e-6 * largest + 1e-4 * scene.primitive_radius;
}
