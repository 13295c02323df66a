// LIBC: linear interpolation with barycentric coordinates (Campagnolo 2021, section 4.1.2). Cell by
// cell; parametric coordinates run linearly from the entry to the exit.
//
// Three loops in one another, since software adapters run every branch: ways through the model
// without a break, the columns of a way, the layers of a column. The innermost reads one new surface
// a cell, and takes hidden cells that lie upon each other as one.

//#include "segment.wgsl"
//#include "runs.wgsl"

// Thin cells may follow each other without bringing the ray on; more of them are a ring around an
// edge.
const MOST_STALLED: i32 = 24;

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
    // columns whose tall outline the ray is in, but none of whose cells it is in
    var avoided = vec2i(-1);
    var visited = 0u;
    var done = false;
    while (!done && visited < march.most_cells) {
        let place = enter(probe, t, span.far, avoided);
        if (!place.found) {
            break;
        }
        t = place.t;
        var frame = frame_of(place.index);
        var entered = NO_FACE;
        var at = vec3f(place.at, 0.0);
        var run = run_around(frame.column, clamp(
            layer_around(frame, at.xy, ray.origin.z + t * ray.direction.z), 0, frame.column.count - 2));
        var stalled = 0;
        var lost = false;
        loop {
            let seen = seen_from(probe, frame);
            var top = corners_at(seen, surface_z(frame, run.first));
            var bottom = corners_at(seen, surface_z(frame, run.last + 1));
            var top_values = surface_values(frame.column, run.first);
            var bottom_values = surface_values(frame.column, run.last + 1);
            let searched = entered == NO_FACE;
            if (searched) {
                let whole = cross_cell(top, bottom, NO_FACE, 0.0);
                t = max(t, min(whole.near, whole.far));
                let share = saturate((t - whole.near) / max(whole.far - whole.near, 1e-20));
                at = mix(whole.near_at, whole.far_at, share);
            }
            var face = NO_FACE;
            // a cell just found must bring the ray on; one reached from its neighbor may be thin
            var least = t + select(-slack_at(t), slack_at(t), searched);
            loop {
                visited++;
                let passage = cross_cell(top, bottom, entered, slack_at(t));
                stalled = select(stalled + 1, 0, passage.far > t + slack_at(t));
                lost = passage.far_face == NO_FACE || passage.far < least || stalled > MOST_STALLED
                    || visited >= march.most_cells;
                if (lost) {
                    break;
                }
                face = passage.far_face;
                var segment = Segment(t, max(t, passage.far), at, passage.far_at);
                done = passage.far >= span.far;
                if (done) {
                    let share = saturate((span.far - t) / max(passage.far - t, 1e-20));
                    segment.far_at = mix(at, passage.far_at, share);
                    segment.far = span.far;
                }
                if (run.shown) {
                    take_segment(ray, &sum, segment, top_values, bottom_values);
                }
                t = segment.far;
                at = passage.far_at;
                done = done || sum.transmittance < march.cutoff;
                if (done || face < TOP) {
                    break;
                }
                let down = face == BOTTOM;
                let layer = select(run.first - 1, run.last + 1, down);
                if (layer < 0 || layer + 1 >= frame.column.count) {
                    break;
                }
                run = run_from(frame.column, layer, down);
                let next = select(run.first, run.last + 1, down);
                let fresh = corners_at(seen, surface_z(frame, next));
                let fresh_values = surface_values(frame.column, next);
                let kept = top;
                top = select_corners(fresh, bottom, down);
                bottom = select_corners(kept, fresh, down);
                let kept_values = top_values;
                top_values = select(fresh_values, bottom_values, down);
                bottom_values = select(kept_values, fresh_values, down);
                at.z = select(1.0, 0.0, down);
                entered = TOP + BOTTOM - face;
                least = t - slack_at(t);
            }
            if (lost) {
                // slipped between cells by rounding, or beside a twisted face: look in other columns
                let column = frame.index.y * i32(model.columns.x) + frame.index.x;
                if (avoided.y >= 0) {
                    avoided = vec2i(-1);
                    t += max(march.step, 4.0 * slack_at(t));
                } else {
                    avoided = vec2i(column, avoided.x);
                }
                break;
            }
            avoided = vec2i(-1);
            if (done || face >= TOP) {
                break;
            }
            let index = frame.index + side_step(face);
            if (!in_grid(index)) {
                break;
            }
            let from_first = frame.column.first;
            frame = frame_of(index);
            if (frame.column.count == 0) {
                break;
            }
            let z = ray.origin.z + t * ray.direction.z;
            at = vec3f(at.xy - vec2f(side_step(face)), 0.0);
            let beside = run_beside(frame, run.first + from_first - frame.column.first, at.xy, z, slack_at(t));
            if (!beside.found) {
                break;
            }
            run = beside.run;
            at.z = beside.r;
            entered = (face + 2) % 4;
        }
    }
    finish(id.xy, sum);
}

fn select_corners(a: Corners, b: Corners, second: bool) -> Corners {
    return Corners(select(a.u, b.u, second), select(a.v, b.v, second), select(a.d, b.d, second));
}
