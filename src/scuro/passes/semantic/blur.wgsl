// Passes 4, 5 and 7: separable bilateral blur (Algorithm 3). One direction a dispatch.

//#include "tiles.wgsl"

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

@group(2) @binding(0) var<uniform> blur: Blur;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var source: texture_2d<f32>;
@group(2) @binding(3) var blurred: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = vec2i(textureDimensions(surface));
    let at = vec2i(pixel);
    if (any(at >= size)) {
        return;
    }
    let here = textureLoad(surface, at, 0);
    if (here.w <= 0.0) {
        textureStore(blurred, at, vec4f(0.0));
        return;
    }
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -blur.amount; i <= blur.amount; i += 1) {
        let other = at + i * blur.step;
        if (any(other < vec2i(0)) || any(other >= size)) {
            continue;
        }
        let there = textureLoad(surface, other, 0);
        if (there.w > 0.0 && abs(there.w - here.w) < blur.depth_limit
            && dot(there.xyz, here.xyz) > blur.normal_limit) {
            let x = f32(i) / (f32(blur.amount) * 1.5);
            let weight = exp(-x * x);
            sum += weight * textureLoad(source, other, 0);
            weights += weight;
        }
    }
    // its own pixel always counts: a normal limit of 1 leaves the picture as it is
    if (weights <= 0.0) {
        sum = textureLoad(source, at, 0);
        weights = 1.0;
    }
    textureStore(blurred, at, sum / weights);
}
