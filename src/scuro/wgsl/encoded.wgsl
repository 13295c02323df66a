// Linear premultiplied light as a picture holds it: sRGB, over the background, with straight alpha.

//#include "color.wgsl"

struct Encode {
    // linear, premultiplied
    background: vec4f,
}

@group(2) @binding(20) var<uniform> encode: Encode;

fn encoded(over: vec4f) -> vec4f {
    let sum = over + encode.background * (1.0 - over.a);
    let straight = select(vec3f(0.0), sum.rgb / max(sum.a, 1e-6), sum.a > 0.0);
    return vec4f(srgb_from_linear(saturate(straight)), sum.a);
}
