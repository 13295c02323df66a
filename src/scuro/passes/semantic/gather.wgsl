// Light gathered from the open directions about a point (equation 3.1), with its own colour.

//#include "lights.wgsl"
//#include "halton.wgsl"

@group(2) @binding(2) var<uniform> lights: Lights;
// light from the open directions, as it falls on white; scalar visibility (1 = open)
@group(2) @binding(3) var gathered: texture_storage_2d<rgba16float, write>;

// The mean of max(dot(w, l), 0) over cosine-distributed w is 2/3 where l is the normal: with this
// factor an open surface that faces a light is as bright as Lambert's law makes it.
const FACING: f32 = 1.5;

// Sums over directions.
struct Gathering {
    light: vec3f,
    open: f32,
}

fn gather(sum: ptr<function, Gathering>, direction: vec3f, open: f32, position: vec3f) {
    var light = lights.ambient;
    for (var k = 0u; k < LIGHT_COUNT + (k >> 31u); k += 1u) {
        let arriving = incoming_light(lights.list[k], position);
        light += FACING * max(dot(direction, arriving.direction), 0.0) * arriving.color;
    }
    (*sum).light += open * light;
    (*sum).open += open;
}

// Store the mean; `strength` bends its curve: 1 leaves it, 0 takes all occlusion away.
fn store_gathered(pixel: vec2u, sum: Gathering, samples: u32, strength: f32) {
    let visibility = sum.open / f32(samples);
    let bend = pow(max(visibility, 1e-4), strength - 1.0);
    textureStore(gathered, pixel, vec4f(sum.light / f32(samples) * bend, visibility * bend));
}
