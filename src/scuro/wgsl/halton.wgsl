// Directions on the hemisphere as in Koch 2018: Halton points, shifted by a per-pixel noise
// (Cranley-Patterson), mapped by Malley's method.

//#include "sampling.wgsl"

// Radical inverse of n in base b (equation 2.5).
fn radical_inverse(base: u32, n: u32) -> f32 {
    let inverse = 1.0 / f32(base);
    var digit = inverse;
    var rest = n;
    var sum = 0.0;
    while (rest > 0u) {
        sum += f32(rest % base) * digit;
        rest /= base;
        digit *= inverse;
    }
    return sum;
}

// The n-th Halton point; the third coordinate is for the length of the step.
fn halton(n: u32) -> vec3f {
    return vec3f(radical_inverse(2u, n), radical_inverse(3u, n), radical_inverse(5u, n));
}

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
