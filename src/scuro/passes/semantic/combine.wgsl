// Pass 8: color x occlusion x shadow + bounce.

//#include "thin.wgsl"

// There is a bounce or shadow.
override HAS_THIN: bool = true;

@group(2) @binding(2) var albedo: texture_2d<f32>;
@group(2) @binding(3) var gathered: texture_2d<f32>;
// in one pixel of each block (seen_thinly); its alpha is the shadow, 1 = lit
@group(2) @binding(4) var bounce: texture_2d<f32>;
// the shadow of pixels that lie in other depths than all of these
@group(2) @binding(5) var lit: texture_2d<f32>;
// linear, premultiplied by alpha
@group(2) @binding(6) var color: texture_storage_2d<rgba16float, write>;

// What joins a pixel to none of the four about it: little, but not nothing.
const LEAST: f32 = 1e-3;

// Bounce and shadow between the four pixels about one that have any: linear, but not across edges.
fn between(here: Seen) -> vec4f {
    var sum = vec4f(0.0);
    var weights = 1e-6;
    var held = false;
    for (var k = 0u; k < 4u; k += 1u) {
        let beside = corner(k, here);
        let near = 1.0 - abs(vec2f(beside.pixel) - vec2f(here.pixel)) / f32(THIN);
        let share = near.x * near.y;
        let same = joined(here, beside.there, edges.depth_limit, edges.normal_limit);
        let weight = (share + LEAST * LEAST) * select(LEAST, 1.0, same);
        let counted = select(0.0, weight, beside.there.w > 0.0);
        sum += counted * textureLoad(bounce, beside.pixel, 0);
        weights += counted;
        held |= share > 0.0 && level_with(beside.there.w, here.depth);
    }
    // the rest has a shadow of its own (thin.wgsl)
    let shadow = select(textureLoad(lit, here.pixel, 0).x, sum.a / weights, held);
    return vec4f(sum.rgb / weights, shadow);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let base = textureLoad(albedo, here.pixel, 0).rgb;
    var light = textureLoad(gathered, here.pixel, 0).rgb;
    if (HAS_THIN) {
        let found = between(here);
        light = light * found.a + found.rgb;
    }
    textureStore(color, here.pixel, vec4f(base * light, 1.0));
}
