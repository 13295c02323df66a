// Pass 6: shadows between regions by marching through the depth buffer towards the key light
// (Algorithm 4). Steps are bounded, and grow with the distance gone. They are blurred widely, so one pixel
// in four marches.

//#include "thin.wgsl"
//#include "labelled.wgsl"
//#include "lights.wgsl"
//#include "halton.wgsl"
//#include "reach.wgsl"

struct Shadow {
    steps: u32,
    // how far the march goes, scene units
    reach: f32,
    // what is thicker than this in depth does not block: it may lie far in front, scene units
    thickness: f32,
    // how dark a full shadow is
    strength: f32,
    // how far the march goes in the picture, pixels
    limit: f32,
}

@group(2) @binding(3) var<uniform> shadow: Shadow;
@group(2) @binding(4) var<uniform> lights: Lights;
// 1 = lit
@group(2) @binding(5) var lit: texture_storage_2d<r32float, write>;

// How lit a pixel is.
fn lit_at(here: Seen) -> f32 {
    let arriving = incoming_light(lights.list[0], seen_position(here));
    let start = view_position(vec2f(here.pixel) + 0.5, here.depth);
    let way = radius_within(min(shadow.reach, arriving.distance), start, shadow.limit)
        * (view.view_from_scene * vec4f(arriving.direction, 0.0)).xyz;
    // pixels and depth go evenly along the ray in homogeneous coordinates
    let first = pixel_from_view(start);
    let scale = vec2f(0.5, -0.5) * view.size / view.half_extent;
    let perspective = view.orthographic == 0u;
    let weight = select(1.0, here.depth, perspective);
    let middle = 0.5 * view.size - view.origin - view.jitter;
    let origin = vec3f((first.xy - middle) * weight, here.depth);
    let along = vec3f(scale * way.xy, -way.z);
    let skin = pixel_width(here.depth);
    let own = labelled_at(here.pixel).labels;
    let noise = pixel_noise(here.pixel + vec2u(view.origin), view.seed + 1u);
    let offset = fract(noise.x + f32(view.frame) * 0.618034);
    // at level t and at t + 1
    var blocked = vec2f(0.0);
    for (var i = 0u; i < shadow.steps; i += 1u) {
        let share = (f32(i) + offset) / f32(shadow.steps);
        let point = origin + share * share * along;
        let at = vec2i(floor(point.xy / select(1.0, point.z, perspective) + middle));
        if (point.z <= 0.0 || any(at < vec2i(0)) || any(at >= vec2i(here.size))) {
            break;
        }
        let found = labelled_at(vec2u(at));
        let above = point.z - found.depth;
        if (found.depth > 0.0 && above > skin && above < shadow.thickness) {
            blocked = max(blocked, vec2f(found.labels != own));
            if (all(blocked > vec2f(0.0))) {
                break;
            }
        }
    }
    return 1.0 - shadow.strength * mix(blocked.x, blocked.y, levels.blend);
}

@compute @workgroup_size(8, 2)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let first = seen_thinly(group, local);
    if (first.outside || lights.count == 0u) {
        return;
    }
    for (var rest = wanted_of(first); rest != 0u; rest &= rest - 1u) {
        let k = countTrailingZeros(rest);
        let here = seen_at(first.pixel + vec2u(k & 1u, k >> 1u));
        textureStore(lit, here.pixel, vec4f(lit_at(here)));
    }
}
