// Pass 5: separable bilateral blur (Algorithm 3) of occlusion, bounce and shadow, each with its own
// radius. One direction a dispatch. Wide kernels leave pixels out: what they smooth is smooth already
// but for noise. Which pixels are taken and what they weigh comes from passes/semantic/smooth.py.

//#include "seen.wgsl"

// What of `source` and `beside` is there.
override HAS_BOUNCE: bool = true;
override HAS_SHADOW: bool = true;
// The shadow lies in `lit`, not yet in the alpha of `beside`.
override SHADOW_APART: bool = true;

struct Blur {
    // (1, 0) or (0, 1)
    step: vec2i,
    // how many taps on either side: of the light, of bounce and shadow
    light_taps: u32,
    beside_taps: u32,
    // differences of depth beyond this are edges, scene units
    depth_limit: f32,
    // dot products of normals below this are edges
    normal_limit: f32,
    // distance in pixels, weight
    light: array<vec4f, 8>,
    // distance in pixels, weight in the bounce, in the shadow
    beside: array<vec4f, 16>,
}

@group(2) @binding(1) var<uniform> blur: Blur;
// gathered light, and visibility
@group(2) @binding(2) var source: texture_2d<f32>;
// bounce, and shadow
@group(2) @binding(3) var source_beside: texture_2d<f32>;
@group(2) @binding(4) var lit: texture_2d<f32>;
@group(2) @binding(5) var blurred: texture_storage_2d<rgba16float, write>;
@group(2) @binding(6) var blurred_beside: texture_storage_2d<rgba16float, write>;

// The pixel of a tap, and 1 if no edge lies between; 0 beyond an edge or the picture.
struct Tap {
    at: vec2i,
    counts: f32,
}

fn tap(here: Seen, offset: i32) -> Tap {
    let at = vec2i(here.pixel) + offset * blur.step;
    let inside = clamp(at, vec2i(0), vec2i(here.size) - 1);
    let there = textureLoad(surface, inside, 0);
    let near = all(inside == at) && there.w > 0.0
        && abs(there.w - here.depth) < blur.depth_limit
        && dot(there.xyz, here.normal) > blur.normal_limit;
    return Tap(inside, select(0.0, 1.0, near));
}

// Bounce and shadow of a pixel.
fn beside_at(at: vec2i) -> vec4f {
    if (!HAS_BOUNCE && SHADOW_APART) {
        return vec4f(0.0, 0.0, 0.0, textureLoad(lit, at, 0).x);
    }
    let found = textureLoad(source_beside, at, 0);
    if (HAS_SHADOW && SHADOW_APART) {
        return vec4f(found.rgb, textureLoad(lit, at, 0).x);
    }
    return found;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    // its own pixel always counts
    var sum = textureLoad(source, here.pixel, 0);
    var weights = 1.0;
    for (var i = 0u; i < blur.light_taps + (i >> 31u); i += 1u) {
        let offset = i32(blur.light[i].x);
        for (var side = -1; side <= 1; side += 2) {
            let there = tap(here, side * offset);
            let weight = there.counts * blur.light[i].y;
            sum += weight * textureLoad(source, there.at, 0);
            weights += weight;
        }
    }
    textureStore(blurred, here.pixel, sum / weights);
    if (!HAS_BOUNCE && !HAS_SHADOW) {
        return;
    }
    var beside = beside_at(vec2i(here.pixel));
    var weights_beside = vec2f(1.0);
    for (var i = 0u; i < blur.beside_taps + (i >> 31u); i += 1u) {
        let offset = i32(blur.beside[i].x);
        for (var side = -1; side <= 1; side += 2) {
            let there = tap(here, side * offset);
            let weight = there.counts * blur.beside[i].yz;
            beside += weight.xxxy * beside_at(there.at);
            weights_beside += weight;
        }
    }
    textureStore(blurred_beside, here.pixel, beside / weights_beside.xxxy);
}
