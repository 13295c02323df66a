// What a cell lists, and where a ray meets it.

//#include "ray.wgsl"
//#include "scene.wgsl"

// A primitive as a cell lists it: spheres are copied whole, so that testing one is a single fetch.
struct Entry {
    sphere: vec4f,
    // of other primitives; NO_PRIMITIVE for a sphere
    primitive: u32,
    last: bool,
}

fn entry_of(texel: vec4u) -> Entry {
    if ((HAS_RODS || HAS_TRIANGLES) && texel.w == 0u) {
        return Entry(vec4f(0.0), texel.x, texel.y != 0u);
    }
    return Entry(bitcast<vec4f>(vec4u(texel.xyz, texel.w & 0x7fffffffu)), NO_PRIMITIVE, texel.w >= 0x80000000u);
}

// Entry and exit of one primitive.
fn primitive_span(ray: Ray, primitive: u32) -> Span {
    let slot = slot_of(primitive);
    let a = slot_at(slot);
    let kind = kind_of(primitive);
    if (HAS_RODS && kind == ROD) {
        let b = slot_at(slot + 1u);
        return cylinder_span(ray, a.xyz, b.xyz, a.w);
    }
    if (HAS_RODS && kind == CONE) {
        let b = slot_at(slot + 1u);
        return cone_span(ray, a.xyz, b.xyz, a.w, b.w);
    }
    if (HAS_TRIANGLES && kind == TRIANGLE) {
        let t = triangle_hit(ray, a.xyz, slot_at(slot + 1u).xyz, slot_at(slot + 2u).xyz).x;
        return Span(t, t);
    }
    return sphere_span(ray, a.xyz, a.w);
}

fn entry_span(ray: Ray, entry: Entry) -> Span {
    var span = sphere_span(ray, entry.sphere.xyz, entry.sphere.w);
    if ((HAS_RODS || HAS_TRIANGLES) && entry.primitive != NO_PRIMITIVE) {
        span = primitive_span(ray, entry.primitive);
    }
    return span;
}

// How deep p lies in a solid: 0 on its axis or center, 1 on its surface.
fn entry_depth(p: vec3f, entry: Entry) -> f32 {
    var center = entry.sphere;
    if (HAS_RODS && entry.primitive != NO_PRIMITIVE) {
        let slot = slot_of(entry.primitive);
        let a = slot_at(slot);
        let b = slot_at(slot + 1u);
        let axis = b.xyz - a.xyz;
        let h = saturate(dot(p - a.xyz, axis) / dot(axis, axis));
        center = mix(a, b, h);
    }
    return distance(p, center.xyz) / center.w;
}
