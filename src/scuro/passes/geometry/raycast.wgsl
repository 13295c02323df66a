// Primary visibility by ray casting: one ray a pixel through the acceleration structure.

//#include "view.wgsl"
//#include "trace.wgsl"
//#include "visible.wgsl"

@group(2) @binding(0) var visible: texture_storage_2d<rg32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(visible);
    if (any(id.xy >= size)) {
        return;
    }
    let ray = scene_ray(vec2f(id.xy) + 0.5);
    let hit = trace_nearest(ray, 0.0, NOTHING);
    textureStore(visible, id.xy, vec4u(pack_visible(hit), 0u, 0u));
}
