// Red-cyan anaglyph by Dubois (2001): the colours of linear light that come nearest, through the
// glasses' measured filters, to what each eye should see.

struct Anaglyph {
    // linear, premultiplied
    background: vec4f,
}

@group(2) @binding(0) var<uniform> anaglyph: Anaglyph;
@group(2) @binding(1) var left: texture_2d<f32>;
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

// Columns: what red, green and blue of an eye's picture become.
const FROM_LEFT = mat3x3f(
    0.4561, -0.0400822, -0.0152161,
    0.500484, -0.0378246, -0.0205971,
    0.176381, -0.0157589, -0.00546856,
);
const FROM_RIGHT = mat3x3f(
    -0.0434706, 0.378476, -0.0721527,
    -0.0879388, 0.73364, -0.112961,
    -0.00155529, -0.0184503, 1.2264,
);

fn seen(over: vec4f) -> vec4f {
    return over + anaglyph.background * (1.0 - over.a);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(replaced))) {
        return;
    }
    // each eye sees the background around its own picture, before the colours are mixed
    let l = seen(textureLoad(left, id.xy, 0));
    let r = seen(textureLoad(color, id.xy, 0));
    let rgb = FROM_LEFT * saturate(l.rgb) + FROM_RIGHT * saturate(r.rgb);
    textureStore(replaced, id.xy, vec4f(max(rgb, vec3f(0.0)), max(l.a, r.a)));
}
