// Deferred shading by itself, where other passes come before the depth cues.

//#include "tiles.wgsl"
//#include "shaded.wgsl"

@group(2) @binding(1) var albedo: texture_2d<f32>;
// linear, premultiplied by alpha
@group(2) @binding(2) var color: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (all(id < textureDimensions(color))) {
        let base = textureLoad(albedo, id, 0).rgb;
        textureStore(color, id, shaded(id, textureLoad(surface, id, 0), base));
    }
}
