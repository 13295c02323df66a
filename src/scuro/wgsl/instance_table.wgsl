// How the rows of the instance table are read: see trace/instances.py.

//#include "scene_types.wgsl"

// Whether an instance is kept in one texel or in two.
override PACKED: bool = false;

// Where an instance's bounding sphere lies, and its tag.
struct Standing {
    center: vec3f,
    tag: u32,
}

// The first texel of an instance.
fn place_index(instance: u32) -> u32 {
    return select(2u * instance, instance, PACKED);
}

// The texel that holds its rotation.
fn turn_index(instance: u32) -> u32 {
    return select(2u * instance + 1u, instance, PACKED);
}

fn place_of(texel: vec4u, step: f32) -> Standing {
    if (!PACKED) {
        return Standing(bitcast<vec3f>(texel.xyz), texel.w);
    }
    let words = vec3u(texel.x, (texel.x >> 20u) | (texel.y << 12u), texel.y >> 8u);
    return Standing(step * vec3f(bitcast<vec3i>(words << vec3u(12u)) >> vec3u(12u)), texel.z & 0x7fffu);
}

fn object_of(tag: u32, object_bits: u32) -> u32 {
    return tag & ((1u << object_bits) - 1u);
}

// The bounding radius in a tag.
fn radius_of(tag: u32, object_bits: u32, base: u32, shift: u32) -> f32 {
    let code = tag >> object_bits;
    return select(bitcast<f32>(base + ((code - 1u) << shift)), 0.0, code == 0u);
}

// A unit quaternion; of packed ones three components and the number of the fourth, the largest.
fn turn_of(texel: vec4u) -> vec4f {
    if (!PACKED) {
        return bitcast<vec4f>(texel);
    }
    let third = (texel.w >> 17u) | (texel.y >> 30u << 15u);
    let words = vec3u(texel.z >> 15u, texel.w, third) << vec3u(15u);
    let v = vec3f(bitcast<vec3i>(words) >> vec3u(15u)) * (0.70710678118 / 65535.0);
    let largest = sqrt(max(0.0, 1.0 - dot(v, v)));
    let which = (texel.y >> 28u) & 3u;
    return select(
        select(vec4f(v, largest), vec4f(v.xy, largest, v.z), which == 2u),
        select(vec4f(v.x, largest, v.yz), vec4f(largest, v), which == 0u),
        which < 2u,
    );
}

fn conjugate(q: vec4f) -> vec4f {
    return vec4f(-q.xyz, q.w);
}

fn rotate(q: vec4f, v: vec3f) -> vec3f {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}
