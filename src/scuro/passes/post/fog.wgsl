// Depth cueing: a linear ramp between two depths, as in print.

struct Fog {
    // linear, premultiplied
    color: vec4f,
    start: f32,
    // one over the length of the ramp
    density: f32,
    strength: f32,
}

@group(2) @binding(5) var<uniform> fog: Fog;

fn fog_amount(depth: f32) -> f32 {
    return fog.strength * saturate((depth - fog.start) * fog.density) * f32(depth > 0.0);
}
