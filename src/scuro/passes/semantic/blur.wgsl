// Passes 4, 5 and 7: separable bilateral blur (Algorithm 3). One direction a dispatch. Wide kernels
// leave pixels out: what they smooth is smooth already but for noise.

//#include "seen.wgsl"

struct Blur {
    // (1, 0) or (0, 1)
    step: vec2i,
    // kernel radius in pixels
    amount: i32,
    // differences of depth beyond this are edges, scene units
    depth_limit: f32,
    // dot products of normals below this are edges
    normal_limit: f32,
}

@group(2) @binding(1) var<uniform> blur: Blur;
@group(2) @binding(2) var source: texture_2d<f32>;
@group(2) @binding(3) var blurred: texture_storage_2d<rgba16float, write>;

// One pixel in two is taken from this radius on, one in three from twice this.
const WIDE: i32 = 5;

// Four channels and the weight of a tap; nothing beyond an edge.
fn tap(here: Seen, at: vec2i, weight: f32, sum: ptr<function, vec4f>, weights: ptr<function, f32>) {
    let inside = vec2u(clamp(at, vec2i(0), vec2i(here.size) - 1));
    let there = textureLoad(surface, inside, 0);
    let near = all(vec2i(inside) == at) && there.w > 0.0
        && abs(there.w - here.depth) < blur.depth_limit
        && dot(there.xyz, here.normal) > blur.normal_limit;
    let w = select(0.0, weight, near);
    *sum += w * textureLoad(source, inside, 0);
    *weights += w;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let at = vec2i(here.pixel);
    var sum = vec4f(0.0);
    var weights = 0.0;
    tap(here, at, 1.0, &sum, &weights);
    let stride = 1 + blur.amount / WIDE;
    for (var i = 1; i <= blur.amount; i += stride) {
        let x = f32(i) / (f32(blur.amount) * 1.5);
        let weight = exp(-x * x);
        tap(here, at + i * blur.step, weight, &sum, &weights);
        tap(here, at - i * blur.step, weight, &sum, &weights);
    }
    // its own pixel always counts: a normal limit of 1 leaves the picture as it is
    if (weights <= 0.0) {
        sum = textureLoad(source, at, 0);
        weights = 1.0;
    }
    textureStore(blurred, at, sum / weights);
}
