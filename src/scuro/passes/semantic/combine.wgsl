// Pass 8: color x occlusion x shadow + bounce.

//#include "seen.wgsl"

override HAS_BOUNCE: bool = true;

struct Combining {
    // what is an edge, as in blur.wgsl
    depth_limit: f32,
    normal_limit: f32,
}

@group(2) @binding(1) var<uniform> combining: Combining;
@group(2) @binding(2) var albedo: texture_2d<f32>;
// its alpha is the shadow, 1 = lit
@group(2) @binding(3) var gathered: texture_2d<f32>;
// in one pixel of each block (seen_thinly)
@group(2) @binding(4) var bounce: texture_2d<f32>;
// linear, premultiplied by alpha
@group(2) @binding(5) var color: texture_storage_2d<rgba16float, write>;

// What joins a pixel to none of the four about it: little, but not nothing.
const LEAST: f32 = 1e-3;

// The bounce between the four pixels about one that have any: linear, but not across edges.
fn bounce_at(here: Seen) -> vec3f {
    let first = here.pixel / THIN * THIN;
    var sum = vec3f(0.0);
    var weights = 1e-6;
    for (var k = 0u; k < 4u; k += 1u) {
        let at = first + THIN * vec2u(k & 1u, k >> 1u);
        let inside = min(at, here.size - 1u);
        let there = textureLoad(surface, inside, 0);
        let near = 1.0 - abs(vec2f(at) - vec2f(here.pixel)) / f32(THIN);
        let same = joined(here, there, combining.depth_limit, combining.normal_limit);
        let exists = all(inside == at) && there.w > 0.0;
        let weight = (near.x * near.y + LEAST * LEAST) * select(LEAST, 1.0, same);
        let counted = select(0.0, weight, exists);
        sum += counted * textureLoad(bounce, inside, 0).rgb;
        weights += counted;
    }
    return sum / weights;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let base = textureLoad(albedo, here.pixel, 0).rgb;
    let found = textureLoad(gathered, here.pixel, 0);
    var light = found.rgb * found.a;
    if (HAS_BOUNCE) {
        light += bounce_at(here);
    }
    textureStore(color, here.pixel, vec4f(base * light, 1.0));
}
