// Shadows of the key light in object space: its ray counts a hit only if it lies in another region. They
// are blurred widely, so one pixel in four sends it.

//#include "thin.wgsl"
//#include "blocked.wgsl"
//#include "lights.wgsl"

struct TracedShadow {
    // how dark a full shadow is
    strength: f32,
}

@group(2) @binding(2) var<uniform> shadow: TracedShadow;
@group(2) @binding(3) var<uniform> lights: Lights;
@group(2) @binding(4) var ids: texture_2d<u32>;
// as in shadow.wgsl
@group(2) @binding(5) var lit: texture_storage_2d<r32float, write>;

// How lit a pixel is.
fn lit_at(here: Seen) -> f32 {
    let position = seen_position(here);
    let origin = position + here.normal * surface_offset(position, here.depth);
    let own = textureLoad(ids, here.pixel, 0);
    let arriving = incoming_light(lights.list[0], position);
    let ray = Ray(origin, arriving.direction);
    var dark = 0.0;
    // a loop, so that the tracer is compiled into it once
    let first = select(0u, 1u, levels.blend >= 1.0);
    let end = select(1u, 2u, levels.blend > 0.0);
    for (var k = first; k < end; k += 1u) {
        var level = levels.here;
        if (k == 1u) {
            level = levels.next;
        }
        let share = select(1.0 - levels.blend, levels.blend, k == 1u);
        dark += share * select(0.0, 1.0, blocked(ray, arriving.distance, level, own));
    }
    return 1.0 - shadow.strength * dark;
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
