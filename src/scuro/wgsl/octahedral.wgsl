// Unit vectors on the octahedron (Cigolle et al. 2014): 16 bits a coordinate.

fn octahedral_wrap(v: vec2f) -> vec2f {
    return (1.0 - abs(v.yx)) * select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

// Unit vector to the square [-1, 1]^2.
fn octahedral_square(n: vec3f) -> vec2f {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return select(octahedral_wrap(p), p, n.z >= 0.0);
}

// The square [-1, 1]^2 to a unit vector.
fn octahedral_direction(p: vec2f) -> vec3f {
    let z = 1.0 - abs(p.x) - abs(p.y);
    return normalize(vec3f(select(octahedral_wrap(p), p, z >= 0.0), z));
}

fn octahedral_encode(n: vec3f) -> u32 {
    return pack2x16snorm(octahedral_square(n));
}

fn octahedral_decode(packed: u32) -> vec3f {
    return octahedral_direction(unpack2x16snorm(packed));
}
