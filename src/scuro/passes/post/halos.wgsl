// Halos: how far a pixel lies behind the blurred depth around it (Luft et al. 2006, unsharp masking
// of the depth buffer) gives an opacity that grows with the depth jump and fades with distance on
// the screen. The blurred depth is smooth, so that it is made at a lower resolution.

//#include "view.wgsl"
//#include "halo_types.wgsl"

@group(2) @binding(1) var surface: texture_2d<f32>;
// blurred depth x coverage, blurred coverage; reduced
@group(2) @binding(2) var source: texture_2d<f32>;
@group(2) @binding(3) var color: texture_2d<f32>;
@group(2) @binding(4) var replaced: texture_storage_2d<rgba16float, write>;

fn blurred(pixel: vec2u) -> vec2f {
    let place = (vec2f(pixel) + 0.5) / f32(halos.reduction) - 0.5;
    let last = vec2i(textureDimensions(source)) - 1;
    let low = vec2i(floor(place));
    let share = place - floor(place);
    let zero = vec2i(0);
    let upper = mix(textureLoad(source, clamp(low, zero, last), 0).xy,
        textureLoad(source, clamp(low + vec2i(1, 0), zero, last), 0).xy, share.x);
    let lower = mix(textureLoad(source, clamp(low + vec2i(0, 1), zero, last), 0).xy,
        textureLoad(source, clamp(low + vec2i(1, 1), zero, last), 0).xy, share.x);
    return mix(upper, lower, share.y);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(replaced))) {
        return;
    }
    let around = blurred(id.xy);
    let depth = textureLoad(surface, id.xy, 0).w;
    // a straight edge covers half of the surroundings of the pixels along it
    var strength = 2.0 * around.y;
    if (depth > 0.0) {
        strength *= max(scaled(depth) - around.x / max(around.y, 1e-4), 0.0);
    }
    strength = halos.opacity * saturate(strength);
    let under = textureLoad(color, id.xy, 0);
    textureStore(replaced, id.xy, mix(under, vec4f(halos.color, 1.0), strength));
}
