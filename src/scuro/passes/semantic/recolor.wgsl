// Base colors by the level in view: every object's color comes from a table made each frame.

//#include "tiles.wgsl"
//#include "color.wgsl"

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(1) var albedo: texture_2d<f32>;
// sRGB, one an object; alpha 0 leaves an object's own colors
@group(2) @binding(2) var<storage, read> object_colors: array<u32>;
@group(2) @binding(3) var level_albedo: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(level_albedo);
    if (any(pixel >= size)) {
        return;
    }
    var color = textureLoad(albedo, pixel, 0);
    let object = textureLoad(ids, pixel, 0).z;
    if (object != 0xffffffffu) {
        let given = unpack4x8unorm(object_colors[object]);
        if (given.a > 0.0) {
            color = vec4f(linear_from_srgb(given.rgb), color.a);
        }
    }
    textureStore(level_albedo, pixel, color);
}
