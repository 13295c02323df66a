// Layers of transparent objects, nearest first, over each other and over what is opaque.

//#include "tiles.wgsl"
//#include "scene.wgsl"

// One more layer (or, at the end, the opaque picture) behind those before.
override LAST: bool = false;

@group(2) @binding(0) var front: texture_2d<f32>;
@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var ids: texture_2d<u32>;
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(replaced))) {
        return;
    }
    let before = textureLoad(front, id, 0);
    let behind = textureLoad(color, id, 0);
    var opacity = 1.0;
    if (!LAST) {
        opacity = material_at(textureLoad(ids, id, 0).z).opacity;
    }
    textureStore(replaced, id, before + (1.0 - before.a) * opacity * behind);
}
