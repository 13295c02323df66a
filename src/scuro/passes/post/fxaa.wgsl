// FXAA of `color`.

//#include "fxaa_smooth.wgsl"

// holds `color`
@group(2) @binding(5) var replaced: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = edge_pixel(id.x);
    if (all(pixel < textureDimensions(replaced))) {
        textureStore(replaced, pixel, smoothed(pixel));
    }
}
