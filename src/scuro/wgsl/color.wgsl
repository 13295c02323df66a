// sRGB transfer function (IEC 61966-2-1).

fn linear_from_srgb(c: vec3f) -> vec3f {
    return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}

fn srgb_from_linear(c: vec3f) -> vec3f {
    let positive = max(c, vec3f(0.0));
    return select(1.055 * pow(positive, vec3f(1.0 / 2.4)) - 0.055, positive * 12.92,
        positive <= vec3f(0.0031308));
}

// Relative luminance of linear RGB (Rec. 709).
fn luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}
