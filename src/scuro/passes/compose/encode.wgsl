// From linear premultiplied color to the 8-bit sRGB picture, over the background or with alpha.

//#include "color.wgsl"

struct Encode {
    // linear RGB and opacity of the background
    background: vec4f,
}

@group(2) @binding(0) var<uniform> encode: Encode;
@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var picture: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(picture);
    if (any(id.xy >= size)) {
        return;
    }
    let over = textureLoad(color, id.xy, 0);
    let under = vec4f(encode.background.rgb * encode.background.a, encode.background.a);
    let sum = over + under * (1.0 - over.a);
    // straight alpha in the file
    let straight = select(vec3f(0.0), sum.rgb / max(sum.a, 1e-6), sum.a > 0.0);
    textureStore(picture, id.xy, vec4f(srgb_from_linear(saturate(straight)), sum.a));
}
