// What FXAA compares: the brightness of each pixel, found once, for it is read many times.

//#include "tiles.wgsl"
//#include "color.wgsl"

struct Fxaa {
    // linear, premultiplied
    background: vec4f,
}

@group(2) @binding(0) var<uniform> fxaa: Fxaa;
@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var brightness: texture_storage_2d<r32float, write>;

// Brightness as seen over the background; what is transparent in the end differs by its alpha.
@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(brightness))) {
        return;
    }
    let c = textureLoad(color, pixel, 0);
    let over = saturate(c.rgb + fxaa.background.rgb * (1.0 - c.a));
    let luma = 0.5 * c.a * (1.0 - fxaa.background.a) + sqrt(luminance(over));
    textureStore(brightness, pixel, vec4f(luma));
}
