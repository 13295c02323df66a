// The context's surfaces (context.py) into the scene's G-buffer, numbered after the scene's own.

//#include "tiles.wgsl"

struct Numbers {
    // how many objects and instances the scene has without the context
    object: u32,
    instance: u32,
}

@group(2) @binding(0) var<uniform> numbers: Numbers;
// of the context
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var albedo: texture_2d<f32>;
@group(2) @binding(3) var ids: texture_2d<u32>;
// 1 where it is nearer than the scene
@group(2) @binding(7) var nearer: texture_2d<f32>;
@group(2) @binding(4) var over_surface: texture_storage_2d<rgba32float, write>;
@group(2) @binding(5) var over_albedo: texture_storage_2d<rgba16float, write>;
@group(2) @binding(6) var over_ids: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(surface))) {
        return;
    }
    if (textureLoad(nearer, id, 0).x == 0.0) {
        return;
    }
    textureStore(over_surface, id, textureLoad(surface, id, 0));
    textureStore(over_albedo, id, textureLoad(albedo, id, 0));
    textureStore(over_ids, id,
        textureLoad(ids, id, 0) + vec4u(0u, numbers.instance, numbers.object, 0u));
}
