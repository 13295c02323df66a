// The brightness of each pixel, where no pass before has stored it.

//#include "tiles.wgsl"
//#include "brightness.wgsl"

@group(2) @binding(0) var color: texture_2d<f32>;

fn store(pixel: vec2u) {
    if (all(pixel < textureDimensions(brightness))) {
        store_brightness(pixel, textureLoad(color, pixel, 0));
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
