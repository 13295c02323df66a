// PLTS: point location with topological search (Campagnolo 2021, section 4.1.3). Every sample is
// located in the trilinear cells: the reference for the other strategies.

//#include "march.wgsl"
//#include "locate.wgsl"

// First distance from t on at which a point may lie in a column; t_end where none may.
fn next_candidate(ray: Ray, t_from: f32, t_end: f32) -> f32 {
    let inverse = areal_safe(ray.direction.xy);
    let z_inverse = areal_safe(ray.direction.zz).x;
    var t = t_from;
    let forward = ray.direction.xy >= vec2f(0.0);
    let low = (model.areal_origin - ray.origin.xy) * inverse;
    let high = (model.areal_origin + model.areal_voxel * vec2f(model.areal_dims) - ray.origin.xy)
        * inverse;
    t = max(t, max(min(low.x, high.x), min(low.y, high.y)));
    let last = min(t_end, min(max(low.x, high.x), max(low.y, high.y)));
    for (var n = 0u; n < model.areal_dims.x + model.areal_dims.y + 4u; n++) {
        if (t >= last) {
            return t_end;
        }
        let limit = vec2i(model.areal_dims) - 1;
        // just past the voxel's border
        let inner = t + slack_at(t);
        let voxel = clamp(voxel_of(ray.origin + inner * ray.direction), vec2i(0), limit);
        let edge = model.areal_origin
            + vec2f(voxel + select(vec2i(0), vec2i(1), forward)) * model.areal_voxel;
        let exits = (edge - ray.origin.xy) * inverse;
        let t_exit = max(min(exits.x, exits.y), inner);
        let over = voxel_at(voxel);
        if (over.low <= over.high) {
            let z = (vec2f(over.low, over.high) - ray.origin.z) * z_inverse;
            let start = max(t, min(z.x, z.y));
            if (start <= min(t_exit, max(z.x, z.y))) {
                return start;
            }
        }
        t = t_exit;
    }
    return t_end;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume_color);
    if (any(id.xy >= size)) {
        return;
    }
    let ray = scene_ray(vec2f(id.xy) + 0.5);
    var span = ray_span(ray, id.xy);
    // nothing lies farther than the model's far side
    span.far = min(span.far, 2.0 * model.extent + length(ray.origin) + 1.0);
    var sum = Sum(vec3f(0.0), 1.0, sample_after(span.near));
    var done = false;
    while (!done) {
        // from outside, or past a fault: through the areal grid
        var frame: Frame;
        var here = Located(false, 0, vec3f(0.0));
        var p = vec3f(0.0);
        loop {
            let t = sample_t(sum.next);
            done = t >= span.far;
            if (done) {
                break;
            }
            let candidate = sample_after(next_candidate(ray, t, span.far));
            if (candidate > sum.next) {
                sum.next = candidate;
                continue;
            }
            p = ray.origin + t * ray.direction;
            here = locate(p, &frame);
            if (here.found) {
                break;
            }
            sum.next += 1;
        }
        // on from each sample to the next
        while (!done && here.found) {
            if (has_bit(flag_words(frame.column, here.layer).y, here.layer)) {
                take_sample(&sum, value_in(frame.column, here.layer, here.at), p);
            }
            sum.next += 1;
            let t = sample_t(sum.next);
            done = t >= span.far || sum.transmittance < march.cutoff;
            if (done) {
                break;
            }
            p = ray.origin + t * ray.direction;
            here = search(&frame, here.layer, here.at, p);
        }
    }
    finish(id.xy, sum);
}
