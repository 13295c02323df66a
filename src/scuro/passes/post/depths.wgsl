// The G-buffer's depth by itself, huge where empty, for passes that read many neighbours.

//#include "tiles.wgsl"

@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(1) var depths: texture_storage_2d<r32float, write>;

// As passes/post/depth.py clears it.
const FAR: f32 = 3.0e38;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (all(id < textureDimensions(depths))) {
        let depth = textureLoad(surface, id, 0).w;
        textureStore(depths, id, vec4f(select(FAR, depth, depth > 0.0)));
    }
}
