// Sampling of directions and points. Sequences are deterministic in pixel, sample and seed.

const PI: f32 = 3.14159265358979;

// Integer hash with good avalanche (PCG, Jarzynski & Olano 2020).
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// In [0, 1), from the upper 24 bits.
fn unit_float(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

// The R2 sequence (Roberts 2018), shifted: additive recurrence in integers, exact for any index.
fn r2_point(index: u32, shift: vec2u) -> vec2f {
    let p = vec2u(3242174889u, 2447445414u) * index + shift;
    return vec2f(unit_float(p.x), unit_float(p.y));
}

// Uniform on the unit sphere.
fn sphere_direction(u: vec2f) -> vec3f {
    let z = 1.0 - 2.0 * u.x;
    let ring = sqrt(max(0.0, 1.0 - z * z));
    let angle = 2.0 * PI * u.y;
    return vec3f(ring * cos(angle), ring * sin(angle), z);
}

// Cosine-weighted about a normal: the normal plus a point of the unit sphere around its tip. One
// `around` shared by neighbouring pixels gives them nearly parallel rays.
fn cosine_direction(normal: vec3f, around: vec3f) -> vec3f {
    let sum = normal + around;
    let length2 = dot(sum, sum);
    return select(normal, sum * inverseSqrt(length2), length2 > 1e-8);
}

// Two unit vectors that make a right-handed frame with n (Duff et al. 2017).
fn tangent_frame(n: vec3f) -> mat3x3f {
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    return mat3x3f(
        vec3f(1.0 + s * n.x * n.x * a, s * b, -s * n.x),
        vec3f(b, s + n.y * n.y * a, -n.y),
        n,
    );
}
