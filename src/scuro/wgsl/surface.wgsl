// The surface where a ray met a primitive: recomputed exactly from the primitive itself.

//#include "trace.wgsl"
//#include "octahedral.wgsl"

// For each slot: element id, linear color in three halves, octahedral normal (triangles)
@group(1) @binding(6) var attributes: texture_2d<u32>;

fn attribute_at(slot: u32) -> vec4u {
    return textureLoad(attributes, table_place(slot), 0);
}

struct Surface {
    t: f32,
    position: vec3f,
    normal: vec3f,
    // linear RGB
    color: vec3f,
    element: u32,
    instance: u32,
    object: u32,
}

fn attribute_color(packed: vec4u) -> vec3f {
    return vec3f(unpack2x16float(packed.y), unpack2x16float(packed.z).x);
}

// `hit` tells primitive, instance and cap; t is solved again in the instance's own frame.
fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let instance = placed(hit.instance, hit.frame);
    let inverse = conjugate(instance.rotation);
    let local = Ray(rotate(inverse, ray.origin - instance.center), rotate(inverse, ray.direction));
    let slot = slot_of(hit.primitive);
    let kind = kind_of(hit.primitive);
    let a = slot_at(slot);
    var t = hit.t;
    var normal: vec3f;
    var which = slot;
    var color: vec3f;
    if (HAS_TRIANGLES && kind == TRIANGLE) {
        // the plane, not the triangle: whoever found it may have rounded its edge differently
        let found = plane_hit(local, a.xyz, slot_at(slot + 1u).xyz, slot_at(slot + 2u).xyz);
        t = select(found.x, hit.t, hit.cap != 0u);
        let inside = max(vec3f(1.0 - found.y - found.z, found.y, found.z), vec3f(0.0));
        let weights = inside / (inside.x + inside.y + inside.z);
        normal = weights.x * octahedral_decode(attribute_at(slot).w)
            + weights.y * octahedral_decode(attribute_at(slot + 1u).w)
            + weights.z * octahedral_decode(attribute_at(slot + 2u).w);
        normal = normalize(normal);
        if (dot(normal, local.direction) > 0.0) {
            // a back face, or an interpolated normal that leans away at the silhouette
            let flat = cross(slot_at(slot + 1u).xyz - a.xyz, slot_at(slot + 2u).xyz - a.xyz);
            let facing = select(-flat, flat, dot(flat, local.direction) < 0.0);
            if (dot(normal, facing) < 0.0) {
                normal = -normal;
            }
        }
        color = weights.x * attribute_color(attribute_at(slot))
            + weights.y * attribute_color(attribute_at(slot + 1u))
            + weights.z * attribute_color(attribute_at(slot + 2u));
        which = slot + select(select(2u, 1u, weights.y >= weights.z), 0u,
            weights.x >= weights.y && weights.x >= weights.z);
    } else {
        if (hit.cap == 0u) {
            t = primitive_span(local, hit.primitive).near;
            if (t >= NOTHING) {
                t = hit.t; // a grazing ray that rounding calls a miss this time
            }
        }
        let point = local.origin + t * local.direction;
        if (HAS_RODS && kind != SPHERE) {
            let b = slot_at(slot + 1u);
            let axis = b.xyz - a.xyz;
            let h = dot(point - a.xyz, axis) / dot(axis, axis);
            which = slot + select(0u, 1u, h > 0.5);
            if (kind == ROD) {
                normal = (point - a.xyz - h * axis) / a.w;
                // a flat end, if the point lies better on it than on the side
                let off_side = a.w * abs(length(normal) - 1.0);
                if (min(abs(h), abs(h - 1.0)) * length(axis) < off_side) {
                    normal = select(-axis, axis, h > 0.5);
                }
            } else {
                normal = cone_normal(point, a.xyz, b.xyz, a.w, b.w);
            }
        } else {
            normal = (point - a.xyz) / a.w;
        }
        normal = normalize(normal);
        color = attribute_color(attribute_at(which));
    }
    var out: Surface;
    out.t = t;
    out.position = ray.origin + t * ray.direction;
    out.normal = rotate(instance.rotation, normal);
    if (CLIPPED && hit.cap != 0u) {
        out.normal = -scene.planes[hit.cap - 1u].xyz;
    }
    out.color = color;
    out.element = attribute_at(which).x;
    out.instance = leaf_number(hit.instance, hit.frame, instance.object);
    out.object = instance.object;
    return out;
}
