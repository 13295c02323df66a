// The one tracer. Two levels of uniform grids (Amanatides & Woo 1987): a grid over instances, whose
// entries are rejected by bounding sphere, and a grid over each geometry's primitives.
//
//   trace_nearest(ray, t_min, t_max)       the first surface, caps of clipped solids included
//   trace_any(ray, t_min, t_max)           whether anything lies between
//
// Rays are in scene space (world minus scene center) with unit directions. Clipping planes bound
// every ray from the start: culled matter is not hit by any ray.

//#include "dda.wgsl"
//#include "entry.wgsl"
//#include "opacity.wgsl"

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

// Take an entry's hit if it is nearer than the best so far; `primitive` is its index meanwhile.
fn consider(
    ray: Ray, entry: Entry, index: u32, instance: u32, t_min: f32, kept: Kept,
    best: ptr<function, Hit>,
) {
    let span = entry_span(ray, entry);
    if (span.near > min((*best).t, kept.far) || span.far < t_min) {
        return;
    }
    if (CLIPPED && kept.near > t_min && span.near < kept.near) {
        // the plane cuts it: solid inside, a cap on the plane
        if (span.far > kept.near) {
            let depth = entry_depth(ray.origin + kept.near * ray.direction, entry);
            if (kept.near < (*best).t || (kept.near == (*best).t && depth < (*best).depth)) {
                *best = Hit(kept.near, index, instance, kept.entry, depth);
            }
        }
        return;
    }
    // the entry only: a ray that starts inside a solid leaves it unseen
    if (span.near >= t_min && span.near < (*best).t) {
        *best = Hit(span.near, index, instance, 0u, 2.0);
    }
}

// Whether an entry stops a ray anywhere in [t_min, t_max].
fn stops(ray: Ray, entry: Entry, t_min: f32, t_max: f32, kept: Kept) -> bool {
    let span = entry_span(ray, entry);
    if (CLIPPED) {
        let capped = (kept.near > t_min) & (span.near < kept.near) & (span.far > kept.near);
        return (span.near < min(t_max, kept.far))
            & (capped | (span.near >= max(t_min, kept.near)));
    }
    return (span.near >= t_min) & (span.near < t_max);
}

// The nearest hit within one instance, in its local frame.
fn nearest_in_geometry(
    grid: Grid, ray: Ray, instance: u32, t_min: f32, kept: Kept, best: ptr<function, Hit>,
) {
    var walk = walk_start(grid, ray, max(t_min, kept.near), min((*best).t, kept.far));
    if (walk.t_end < -1.0e38) {
        return;
    }
    loop {
        var index = next_entries(&walk);
        if (index == EMPTY_CELL) {
            break;
        }
        loop {
            let entry = entry_of(walked_at(index));
            consider(ray, entry, index, instance, t_min, kept, best);
            index += 1u;
            if (entry.last) {
                break;
            }
        }
        let t_exit = walk_exit(walk);
        if (t_exit >= walk.t_end || t_exit > (*best).t) {
            break;
        }
        walk_on(&walk);
    }
}

// Whether anything of one instance lies in [t_min, t_max] of a ray in its local frame.
//
// One flat loop, whose every iteration either tests an entry or goes on to the next cell, without
// branches: lanes of a group need not wait for each other at the end of each cell.
fn any_in_geometry(grid: Grid, ray: Ray, t_min: f32, t_max: f32, kept: Kept) -> bool {
    var walk = walk_start(grid, ray, max(t_min, kept.near), min(t_max, kept.far));
    if (walk.t_end < -1.0e38) {
        return false;
    }
    var found = false;
    var at_cell = true;
    var index = u32(walk.cell);
    loop {
        // a cell or an entry: as an entry, a cell is a sphere of no radius, which stops nothing
        let texel = walked_at(index);
        let entry = entry_of(texel);
        found = !at_cell & stops(ray, entry, t_min, t_max, kept);
        let onward = select(entry.last, texel.y != 0u, at_cell);
        let clear = at_cell & is_clear(walk, texel);
        if (found | clear | (onward & (walk_exit(walk) >= walk.t_end))) {
            break;
        }
        index = walk_flat(&walk, texel, index, at_cell, onward);
        at_cell = onward;
    }
    return found;
}

// A ray in the frame of an instance, and the planes' interval as the instance sees it.
struct Local {
    ray: Ray,
    kept: Kept,
    grid: Grid,
    // whether the bounding sphere is met in [t_min, t_max]
    near: bool,
}

// The grid of an instance's geometry at the level of detail for its distance. Every instance changes
// level at a distance a little its own, so that a moving camera never sees many change at once.
fn grid_in_view(object: Traced, instance: Instance, index: u32) -> Grid {
    let spread = 0.8 + 0.4 * f32((index * 2654435769u) >> 8u) / 16777216.0;
    let allowed = spread
        * (scene.detail_floor + scene.detail_slope * distance(scene.eye, instance.center));
    var grid = object.grid;
    var coarser = object.coarser;
    while (coarser != 0u) {
        let next = traced_object(coarser);
        if (next.detail > allowed) {
            break;
        }
        grid = next.grid;
        coarser = next.coarser;
    }
    return grid;
}

// Rays may be told to pass through a range of objects, or of instances, as if they were not there.
override HAS_SKIPS: bool = false;

// objects [x, y) and instances [z, w)
var<private> skipped: vec4u;

fn skips(instance: u32, object: u32) -> bool {
    return (object >= skipped.x && object < skipped.y)
        || (instance >= skipped.z && instance < skipped.w);
}

fn local_view(ray: Ray, index: u32, t_min: f32, t_max: f32, kept: Kept) -> Local {
    let instance = instance_at(index);
    let object = traced_object(instance.object);
    let to_center = instance.center - ray.origin;
    let along = dot(to_center, ray.direction);
    let off = to_center - along * ray.direction;
    let half = sqrt(max(0.0, object.radius * object.radius - dot(off, off)));
    let inverse = conjugate(instance.rotation);
    var bounds = kept;
    if (CLIPPED && (object.flags & UNCLIPPED) != 0u) {
        bounds = Kept(-NOTHING, NOTHING, 0u);
    }
    var near = half > 0.0 && along - half <= t_max && along + half >= t_min;
    if (HAS_SKIPS) {
        near = near && !skips(index, instance.object);
    }
    if (HAS_OPACITY) {
        near = near && meets(ray.origin, ray.direction, index, object.flags);
    }
    var grid = object.grid;
    if (HAS_LEVELS && near) {
        grid = grid_in_view(object, instance, index);
    }
    return Local(
        Ray(rotate(inverse, -to_center), rotate(inverse, ray.direction)),
        bounds,
        grid,
        near,
    );
}

// The single instance of a scene that has no other: everything about it is in the uniform.
fn only_view(ray: Ray, kept: Kept) -> Local {
    let inverse = conjugate(scene.rotation);
    var bounds = kept;
    if (CLIPPED && scene.spared != 0u) {
        bounds = Kept(-NOTHING, NOTHING, 0u);
    }
    return Local(
        Ray(rotate(inverse, ray.origin - scene.center), rotate(inverse, ray.direction)),
        bounds,
        scene.top,
        true,
    );
}

// Where the walk over instances begins and ends: the planes bound it unless something is spared.
fn around(kept: Kept) -> Kept {
    if (CLIPPED && scene.spared != 0u) {
        return Kept(-NOTHING, NOTHING, 0u);
    }
    return kept;
}

// What a ray enters beyond this distance it will find listed again in a later cell.
fn entered_before(walk: Walk) -> f32 {
    let t_exit = walk_exit(walk);
    return select(t_exit * 1.0001 + 1e-3 * scene.top.cell, NOTHING, t_exit >= walk.t_end);
}

fn trace(ray: Ray, t_min: f32, t_max: f32, any: bool) -> Hit {
    var best = NO_HIT;
    best.t = t_max;
    var kept = Kept(-NOTHING, NOTHING, 0u);
    if (CLIPPED) {
        kept = kept_interval(ray);
    }
    var found = false;
    if (!HAS_TOP_LEVEL) {
        let local = only_view(ray, kept);
        if (any) {
            found = any_in_geometry(local.grid, local.ray, t_min, t_max, local.kept);
        } else {
            nearest_in_geometry(local.grid, local.ray, 0u, t_min, local.kept, &best);
        }
    } else {
        let bounds = around(kept);
        var walk = walk_start(scene.top, ray, max(t_min, bounds.near), min(t_max, bounds.far));
        // the last instances seen need no second look
        var seen = vec4u(NO_PRIMITIVE);
        loop {
            if (walk.t_end < -1.0e38) {
                break;
            }
            var index = next_entries(&walk);
            if (index == EMPTY_CELL) {
                break;
            }
            let t_cell = entered_before(walk);
            loop {
                // a tight loop over bounding spheres, until one is met or the cell ends
                var met = false;
                var last = false;
                loop {
                    let bound = bitcast<vec4f>(walked_at(index));
                    let span = sphere_span(ray, bound.xyz, abs(bound.w));
                    last = bound.w < 0.0;
                    met = span.near <= min(best.t, t_cell) && span.far >= t_min;
                    if (met || last) {
                        break;
                    }
                    index += 1u;
                }
                let instance = ref_at(index) & ~LAST_OF_CELL;
                if (met && all(seen != vec4u(instance))) {
                    let local = local_view(ray, instance, t_min, best.t, kept);
                    if (local.near) {
                        if (any) {
                            found = any_in_geometry(local.grid, local.ray, t_min, t_max, local.kept);
                        } else {
                            nearest_in_geometry(
                                local.grid, local.ray, instance, t_min, local.kept, &best,
                            );
                        }
                    }
                    seen = vec4u(instance, seen.xyz);
                }
                index += 1u;
                if (found || last) {
                    break;
                }
            }
            let t_exit = walk_exit(walk);
            if (found || t_exit >= walk.t_end || t_exit > best.t) {
                break;
            }
            walk_on(&walk);
        }
    }
    if (any) {
        best.t = select(NOTHING, t_min, found);
        return best;
    }
    if (best.primitive == NO_PRIMITIVE) {
        return NO_HIT;
    }
    best.primitive = ref_at(best.primitive) & ~LAST_OF_CELL;
    if (CLIPPED && HAS_TRIANGLES && kept.entry != 0u) {
        return capped_mesh(ray, t_min, kept, best);
    }
    return best;
}

// A closed mesh that a plane opens shows the inside of its far wall: such a hit becomes a cap, for
// the ray passes the plane inside the mesh. Vertices run counter-clockwise seen from outside.
fn capped_mesh(ray: Ray, t_min: f32, kept: Kept, hit: Hit) -> Hit {
    let instance = instance_at(hit.instance);
    let flags = traced_object(instance.object).flags;
    if (kind_of(hit.primitive) != TRIANGLE || hit.cap != 0u || kept.near < t_min
        || (flags & (UNCLIPPED | OPEN)) != 0u) {
        return hit;
    }
    let slot = slot_of(hit.primitive);
    let a = slot_at(slot).xyz;
    let outward = cross(slot_at(slot + 1u).xyz - a, slot_at(slot + 2u).xyz - a);
    if (dot(rotate(instance.rotation, outward), ray.direction) <= 0.0) {
        return hit;
    }
    return Hit(kept.near, hit.primitive, hit.instance, kept.entry, hit.depth);
}

fn trace_nearest(ray: Ray, t_min: f32, t_max: f32) -> Hit {
    return trace(ray, t_min, t_max, false);
}

fn trace_any(ray: Ray, t_min: f32, t_max: f32) -> bool {
    return trace(ray, t_min, t_max, true).t < NOTHING;
}

// How far above a surface point secondary rays start: a few units in the last place of the
// coordinates that made it, so that no constant in world units is tuned to one scene.
fn surface_offset(position: vec3f, depth: f32) -> f32 {
    let largest = max(max(abs(position.x), abs(position.y)), max(abs(position.z), depth));
    return 3e-6 * largest + 1e-4 * scene.primitive_radius;
}
