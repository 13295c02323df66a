// The next transparent object along each pixel's ray, in front of all that is opaque.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace.wgsl"
//#include "visible.wgsl"

// Whether a layer was found before this one.
override LATER: bool = false;

// of what is opaque
@group(2) @binding(0) var opaque_surface: texture_2d<f32>;
// of the layer before
@group(2) @binding(1) var layer_surface: texture_2d<f32>;
@group(2) @binding(2) var layer_visible: texture_2d<u32>;
@group(2) @binding(3) var visible: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(visible))) {
        return;
    }
    let pixel = vec2f(id) + 0.5;
    let ray = scene_ray(pixel);
    let behind = textureLoad(opaque_surface, id, 0).w;
    var end = select(NOTHING, ray_distance(pixel, behind), behind > 0.0);
    var start = 0.0;
    if (LATER) {
        let before = textureLoad(layer_surface, id, 0).w;
        start = ray_distance(pixel, before);
        end = select(-1.0, end, before > 0.0);
        ray_passed = hit_number(unpack_visible(textureLoad(layer_visible, id, 0), ray));
    }
    let hit = trace_nearest(ray, start, end);
    textureStore(visible, id, pack_visible(hit));
}
