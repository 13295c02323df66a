// What all strategies share: samples at the same places along each ray, color and opacity.

//#include "view.wgsl"
//#include "walk.wgsl"

const MAX_PLANES: u32 = 32u;

struct March {
    // half-spaces that are kept: normal . p + offset >= 0
    planes: array<vec4f, MAX_PLANES>,
    plane_count: u32,
    // distance between samples
    step: f32,
    // rays end at this transmittance
    cutoff: f32,
    // last index of the tables
    table_end: f32,
    // lower corner and inverse size of the box of precomputed light
    light_low: vec3f,
    // most cells a ray may visit
    most_cells: u32,
    light_scale: vec3f,
    // length that extinction coefficients are given for
    unit: f32,
    // shares of the light that visibility and the shadows of three lights dim
    light_weights: vec4f,
    // the share that nothing dims
    light_rest: f32,
}

@group(2) @binding(0) var<uniform> march: March;
// over the property's range: linear color and opacity of one step; integrals from the range's start
// of extinction times color, and of extinction; these themselves
@group(2) @binding(1) var colors: texture_2d<f32>;
// depth of opaque surfaces in the fourth component
@group(2) @binding(2) var surface: texture_2d<f32>;
// premultiplied linear color, opacity
@group(2) @binding(3) var volume_color: texture_storage_2d<rgba16float, write>;
// ambient visibility, and the shadows of three lights
@group(2) @binding(4) var light: texture_3d<f32>; // filterable
@group(2) @binding(5) var trilinear_sampler: sampler;

override LIT: bool = false;

struct Sum {
    color: vec3f,
    transmittance: f32,
    // number of the next sample: it lies at (number + 0.5) steps
    next: i32,
}

fn light_at(p: vec3f) -> f32 {
    if (!LIT) {
        return 1.0;
    }
    let at = (p - march.light_low) * march.light_scale;
    let dimmed = textureSampleLevel(light, trilinear_sampler, at, 0.0);
    return dot(march.light_weights, dimmed) + march.light_rest;
}

fn entry_of(value: f32) -> i32 {
    return i32(saturate(value) * march.table_end + 0.5);
}

fn take_sample(sum: ptr<function, Sum>, value: f32, p: vec3f) {
    let entry = textureLoad(colors, vec2i(entry_of(value), 0), 0);
    if (entry.w <= 0.0) {
        return;
    }
    (*sum).color += (*sum).transmittance * entry.w * entry.rgb * light_at(p);
    (*sum).transmittance *= 1.0 - entry.w;
}

// First sample at or after a distance.
fn sample_after(t: f32) -> i32 {
    return i32(ceil(t / march.step - 0.5));
}

fn sample_t(number: i32) -> f32 {
    return (f32(number) + 0.5) * march.step;
}

// The part of a pixel's ray that clipping planes and opaque surfaces leave.
fn ray_span(ray: Ray, pixel: vec2u) -> Span {
    var span = Span(0.0, NOTHING);
    if (view.orthographic != 0u) {
        span.near = -4.0 * model.extent;
    }
    for (var i = 0u; i < march.plane_count; i++) {
        let height = dot(march.planes[i].xyz, ray.origin) + march.planes[i].w;
        let slope = dot(march.planes[i].xyz, ray.direction);
        if (slope > 1e-12) {
            span.near = max(span.near, -height / slope);
        } else if (slope < -1e-12) {
            span.far = min(span.far, -height / slope);
        } else if (height < 0.0) {
            span.far = -NOTHING;
        }
    }
    let depth = textureLoad(surface, pixel, 0).w;
    if (depth > 0.0) {
        span.far = min(span.far, ray_distance(vec2f(pixel) + 0.5, depth));
    }
    return span;
}

fn finish(pixel: vec2u, sum: Sum) {
    // the rest of the way to the cutoff would hardly be seen: take it as passed
    let left = select(sum.transmittance, 0.0, sum.transmittance < march.cutoff);
    textureStore(volume_color, pixel, vec4f(sum.color, 1.0 - left));
}
