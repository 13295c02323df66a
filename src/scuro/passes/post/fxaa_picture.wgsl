// FXAA of what was encoded: the listed pixels of the picture are encoded once more, smoothed.

//#include "fxaa_smooth.wgsl"
//#include "encoded.wgsl"

@group(2) @binding(5) var picture: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = edge_pixel(id.x);
    if (all(pixel < textureDimensions(picture))) {
        textureStore(picture, pixel, encoded(smoothed(pixel)));
    }
}
