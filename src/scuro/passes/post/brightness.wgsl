// What FXAA compares: brightness as seen over the background; what is transparent in the end differs
// by its alpha.

//#include "encoded.wgsl"

@group(2) @binding(21) var brightness: texture_storage_2d<r32float, write>;

fn store_brightness(pixel: vec2u, color: vec4f) {
    let over = saturate(color.rgb + encode.background.rgb * (1.0 - color.a));
    let luma = 0.5 * color.a * (1.0 - encode.background.a) + sqrt(luminance(over));
    textureStore(brightness, pixel, vec4f(luma));
}
