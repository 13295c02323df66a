// The one tracer. Two levels of uniform grids (Amanatides & Woo 1987): a grid over instances, whose
// entries are rejected by bounding sphere, and a grid over each geometry's primitives. An instance may
// be a whole assembly, with a grid over its own instances between the two.
//
//   trace_nearest(ray, t_min, t_max)       the first surface, caps of clipped solids included
//   trace_any(ray, t_min, t_max)           whether anything lies between
//
// Rays are in scene space (world minus scene center) with unit directions. Clipping planes bound
// every ray from the start: culled matter is not hit by any ray.

//#include "instances.wgsl"

// Look into one instance for a nearer hit, or any; returns whether that is enough.
fn look_into(
    local: Local, index: u32, t_min: f32, t_max: f32, any: bool, best: ptr<function, Hit>,
) -> bool {
    if (any) {
        return any_in_geometry(local.grid, local.ray, t_min, t_max, local.kept);
    }
    nearest_in_geometry(local.grid, local.ray, index, t_min, local.kept, best);
    return false;
}

// The same for an assembly, whose instances are looked into in turn.
fn look_into_assembly(
    outer: Local, frame: u32, t_min: f32, any: bool, kept: Kept, best: ptr<function, Hit>,
) -> bool {
    let eye = in_frame(instance_at(frame), scene.eye);
    var search = search_start(outer.grid, outer.ray, t_min, (*best).t, kept);
    var found = false;
    frame_at_hand = frame;
    loop {
        let index = next_instance(&search, outer.grid.cell, outer.ray, t_min, (*best).t);
        if (index == NO_INSTANCE) {
            break;
        }
        let local = local_view(outer.ray, eye, index, t_min, (*best).t, kept);
        if (local.near) {
            found = look_into(local, index, t_min, (*best).t, any, best);
        }
        if (found) {
            break;
        }
    }
    frame_at_hand = NO_FRAME;
    return found;
}

fn trace(ray: Ray, t_min: f32, t_max: f32, any: bool) -> Hit {
    var best = NO_HIT;
    best.t = t_max;
    let kept = kept_interval(ray);
    var found = false;
    if (!HAS_TOP_LEVEL) {
        found = look_into(only_view(ray, kept), 0u, t_min, t_max, any, &best);
    } else {
        var search = search_start(scene.top, ray, t_min, t_max, kept);
        loop {
            let index = next_instance(&search, scene.top.cell, ray, t_min, best.t);
            if (index == NO_INSTANCE) {
                break;
            }
            let local = local_view(ray, scene.eye, index, t_min, best.t, kept);
            if (local.near) {
                if (HAS_NESTING && local.nested) {
                    found = look_into_assembly(local, index, t_min, any, kept, &best);
                } else {
                    found = look_into(local, index, t_min, best.t, any, &best);
                }
            }
            if (found) {
                break;
            }
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
    let instance = placed(hit.instance, hit.frame);
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
    return Hit(kept.near, hit.primitive, hit.instance, kept.entry, hit.depth, hit.frame);
}

// The number by which the G-buffer knows the instance that was hit.
fn hit_number(hit: Hit) -> u32 {
    return leaf_number(hit.instance, hit.frame, instance_at(hit.instance).object);
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
