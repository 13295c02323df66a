// From the visibility buffer to the G-buffer: the exact surface of the one primitive a pixel sees.
// Both visibility passes end here, so their G-buffers can differ only in which primitive won.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "surface.wgsl"
//#include "visible.wgsl"

@group(2) @binding(0) var visible: texture_2d<u32>;
// scene-space normal; depth along -z of the view, 0 where empty
@group(2) @binding(1) var surface: texture_storage_2d<rgba32float, write>;
// linear base color; 1 where there is a surface
@group(2) @binding(2) var albedo: texture_storage_2d<rgba16float, write>;
// element, instance, object, primitive; all ones where empty
@group(2) @binding(3) var ids: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    let size = textureDimensions(surface);
    if (any(id >= size)) {
        return;
    }
    let texel = textureLoad(visible, id, 0);
    if (texel.x == NO_PRIMITIVE) {
        textureStore(surface, id, vec4f(0.0));
        textureStore(albedo, id, vec4f(0.0));
        textureStore(ids, id, vec4u(NO_PRIMITIVE));
        return;
    }
    let pixel = vec2f(id) + 0.5;
    let ray = scene_ray(pixel);
    let found = surface_at(ray, unpack_visible(texel, ray));
    let depth = found.t * -view_ray(pixel).direction.z;
    textureStore(surface, id, vec4f(found.normal, depth));
    textureStore(albedo, id, vec4f(found.color, 1.0));
    textureStore(ids, id, vec4u(found.element, found.instance, found.object, texel.x));
}
