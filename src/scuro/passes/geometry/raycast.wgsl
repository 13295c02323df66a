// Primary visibility by ray casting: one ray a pixel through the acceleration structure.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace.wgsl"
//#include "visible.wgsl"

@group(2) @binding(0) var visible: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, in_blocks(local));
    let size = textureDimensions(visible);
    if (any(id >= size)) {
        return;
    }
    let ray = scene_ray(vec2f(id) + 0.5);
    let hit = trace_nearest(ray, 0.0, NOTHING);
    textureStore(visible, id, pack_visible(hit));
}
