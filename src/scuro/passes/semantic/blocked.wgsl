// Whether rays meet another region: the semantics of traced mode.

//#include "trace.wgsl"
//#include "surface.wgsl"
//#include "region.wgsl"

// Whether either level divides instances into groups of atoms.
override HAS_GROUPS: bool = true;

// What rays pass as if it were not there: all that lies in the region which they leave; for groups of
// atoms the whole instance, which blocked_inside looks into.
fn own_of(level: LevelOf, own: vec4u) -> vec4u {
    if (level.kind == BY_OBJECT) {
        return vec4u(region_range(level, own.z), 0u, 0u);
    }
    return vec4u(0u, 0u, own.y, own.y + 1u);
}

// What the element of an entry that a ray meets at t belongs to.
fn region_of_entry(level: LevelOf, own: vec4u, ray: Ray, t: f32, index: u32) -> u32 {
    let primitive = ref_at(index) & ~LAST_OF_CELL;
    var slot = slot_of(primitive);
    if (HAS_RODS && kind_of(primitive) != SPHERE && kind_of(primitive) != TRIANGLE) {
        let a = slot_at(slot).xyz;
        let axis = slot_at(slot + 1u).xyz - a;
        let along = dot(ray.origin + t * ray.direction - a, axis);
        slot += select(0u, 1u, along > 0.5 * dot(axis, axis));
    }
    return region_of(level, own.z, own.y, attribute_at(slot).x);
}

// Whether a ray meets another group of atoms in the instance that it leaves.
fn blocked_inside(ray: Ray, reach: f32, level: LevelOf, own: vec4u) -> bool {
    let label = region_of(level, own.z, own.y, own.x);
    let view = view_of(ray, own.y, own.z);
    let first = max(0.0, view.kept.near);
    let last = min(reach, view.kept.far);
    var walk = walk_start(view.grid, view.ray, first, last);
    var found = false;
    loop {
        var index = EMPTY_CELL;
        if (walk.t_end > -1.0e38) {
            index = next_entries(&walk);
        }
        if (index == EMPTY_CELL) {
            break;
        }
        loop {
            let entry = entry_of(walked_at(index));
            if (stops(view.ray, entry, 0.0, reach, view.kept)) {
                let t = max(entry_span(view.ray, entry).near, first);
                found = found || region_of_entry(level, own, view.ray, t, index) != label;
            }
            index += 1u;
            if (entry.last || found) {
                break;
            }
        }
        if (found || walk_exit(walk) >= walk.t_end) {
            break;
        }
        walk_on(&walk);
    }
    return found;
}

// Whether something of another region lies on the ray.
fn blocked(ray: Ray, reach: f32, level: LevelOf, own: vec4u) -> bool {
    skipped = own_of(level, own);
    var found = HAS_TOP_LEVEL && trace_any(ray, 0.0, reach);
    if (HAS_GROUPS && level.kind == BY_GROUP && !found) {
        found = blocked_inside(ray, reach, level, own);
    }
    return found;
}
