// Many any-hit rays from one point of a surface, as occlusion has them.
//
// Two things make them cheap on adapters that run lanes in lockstep. All rays are tested at once
// against what the point's own cell lists, so that an entry is fetched once for sixteen rays. And a
// lane whose ray has ended starts its next one at the end of a short burst of steps, instead of
// waiting until the longest ray of its group ends.

//#include "trace.wgsl"

// Steps between two looks at which rays have ended.
const BURST: u32 = 10u;

// How many rays are tested at once: 4, 8, 12 or 16.
override ROUND: u32 = 16u;

// Whether rays can stay in the frame of the scene's one instance, which no plane cuts.
override LOCAL: bool = false;
// Whether the point's own cell is tested for all rays at once: LOCAL, and spheres only.
override FIRST_CELL_AT_ONCE: bool = false;

// A point from which rays start; if LOCAL, it and their directions are in the instance's frame.
struct Fan {
    origin: vec3f,
    normal: vec3f,
    cell: vec3i,
}

fn fan_at(origin: vec3f, normal: vec3f) -> Fan {
    if (!LOCAL) {
        return Fan(origin, normal, vec3i(0));
    }
    let inverse = conjugate(scene.rotation);
    let local = rotate(inverse, origin - scene.center);
    return Fan(local, rotate(inverse, normal), cell_of(scene.top, local));
}

// Four directions.
struct Quad {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

// Which of four rays enter the sphere around `to` within t_max; `square` is |to|^2 - r^2, in which
// nothing cancels, for the spheres of a cell are near.
fn quad_meets(to: vec3f, square: f32, t_max: f32, quad: Quad) -> u32 {
    let along = to.x * quad.x + to.y * quad.y + to.z * quad.z;
    let half2 = along * along - square;
    let beyond = along - t_max;
    let met = (along > vec4f(0.0)) & (half2 >= vec4f(0.0))
        & ((beyond < vec4f(0.0)) | (beyond * beyond < half2));
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), met);
    return bits.x | bits.y | bits.z | bits.w;
}

// Which of the rays, a bit each, nothing in the point's own cell stops.
fn fan_open(fan: Fan, t_max: f32, a: Quad, b: Quad, c: Quad, d: Quad) -> u32 {
    let cell = walked_at(cell_index(scene.top, fan.cell));
    if (cell.y != 0u) {
        return 0xffffu;
    }
    var blocked = 0u;
    var index = cell.x;
    loop {
        let entry = entry_of(walked_at(index));
        let to = entry.sphere.xyz - fan.origin;
        let square = dot(to, to) - entry.sphere.w * entry.sphere.w;
        var met = quad_meets(to, square, t_max, a);
        if (ROUND > 4u) {
            met |= quad_meets(to, square, t_max, b) << 4u;
        }
        if (ROUND > 8u) {
            met |= quad_meets(to, square, t_max, c) << 8u;
        }
        if (ROUND > 12u) {
            met |= quad_meets(to, square, t_max, d) << 12u;
        }
        // the entry only: a point inside a sphere leaves it unseen
        blocked |= select(0u, met, square >= 0.0);
        if (entry.last) {
            break;
        }
        index += 1u;
    }
    return ~blocked;
}

// An any-hit query under way.
struct Pending {
    walk: Walk,
    ray: Ray,
    kept: Kept,
    t_max: f32,
    index: u32,
    at_cell: bool,
    found: bool,
    ended: bool,
}

// Start a query; in scenes of several instances it is answered at once.
fn any_begin(fan: Fan, direction: vec3f, t_max: f32) -> Pending {
    var query: Pending;
    query.ray = Ray(fan.origin, direction);
    query.t_max = t_max;
    query.at_cell = true;
    if (HAS_TOP_LEVEL) {
        query.found = trace_any(query.ray, 0.0, t_max);
        query.ended = true;
        return query;
    }
    query.kept = ALL_KEPT;
    if (LOCAL) {
        var walk = walk_from(scene.top, query.ray, fan.cell, t_max);
        if (FIRST_CELL_AT_ONCE) {
            query.ended = walk_exit(walk) >= walk.t_end;
            walk_on(&walk);
        }
        query.walk = walk;
    } else {
        let local = only_view(query.ray, kept_interval(query.ray));
        query.ray = local.ray;
        query.kept = local.kept;
        query.walk = walk_start(
            scene.top, query.ray, max(0.0, query.kept.near), min(t_max, query.kept.far),
        );
        query.ended = query.walk.t_end < -1.0e38;
    }
    query.index = u32(query.walk.cell);
    return query;
}

// Go on for a burst of steps, or until the query ends; see any_in_geometry.
fn any_go_on(query: ptr<function, Pending>) {
    if (HAS_TOP_LEVEL) {
        return;
    }
    for (var i = 0u; i < BURST; i += 1u) {
        if ((*query).ended) {
            break;
        }
        let texel = walked_at((*query).index);
        let entry = entry_of(texel);
        let at_cell = (*query).at_cell;
        var walk = (*query).walk;
        (*query).found = !at_cell & stops((*query).ray, entry, 0.0, (*query).t_max, (*query).kept);
        let onward = select(entry.last, texel.y != 0u, at_cell);
        (*query).ended = (*query).found | (at_cell & is_clear(walk, texel))
            | (onward & (walk_exit(walk) >= walk.t_end));
        (*query).index = walk_flat(&walk, texel, (*query).index, at_cell, onward);
        (*query).walk = walk;
        (*query).at_cell = onward;
    }
}
