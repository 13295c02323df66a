// Visibility to a power: above 1 darkens creases, below 1 lightens them.

//#include "tiles.wgsl"

struct Strength {
    exponent: f32,
}

@group(2) @binding(0) var<uniform> strength: Strength;
@group(2) @binding(1) var visibility: texture_2d<f32>;
@group(2) @binding(2) var result: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (all(pixel < textureDimensions(result))) {
        let open = textureLoad(visibility, pixel, 0).x;
        textureStore(result, pixel, vec4f(pow(open, strength.exponent)));
    }
}
