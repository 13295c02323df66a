// Pass 8: color x occlusion x shadow + bounce.

//#include "tiles.wgsl"

@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(1) var albedo: texture_2d<f32>;
@group(2) @binding(2) var gathered: texture_2d<f32>;
@group(2) @binding(3) var bounce: texture_2d<f32>;
@group(2) @binding(4) var lit: texture_2d<f32>;
// linear, premultiplied by alpha
@group(2) @binding(5) var color: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(color);
    if (any(pixel >= size)) {
        return;
    }
    if (textureLoad(surface, pixel, 0).w <= 0.0) {
        textureStore(color, pixel, vec4f(0.0));
        return;
    }
    let base = textureLoad(albedo, pixel, 0).rgb;
    let direct = textureLoad(gathered, pixel, 0).rgb * textureLoad(lit, pixel, 0).x;
    textureStore(color, pixel, vec4f(base * (direct + textureLoad(bounce, pixel, 0).rgb), 1.0));
}
