// Many any-hit rays in turn by each lane: a lane whose ray has ended starts its next one at the end
// of a short burst of steps, instead of waiting until the longest ray of its group ends. On eight
// lanes in lockstep single rays of ambient occlusion waste half of all steps.

//#include "trace.wgsl"

// Steps between two looks at which rays have ended.
const BURST: u32 = 12u;

// An any-hit query under way.
struct Pending {
    walk: Walk,
    local: Local,
    t_min: f32,
    t_max: f32,
    index: u32,
    at_cell: bool,
    found: bool,
    ended: bool,
}

// Start a query; in scenes of several instances it is answered at once.
fn any_begin(ray: Ray, t_min: f32, t_max: f32) -> Pending {
    var query: Pending;
    query.t_min = t_min;
    query.t_max = t_max;
    if (HAS_TOP_LEVEL) {
        query.found = trace_any(ray, t_min, t_max);
        query.ended = true;
        return query;
    }
    var kept = Kept(-NOTHING, NOTHING, 0u);
    if (CLIPPED) {
        kept = kept_interval(ray);
    }
    query.local = only_view(ray, kept);
    query.walk = walk_start(
        query.local.grid, query.local.ray,
        max(t_min, query.local.kept.near), min(t_max, query.local.kept.far),
    );
    query.index = u32(query.walk.cell);
    query.at_cell = true;
    query.found = false;
    query.ended = query.walk.t_end < -1.0e38;
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
        let local = (*query).local;
        (*query).found = !(*query).at_cell
            & stops(local.ray, entry, (*query).t_min, (*query).t_max, local.kept);
        let onward = select(entry.last, texel.y != 0u, (*query).at_cell);
        let outside = walk_exit((*query).walk) >= (*query).walk.t_end;
        (*query).ended = (*query).found | (onward & outside);
        var walk = (*query).walk;
        (*query).index = walk_flat(&walk, texel, (*query).index, (*query).at_cell, onward);
        (*query).walk = walk;
        (*query).at_cell = onward;
    }
}
