// Pass 2: Lambert shading by all lights, each attenuated by 1 / (A_c + A_l d + A_q d^2)
// (equations 3.7 and 4.1). What the bounce gathers.

//#include "seen.wgsl"
//#include "lights.wgsl"

@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var albedo: texture_2d<f32>;
@group(2) @binding(3) var diffuse: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let position = seen_position(here);
    var sum = vec3f(0.0);
    for (var i = 0u; i < LIGHT_COUNT + (i >> 31u); i += 1u) {
        let arriving = incoming_light(lights.list[i], position);
        sum += max(dot(here.normal, arriving.direction), 0.0) * arriving.color;
    }
    textureStore(diffuse, here.pixel, vec4f(sum * textureLoad(albedo, here.pixel, 0).rgb, 1.0));
}
