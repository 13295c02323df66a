// The light of the context (context.py) over that of the scene: nothing occludes it or shadows it.

//#include "tiles.wgsl"

// of the context, nearer than the scene wherever there is any
@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var surface_behind: texture_2d<f32>;
@group(2) @binding(3) var over_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(4) var visibility: texture_storage_2d<r32float, write>;
@group(2) @binding(5) var shadow: texture_storage_2d_array<r32float, write>;

override HAS_OCCLUSION: bool = false;
override HAS_SHADOWS: bool = false;
// Whether the scene's edges are smooth and the context already lies under them: a pixel whose middle
// the scene misses may show some of it.
override SMOOTH: bool = false;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(surface)) || textureLoad(surface, id, 0).w <= 0.0) {
        return;
    }
    if (!SMOOTH || textureLoad(surface_behind, id, 0).w > 0.0) {
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
