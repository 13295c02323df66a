// Reconstruction by the filter of Mitchell & Netravali (1988) with B = C = 1/3: sharper than a box
// or a tent, and its negative lobes are too small to ring visibly along dark borders, as Lanczos's
// do. Separable; in linear premultiplied light.

struct Mitchell {
    // samples along a pixel's edge
    scale: u32,
}

@group(2) @binding(0) var<uniform> mitchell: Mitchell;
@group(2) @binding(1) var source: texture_2d<f32>;
@group(2) @binding(2) var result: texture_storage_2d<rgba16float, write>;

fn weight(distance: f32) -> f32 {
    let x = abs(distance);
    if (x >= 2.0) {
        return 0.0;
    }
    if (x >= 1.0) {
        return ((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x / 6.0 + 32.0 / 18.0;
    }
    return (7.0 * x - 12.0) * x * x / 6.0 + 16.0 / 18.0;
}

fn filtered(pixel: vec2i, axis: vec2i) -> vec4f {
    let scale = i32(mitchell.scale);
    let last = vec2i(textureDimensions(source)) - 1;
    let first = dot(pixel, axis) * scale;
    let center = f32(first) + 0.5 * f32(scale);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var i = first + scale / 2 - 2 * scale; i < first + scale / 2 + 2 * scale + 1; i += 1) {
        let w = weight((f32(i) + 0.5 - center) / f32(scale));
        let place = clamp(pixel * (vec2i(1) - axis) + i * axis, vec2i(0), last);
        // a highlight brighter than white must not outweigh its neighbours: edges would alias
        sum += w * min(textureLoad(source, place, 0), vec4f(1.0));
        total += w;
    }
    let mean = max(sum / total, vec4f(0.0));
    let alpha = min(mean.a, 1.0);
    return vec4f(mean.rgb, alpha);
}

@compute @workgroup_size(8, 8)
fn across(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < textureDimensions(result))) {
        textureStore(result, id.xy, filtered(vec2i(id.xy), vec2i(1, 0)));
    }
}

@compute @workgroup_size(8, 8)
fn down(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < textureDimensions(result))) {
        textureStore(result, id.xy, filtered(vec2i(id.xy), vec2i(0, 1)));
    }
}
