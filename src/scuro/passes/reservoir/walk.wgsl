// From outside the model to the next cell along a ray: a walk through the areal grid.

//#include "cross.wgsl"

struct Place {
    found: bool,
    index: vec2i,
    // where in its column
    at: vec2f,
    t: f32,
}

fn areal_safe(d: vec2f) -> vec2f {
    return 1.0 / select(d, select(vec2f(-1e-20), vec2f(1e-20), d >= vec2f(0.0)), abs(d) < vec2f(1e-20));
}

// Distances that are the same but for rounding.
fn slack_at(t: f32) -> f32 {
    return max(model.extent * 1e-6, abs(t) * 5e-7);
}

// The first cell that the ray meets between two distances, not counting the columns avoided.
fn enter(probe: Probe, t_from: f32, t_end: f32, avoided: vec2i) -> Place {
    var best = Place(false, vec2i(0), vec2f(0.0), t_end);
    let origin = probe.ray.origin;
    let d = probe.ray.direction;
    let inverse = areal_safe(d.xy);
    let a = (model.areal_origin - origin.xy) * inverse;
    let b = (model.areal_origin + model.areal_voxel * vec2f(model.areal_dims) - origin.xy) * inverse;
    let enters = min(a, b);
    let leaves = max(a, b);
    let z_inverse = areal_safe(d.zz).x;
    let c = (model.z_range - origin.z) * z_inverse;
    let slack_z = 4.0 * slack_at(c.x);
    var t = max(max(t_from, min(c.x, c.y) - slack_z), max(enters.x, enters.y));
    let last = min(min(t_end, max(c.x, c.y) + slack_z), min(leaves.x, leaves.y));
    if (t > last) {
        return best;
    }
    let forward = d.xy >= vec2f(0.0);
    let limit = vec2i(model.areal_dims) - 1;
    var voxel = clamp(vec2i(floor((origin.xy + t * d.xy - model.areal_origin) / model.areal_voxel)), vec2i(0), limit);
    let edge = model.areal_origin + vec2f(voxel + select(vec2i(0), vec2i(1), forward)) * model.areal_voxel;
    var t_next = (edge - origin.xy) * inverse;
    let t_step = abs(model.areal_voxel * inverse);
    let stride = select(vec2i(-1), vec2i(1), forward);
    loop {
        let t_exit = min(min(t_next.x, t_next.y), last);
        let over = voxel_at(voxel);
        let z_a = origin.z + t * d.z;
        let z_b = origin.z + t_exit * d.z;
        let slack = slack_at(t_exit);
        if (min(z_a, z_b) <= over.high + slack && max(z_a, z_b) >= over.low - slack) {
            try_columns(probe, over, t_from, t_exit + slack, avoided, &best);
            if (best.found) {
                break;
            }
        }
        if (t_exit >= last) {
            break;
        }
        if (t_next.x <= t_next.y) {
            voxel.x += stride.x;
            t_next.x += t_step.x;
        } else {
            voxel.y += stride.y;
            t_next.y += t_step.y;
        }
        if (any(voxel < vec2i(0)) || any(voxel > limit)) {
            break;
        }
        t = t_exit;
    }
    return best;
}

// The nearest column over a voxel that the ray enters before t_last, as one tall cell.
fn try_columns(
    probe: Probe, over: Voxel, t_from: f32, t_last: f32, avoided: vec2i, best: ptr<function, Place>,
) {
    for (var n = 0; n < over.count; n++) {
        let index = listed_column(over.first + n);
        let number = index.y * i32(model.columns.x) + index.x;
        if (number == avoided.x || number == avoided.y) {
            continue;
        }
        let frame = frame_of(index);
        let seen = seen_from(probe, frame);
        let top = corners_at(seen, surface_z(frame, 0));
        let bottom = corners_at(seen, surface_z(frame, frame.column.count - 1));
        if (misses(top, bottom)) {
            continue;
        }
        let passage = cross_cell(top, bottom, NO_FACE, 0.0);
        let start = max(passage.near, t_from);
        if (passage.far_face == NO_FACE || passage.far <= t_from + slack_at(t_from)
            || start > t_last || start >= (*best).t) {
            continue;
        }
        let share = saturate((start - passage.near) / max(passage.far - passage.near, 1e-20));
        *best = Place(true, index, mix(passage.near_at, passage.far_at, share).xy, start);
    }
}
