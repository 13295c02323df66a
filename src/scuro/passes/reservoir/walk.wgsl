// From outside the model to the next cell along a ray: a walk through the areal grid.

//#include "cross.wgsl"

struct Place {
    found: bool,
    index: vec2i,
    layer: i32,
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
    var best = Place(false, vec2i(0), 0, t_end);
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
        let index = voxel.y * i32(model.areal_dims.x) + voxel.x;
        let range = heights[index];
        let z_a = origin.z + t * d.z;
        let z_b = origin.z + t_exit * d.z;
        let slack = slack_at(t_exit);
        if (min(z_a, z_b) <= range.y + slack && max(z_a, z_b) >= range.x - slack) {
            try_columns(probe, index, t_from, t_exit + slack, avoided, &best);
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
    probe: Probe, voxel: i32, t_from: f32, t_last: f32, avoided: vec2i, best: ptr<function, Place>,
) {
    for (var n = areal[voxel]; n < areal[voxel + 1]; n++) {
        let column = i32(areal[n]);
        if (column == avoided.x || column == avoided.y) {
            continue;
        }
        let width = i32(model.columns.x);
        let index = vec2i(column % width, column / width);
        let frame = frame_of(index);
        let seen = seen_from(probe, frame);
        let count = i32(frame.column.count);
        let top = surface_z(frame, 0);
        let bottom = surface_z(frame, count - 1);
        if (misses(seen, top, bottom)) {
            continue;
        }
        let passage = cross_cell(seen, top, bottom, NO_FACE, 0.0);
        let start = max(passage.near, t_from);
        if (passage.far_face == NO_FACE || passage.far <= t_from + slack_at(t_from)
            || start > t_last || start >= (*best).t) {
            continue;
        }
        let share = saturate((start - passage.near) / max(passage.far - passage.near, 1e-20));
        let at = mix(passage.near_at, passage.far_at, share);
        let z = probe.ray.origin.z + start * probe.ray.direction.z;
        let layer = clamp(layer_around(frame, at.xy, z), 0, count - 2);
        *best = Place(true, index, layer, start);
    }
}

// The cell behind a face that the ray leaves a cell by; not found where there is none.
fn next_cell(frame: Frame, layer: i32, face: i32, at: vec3f, z: f32, t: f32) -> Place {
    var out = Place(false, frame.index, layer, t);
    if (face == TOP || face == BOTTOM) {
        out.layer = layer + select(-1, 1, face == BOTTOM);
        out.found = out.layer >= 0 && out.layer + 1 < i32(frame.column.count);
        return out;
    }
    out.index = frame.index + side_step(face);
    if (!in_grid(out.index)) {
        return out;
    }
    let next = column_at(out.index);
    if (next.count == 0u) {
        return out;
    }
    if (agrees(frame, next, face, layer)) {
        out.layer = layer + i32(frame.column.first) - i32(next.first);
        out.found = true;
        return out;
    }
    // across a fault: the layer at this height, seen from the other side
    let other = frame_of(out.index);
    let across = at.xy - vec2f(side_step(face));
    out.layer = layer_around(other, across, z);
    out.found = out.layer >= 0 && out.layer + 1 < i32(next.count);
    return out;
}
