// What FXAA compares: brightness as seen over the background; what is transparent in the end differs
// by its alpha. As through a reddish filter, so that hues which are equally light differ.

//#include "encoded.wgsl"

@group(2) @binding(21) var brightness: texture_storage_2d<r32float, write>;

// As in passes/post/fxaa.py; greys are as bright as they are.
const FILTER: vec3f = vec3f(0.8, 0.15, 0.05);

fn store_brightness(pixel: vec2u, color: vec4f) {
    let over = saturate(color.rgb + encode.background.rgb * (1.0 - color.a));
    let luma = 0.5 * color.a * (1.0 - encode.background.a) + sqrt(dot(over, FILTER));
    textureStore(brightness, pixel, vec4f(luma));
}
