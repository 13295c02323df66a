// The sums of context_sums.wgsl with the path-traced scene.

//#include "tiles.wgsl"

struct Means {
    count: u32,
}

@group(2) @binding(0) var<uniform> means: Means;
@group(2) @binding(1) var<storage, read> context_sums: array<vec4f>;
// of the scene
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(replaced))) {
        return;
    }
    let at = 2u * (pixel.x + pixel.y * textureDimensions(replaced).x);
    let before = context_sums[at] / f32(means.count);
    let behind = context_sums[at + 1u] / f32(means.count);
    let traced = textureLoad(color, pixel, 0);
    let shown = before + (1.0 - before.a) * traced + (1.0 - traced.a) * behind;
    textureStore(replaced, pixel, shown);
}
