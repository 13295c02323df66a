// Pass 5: separable bilateral blur (Algorithm 3) of occlusion, bounce and shadow, each with its own
// radius; the latter two, found in one pixel of four, together. One direction a dispatch. Wide kernels leave pixels out: what they smooth is smooth already
// but for noise. Which pixels are taken and what they weigh comes from passes/semantic/smooth.py.

//#include "seen.wgsl"

// There is a shadow: beside the bounce, in alpha.
override HAS_SHADOW: bool = false;
// It lies in `lit`, not yet in the alpha of `source`.
override SHADOW_APART: bool = false;

struct Blur {
    // (1, 0) or (0, 1)
    step: vec2i,
    // how many taps on either side
    taps: u32,
    // differences of depth beyond this are edges, scene units
    depth_limit: f32,
    // dot products of normals below this are edges
    normal_limit: f32,
    // distance in pixels, weight in the light (or bounce), in the shadow
    weights: array<vec4f, 16>,
}

@group(2) @binding(1) var<uniform> blur: Blur;
// gathered light and visibility, or bounce; in the second dispatch this with the shadow in alpha
@group(2) @binding(2) var source: texture_2d<f32>;
@group(2) @binding(3) var lit: texture_2d<f32>;
@group(2) @binding(4) var blurred: texture_storage_2d<rgba16float, write>;

fn source_at(at: vec2i) -> vec4f {
    let found = textureLoad(source, at, 0);
    if (!HAS_SHADOW) {
        return vec4f(found.rgb, 1.0);
    }
    if (SHADOW_APART) {
        return vec4f(found.rgb, textureLoad(lit, at, 0).x);
    }
    return found;
}

// Blur a pixel; `apart` is the distance of those that are blurred.
fn blur_at(here: Seen, apart: i32) {
    if (here.outside || here.empty) {
        return;
    }
    let middle = vec2i(here.pixel);
    // its own pixel always counts
    var sum = source_at(middle);
    var weights = vec2f(1.0);
    for (var i = 0u; i < blur.taps + (i >> 31u); i += 1u) {
        let step = apart * i32(blur.weights[i].x) * blur.step;
        for (var side = -1; side <= 1; side += 2) {
            let at = middle + side * step;
            let inside = clamp(at, vec2i(0), vec2i(here.size) - 1);
            let there = textureLoad(surface, inside, 0);
            let near = all(inside == at)
                && joined(here, there, blur.depth_limit, blur.normal_limit);
            let weight = select(vec2f(0.0), blur.weights[i].yz, near);
            sum += weight.xxxy * source_at(inside);
            weights += weight;
        }
    }
    textureStore(blurred, here.pixel, sum / weights.xxxy);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    blur_at(seen(group, local), 1);
}

@compute @workgroup_size(8, 2)
fn thinly(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    blur_at(seen_thinly(group, local), i32(THIN));
}
