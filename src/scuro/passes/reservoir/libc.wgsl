// LIBC: linear interpolation with barycentric coordinates (Campagnolo 2021, section 4.1.2). Cell by
// cell; parametric coordinates run linearly from the entry to the exit.

//#include "march.wgsl"

// Integrate each cell's segment by tables instead of by samples.
// Thin cells may follow each other without bringing the ray on; more of them are a ring around an
// edge.
const MOST_STALLED: i32 = 24;

override PREINTEGRATED: bool = false;

fn sample_cell(ray: Ray, sum: ptr<function, Sum>, column: Column, layer: i32, passage: Passage, from_: f32) {
    let top = surface_values(column, layer);
    let bottom = surface_values(column, layer + 1);
    let scale = 1.0 / max(passage.far - passage.near, 1e-20);
    var number = max((*sum).next, sample_after(from_));
    loop {
        let t = sample_t(number);
        if (t >= passage.far || (*sum).transmittance < march.cutoff) {
            break;
        }
        let at = mix(passage.near_at, passage.far_at, saturate((t - passage.near) * scale));
        take_sample(sum, trilinear(top, bottom, at), ray.origin + t * ray.direction);
        number++;
    }
    (*sum).next = number;
}

// Parts of a segment: by the square root of how far its value bends from a line, and by its
// optical depth.
const PARTS_BY_BEND: f32 = 60.0;
const PARTS_BY_DEPTH: f32 = 1.0;

// Extinction and extinction times color between two values, from their integrals over the value.
fn mean_between(a: f32, b: f32) -> vec4f {
    let low = min(a, b) * march.table_end;
    let high = max(a, b) * march.table_end;
    let width = high - low;
    if (width < 0.5) {
        let middle = (low + high) * 0.5;
        return integral_at(middle + 0.5) - integral_at(middle - 0.5);
    }
    return (integral_at(high) - integral_at(low)) / width;
}

fn integral_at(x: f32) -> vec4f {
    let place = clamp(x, 0.0, march.table_end);
    let index = u32(place);
    let first = u32(march.table_end) + 1u;
    let next = min(index + 1u, u32(march.table_end));
    let inner = mix(colors[first + index], colors[first + next], place - f32(index));
    // beyond the table's ends its last entry goes on
    let ahead = x - place;
    if (ahead == 0.0) {
        return inner;
    }
    let end = select(first, first + u32(march.table_end) - 1u, ahead > 0.0);
    return inner + ahead * (colors[end + 1u] - colors[end]);
}

// The segment in parts short enough that neither the value nor the opacity bends much within one.
fn preintegrate_cell(ray: Ray, sum: ptr<function, Sum>, column: Column, layer: i32, passage: Passage, from_: f32) {
    let top = surface_values(column, layer);
    let bottom = surface_values(column, layer + 1);
    let start = max(passage.near, from_);
    let span = passage.far - start;
    if (span <= 0.0) {
        return;
    }
    let share = saturate((start - passage.near) / max(passage.far - passage.near, 1e-20));
    let at_start = mix(passage.near_at, passage.far_at, share);
    let first = trilinear(top, bottom, at_start);
    let last = trilinear(top, bottom, passage.far_at);
    let middle = trilinear(top, bottom, mix(at_start, passage.far_at, 0.5));
    let bend = abs(middle - 0.5 * (first + last));
    let whole = mean_between(first, last).w * span / march.unit;
    let parts = clamp(i32(ceil(max(sqrt(bend * PARTS_BY_BEND), whole * PARTS_BY_DEPTH))), 1, 8);
    let length = span / f32(parts);
    var before = first;
    for (var n = 1; n <= parts; n++) {
        let x = f32(n) / f32(parts);
        var after = last;
        if (n < parts) {
            after = trilinear(top, bottom, mix(at_start, passage.far_at, x));
        }
        let mean = mean_between(before, after);
        if (mean.w > 1e-9) {
            let opacity = 1.0 - exp(-mean.w * length / march.unit);
            let t = start + (f32(n) - 0.5) * length;
            (*sum).color += (*sum).transmittance * opacity * mean.rgb / mean.w
                * light_at(ray.origin + t * ray.direction);
            (*sum).transmittance *= 1.0 - opacity;
            if ((*sum).transmittance < march.cutoff) {
                return;
            }
        }
        before = after;
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume_color);
    if (any(id.xy >= size)) {
        return;
    }
    let ray = scene_ray(vec2f(id.xy) + 0.5);
    let span = ray_span(ray, id.xy);
    let probe = probe_of(ray);
    var sum = Sum(vec3f(0.0), 1.0, sample_after(span.near));
    var t = span.near;
    var place = Place(false, vec2i(0), 0, t);
    var frame: Frame;
    var seen: Seen;
    var entered = NO_FACE;
    var stalled = 0;
    // columns whose tall outline the ray is in, but none of whose cells it is in
    var avoided = vec2i(-1);
    for (var visited = 0u; visited < march.most_cells; visited++) {
        let searched = !place.found;
        if (searched) {
            place = enter(probe, t, span.far, avoided);
            if (!place.found) {
                break;
            }
            t = place.t;
            entered = NO_FACE;
            frame = frame_of(place.index);
            seen = seen_from(probe, frame);
        }
        var passage = cross_cell(
            seen, surface_z(frame, place.layer), surface_z(frame, place.layer + 1), entered, slack_at(t));
        // a cell just found must bring the ray on; one reached from its neighbor may be thin
        let least = t + select(-slack_at(t), slack_at(t), searched);
        stalled = select(stalled + 1, 0, passage.far > t + slack_at(t));
        if (passage.far_face == NO_FACE || passage.far < least || stalled > MOST_STALLED) {
            // slipped between cells by rounding, or beside a twisted face: look in other columns
            let column = place.index.y * i32(model.columns.x) + place.index.x;
            if (avoided.y >= 0) {
                avoided = vec2i(-1);
                t += max(march.step, 4.0 * slack_at(t));
            } else {
                avoided = vec2i(column, avoided.x);
            }
            place.found = false;
            continue;
        }
        let from_ = select(passage.near, t, passage.near - t < march.step);
        let far_at = passage.far_at;
        let ends = passage.far >= span.far;
        if (ends) {
            let share = (span.far - passage.near) / max(passage.far - passage.near, 1e-20);
            passage.far_at = mix(passage.near_at, passage.far_at, saturate(share));
            passage.far = span.far;
        }
        if (is_shown(frame.column, place.layer)) {
            if (PREINTEGRATED) {
                preintegrate_cell(ray, &sum, frame.column, place.layer, passage, max(from_, t));
            } else {
                sample_cell(ray, &sum, frame.column, place.layer, passage, from_);
            }
        }
        t = max(t, passage.far);
        avoided = vec2i(-1);
        if (ends || sum.transmittance < march.cutoff) {
            break;
        }
        let z = ray.origin.z + t * ray.direction.z;
        let next = next_cell(frame, place.layer, passage.far_face, far_at, z, t);
        if (next.found && passage.far_face < TOP) {
            frame = frame_of(next.index);
            seen = seen_from(probe, frame);
            entered = (passage.far_face + 2) % 4;
        } else {
            entered = TOP + BOTTOM - passage.far_face;
        }
        place = next;
    }
    finish(id.xy, sum);
}
