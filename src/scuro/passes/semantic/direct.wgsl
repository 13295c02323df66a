// Pass 2: Lambert shading by all lights, each attenuated by 1 / (A_c + A_l d + A_q d^2)
// (equations 3.7 and 4.1). What the bounce gathers.

//#include "tiles.wgsl"
//#include "view.wgsl"
//#include "lights.wgsl"

@group(2) @binding(0) var<uniform> lights: Lights;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var albedo: texture_2d<f32>;
@group(2) @binding(3) var diffuse: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(diffuse);
    if (any(pixel >= size)) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        textureStore(diffuse, pixel, vec4f(0.0));
        return;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    var sum = vec3f(0.0);
    for (var i = 0u; i < lights.count; i += 1u) {
        let arriving = incoming_light(lights.list[i], position);
        sum += max(dot(texel.xyz, arriving.direction), 0.0) * arriving.color;
    }
    textureStore(diffuse, pixel, vec4f(sum * textureLoad(albedo, pixel, 0).rgb, 1.0));
}
