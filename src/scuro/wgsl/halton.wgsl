// Directions on the hemisphere as in Koch 2018: Halton points, shifted by a per-pixel noise
// (Cranley-Patterson), mapped by Malley's method.

//#include "sampling.wgsl"
//#include "scene_types.wgsl"

// Three uniform numbers for a pixel.
fn pixel_noise(pixel: vec2u, seed: u32) -> vec3f {
    let x = hash(pixel.x + hash(pixel.y + hash(seed)));
    let y = hash(x);
    return vec3f(unit_float(x), unit_float(y), unit_float(hash(y)));
}

// Cosine-weighted direction about z (equation 3.4).
fn malley(u: vec2f) -> vec3f {
    let radius = sqrt(u.x);
    let turn = 2.0 * PI * u.y;
    return vec3f(radius * cos(turn), radius * sin(turn), sqrt(max(1.0 - u.x, 0.0)));
}

// Points of this frame (passes/semantic/pipeline.py); the third coordinate is for the step's length.
@group(3) @binding(2) var halton_points: texture_2d<f32>;

fn halton(index: u32) -> vec3f {
    return textureLoad(halton_points, table_place(index), 0).xyz;
}
