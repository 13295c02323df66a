// Rays within one geometry, in its own frame: its first surface, or whether anything is in the way.

//#include "dda.wgsl"
//#include "entry.wgsl"
//#include "kept.wgsl"

struct Hit {
    t: f32,
    // kind and slot; NO_PRIMITIVE for a miss
    primitive: u32,
    instance: u32,
    // 1 + index of the clipping plane on which a cap lies, 0 for a true surface
    cap: u32,
    // how deep the cap point lies in its solid, 0 at the center: decides between overlapping solids
    depth: f32,
    // in which frame its assembly stands, NO_FRAME for what is in none
    frame: u32,
}

const NO_HIT = Hit(NOTHING, NO_PRIMITIVE, 0u, 0u, 2.0, NO_FRAME);

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
                *best = Hit(kept.near, index, instance, kept.entry, depth, frame_at_hand);
            }
        }
        return;
    }
    // the entry only: a ray that starts inside a solid leaves it unseen
    if (span.near >= t_min && span.near < (*best).t) {
        *best = Hit(span.near, index, instance, 0u, 2.0, frame_at_hand);
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
