// How closely a ray passes the scene's solids: soft shadows from one ray (Parker et al. 1998).
//
// Needs grids that list solids by their outer radius (Accelerator.grown). Of all solids near the ray
// the one that leaves least of the light decides.

//#include "trace.wgsl"

// The band around each solid's silhouette in which light fades.
struct Penumbra {
    // half of its width at a distance t along the ray: min(slope t, most); the silhouette in the middle
    slope: f32,
    most: f32,
    // or, if PARKER, the ratio of an outer sphere's radius to the solid's (Parker's form)
    ratio: f32,
}

// Whether penumbras have Parker's fixed ratio.
override PARKER: bool = false;

// The part of a ray's light that one solid leaves, before the fade is rounded off: from -1, nothing, to 1.
fn left_by(ray: Ray, entry: Entry, first: f32, last: f32, penumbra: Penumbra) -> f32 {
    var solid = entry.sphere;
    var t = dot(solid.xyz - ray.origin, ray.direction);
    if (HAS_RODS && entry.primitive != NO_PRIMITIVE) {
        let slot = slot_of(entry.primitive);
        let a = slot_at(slot);
        let axis = slot_at(slot + 1u) - a;
        let from_a = ray.origin - a.xyz;
        let along = dot(ray.direction, axis.xyz);
        let height = dot(from_a, axis.xyz) - dot(from_a, ray.direction) * along;
        let h = saturate(height / max(dot(axis.xyz, axis.xyz) - along * along, 1e-12));
        solid = a + h * axis;
        t = dot(solid.xyz - ray.origin, ray.direction);
    }
    let nearest = clamp(t, first, last);
    let gap = distance(ray.origin + nearest * ray.direction, solid.xyz) - solid.w;
    if (PARKER) {
        return select(2.0 * gap / ((penumbra.ratio - 1.0) * solid.w) - 1.0, 1.0, t <= first);
    }
    return gap / max(min(penumbra.most, penumbra.slope * nearest), 1e-6);
}

// The least that any solid of one instance leaves, or `least` if that is less.
fn least_in_geometry(view: Local, t_max: f32, penumbra: Penumbra, least: f32) -> f32 {
    let first = max(0.0, view.kept.near);
    let last = min(t_max, view.kept.far);
    var walk = walk_start(view.grid, view.ray, first, last);
    if (walk.t_end < -1.0e38) {
        return least;
    }
    var found = least;
    var at_cell = true;
    var index = u32(walk.cell);
    loop {
        let texel = walked_at(index);
        let entry = entry_of(texel);
        found = min(found, select(left_by(view.ray, entry, first, last, penumbra), 1.0, at_cell));
        let onward = select(entry.last, texel.y != 0u, at_cell);
        let clear = at_cell & is_clear(walk, texel);
        if ((found <= -1.0) | clear | (onward & (walk_exit(walk) >= walk.t_end))) {
            break;
        }
        index = walk_flat(&walk, texel, index, at_cell, onward);
        at_cell = onward;
    }
    return found;
}

// The same for an assembly.
fn least_in_assembly(
    outer: Local, frame: u32, t_max: f32, penumbra: Penumbra, kept: Kept, least: f32,
) -> f32 {
    let eye = in_frame(instance_at(frame), scene.eye);
    var search = search_start(outer.grid, outer.ray, 0.0, t_max, kept);
    var found = least;
    frame_at_hand = frame;
    loop {
        let index = next_instance(&search, outer.grid.cell, outer.ray, 0.0, t_max);
        if (index == NO_INSTANCE || found <= -1.0) {
            break;
        }
        let local = local_view(outer.ray, eye, index, 0.0, t_max, kept);
        if (local.near) {
            found = least_in_geometry(local, t_max, penumbra, found);
        }
    }
    frame_at_hand = NO_FRAME;
    return found;
}

// The part of the light that arrives along a ray: 1 = all.
fn trace_soft(ray: Ray, t_max: f32, penumbra: Penumbra) -> f32 {
    let kept = kept_interval(ray);
    var least = 1.0;
    if (!HAS_TOP_LEVEL) {
        least = least_in_geometry(only_view(ray, kept), t_max, penumbra, 1.0);
        return smoothstep(-1.0, 1.0, least);
    }
    var search = search_start(scene.top, ray, 0.0, t_max, kept);
    loop {
        let index = next_instance(&search, scene.top.cell, ray, 0.0, t_max);
        if (index == NO_INSTANCE || least <= -1.0) {
            break;
        }
        let local = local_view(ray, scene.eye, index, 0.0, t_max, kept);
        if (local.near) {
            if (HAS_NESTING && local.nested) {
                least = least_in_assembly(local, index, t_max, penumbra, kept, least);
            } else {
                least = least_in_geometry(local, t_max, penumbra, least);
            }
        }
    }
    return smoothstep(-1.0, 1.0, least);
}
