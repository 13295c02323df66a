// The finished picture.

//#include "tiles.wgsl"
//#include "encoded.wgsl"

@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(1) var picture: texture_storage_2d<rgba8unorm, write>;

fn store(pixel: vec2u) {
    if (all(pixel < textureDimensions(picture))) {
        textureStore(picture, pixel, encoded(textureLoad(color, pixel, 0)));
    }
}

@compute @workgroup_size(8, 8)
fn everywhere(@builtin(global_invocation_id) id: vec3u) {
    store(id.xy);
}

@compute @workgroup_size(8, 8)
fn tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    store(tile_pixel(group, local));
}
