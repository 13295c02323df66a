// The light of the context (context.py) over that of the scene: nothing occludes it or shadows it.

//#include "tiles.wgsl"

// of the context
@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var scene_surface: texture_2d<f32>;
@group(2) @binding(3) var over_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(4) var visibility: texture_storage_2d<r32float, write>;
@group(2) @binding(5) var shadow: texture_storage_2d_array<r32float, write>;
// 1 where the context is nearer than the scene
@group(2) @binding(6) var nearer: texture_storage_2d<r32float, write>;

override HAS_OCCLUSION: bool = false;
override HAS_SHADOWS: bool = false;
// Whether edges are smooth and the color has the context already.
override SMOOTH: bool = false;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(nearer))) {
        return;
    }
    let depth = textureLoad(surface, id, 0).w;
    let scene_depth = textureLoad(scene_surface, id, 0).w;
    let shows = depth > 0.0 && (scene_depth <= 0.0 || depth < scene_depth);
    textureStore(nearer, id, vec4f(select(0.0, 1.0, shows)));
    if (!shows) {
        return;
    }
    if (!SMOOTH) {
        textureStore(over_color, id, textureLoad(color, id, 0));
    }
    if (HAS_OCCLUSION) {
        textureStore(visibility, id, vec4f(1.0));
    }
    if (HAS_SHADOWS) {
        for (var layer = 0u; layer < textureNumLayers(shadow); layer += 1u) {
            textureStore(shadow, id, layer, vec4f(1.0));
        }
    }
}
