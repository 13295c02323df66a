// Color and opacity of a cell's part of a ray: by samples, or by tables of integrals.

//#include "march.wgsl"

// Integrate each cell's segment by tables instead of by samples.
override PREINTEGRATED: bool = false;

// Distances, and parametric coordinates, of the two ends.
struct Segment {
    near: f32,
    far: f32,
    near_at: vec3f,
    far_at: vec3f,
}

fn take_segment(ray: Ray, sum: ptr<function, Sum>, segment: Segment, top: vec4f, bottom: vec4f) {
    if (PREINTEGRATED) {
        preintegrate(ray, sum, segment, top, bottom);
    } else {
        sample_segment(ray, sum, segment, top, bottom);
    }
}

fn sample_segment(
    ray: Ray, sum: ptr<function, Sum>, segment: Segment, top: vec4f, bottom: vec4f,
) {
    let scale = 1.0 / max(segment.far - segment.near, 1e-20);
    var number = max((*sum).next, sample_after(segment.near));
    loop {
        let t = sample_t(number);
        if (t >= segment.far || (*sum).transmittance < march.cutoff) {
            break;
        }
        let at = mix(segment.near_at, segment.far_at, saturate((t - segment.near) * scale));
        take_sample(sum, trilinear(top, bottom, at), ray.origin + t * ray.direction);
        number++;
    }
    (*sum).next = number;
}

// Parts of a segment: by the square root of how far its value bends from a line, and by its
// optical depth.
const PARTS_BY_BEND: f32 = 60.0;
const PARTS_BY_DEPTH: f32 = 1.0;
const MOST_PARTS: i32 = 8;

// Values closer than so many entries of the tables have the mean of the entry between them.
const NARROW: f32 = 2.0;

// Extinction times color, and extinction, over all values between two, from their integrals.
fn mean_between(a: f32, b: f32) -> vec4f {
    let low = i32(min(a, b) * march.table_end + 0.5);
    let high = i32(max(a, b) * march.table_end + 0.5);
    let narrow = f32(high - low) < NARROW;
    let first = textureLoad(colors, select(vec2i(low, 1), vec2i((low + high) / 2, 2), narrow), 0);
    let last = textureLoad(colors, vec2i(high, 1), 0);
    return select((last - first) / max(f32(high - low), 1.0), first, narrow);
}

// The segment in parts short enough that neither the value nor the opacity bends much within one.
fn preintegrate(ray: Ray, sum: ptr<function, Sum>, segment: Segment, top: vec4f, bottom: vec4f) {
    let span = segment.far - segment.near;
    if (span <= 0.0) {
        return;
    }
    let first = saturate(trilinear(top, bottom, segment.near_at));
    let last = saturate(trilinear(top, bottom, segment.far_at));
    let middle = trilinear(top, bottom, mix(segment.near_at, segment.far_at, 0.5));
    let bend = abs(middle - 0.5 * (first + last));
    let whole = mean_between(first, last).w * span / march.unit;
    let wanted = max(sqrt(bend * PARTS_BY_BEND), whole * PARTS_BY_DEPTH);
    let parts = clamp(i32(ceil(wanted)), 1, MOST_PARTS);
    let length = span / f32(parts);
    var before = first;
    for (var n = 1; n <= parts; n++) {
        let at = mix(segment.near_at, segment.far_at, f32(n) / f32(parts));
        let after = saturate(trilinear(top, bottom, at));
        let mean = mean_between(before, after);
        let opacity = 1.0 - exp(-mean.w * length / march.unit);
        let t = segment.near + (f32(n) - 0.5) * length;
        (*sum).color += (*sum).transmittance * opacity * mean.rgb / max(mean.w, 1e-9)
            * light_at(ray.origin + t * ray.direction);
        (*sum).transmittance *= 1.0 - opacity;
        before = after;
        if ((*sum).transmittance < march.cutoff) {
            break;
        }
    }
}
