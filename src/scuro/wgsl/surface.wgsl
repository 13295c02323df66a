// The surface where a ray met a primitive: recomputed exactly from the primitive itself.

//#include "trace.wgsl"
//#include "octahedral.wgsl"
//#include "color.wgsl"

// For each slot: element id, sRGB color, octahedral normal (triangles), unused
@group(1) @binding(6) var<storage, read> attributes: array<vec4u>;

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

fn unpack_color(packed: u32) -> vec3f {
    return linear_from_srgb(unpack4x8unorm(packed).rgb);
}

// `hit` tells primitive, instance and cap; t is solved again in the instance's own frame.
fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let instance = instances[hit.instance];
    let inverse = conjugate(instance.rotation);
    let local = Ray(rotate(inverse, ray.origin - instance.center), rotate(inverse, ray.direction));
    let slot = slot_of(hit.primitive);
    let kind = kind_of(hit.primitive);
    let a = slots[slot];
    var t = hit.t;
    var normal: vec3f;
    var which = slot;
    var color: vec3f;
    if (HAS_TRIANGLES && kind == TRIANGLE) {
        let found = triangle_hit(local, a.xyz, slots[slot + 1u].xyz, slots[slot + 2u].xyz);
        if (found.x < NOTHING) {
            t = found.x;
        }
        let weights = vec3f(1.0 - found.y - found.z, found.y, found.z);
        normal = weights.x * octahedral_decode(attributes[slot].z)
            + weights.y * octahedral_decode(attributes[slot + 1u].z)
            + weights.z * octahedral_decode(attributes[slot + 2u].z);
        normal = normalize(normal);
        if (dot(normal, local.direction) > 0.0) {
            // a back face, or an interpolated normal that leans away at the silhouette
            let flat = cross(slots[slot + 1u].xyz - a.xyz, slots[slot + 2u].xyz - a.xyz);
            let facing = select(-flat, flat, dot(flat, local.direction) < 0.0);
            if (dot(normal, facing) < 0.0) {
                normal = -normal;
            }
        }
        color = weights.x * unpack_color(attributes[slot].y)
            + weights.y * unpack_color(attributes[slot + 1u].y)
            + weights.z * unpack_color(attributes[slot + 2u].y);
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
            let b = slots[slot + 1u];
            let axis = b.xyz - a.xyz;
            let h = dot(point - a.xyz, axis) / dot(axis, axis);
            which = slot + select(0u, 1u, h > 0.5);
            if (kind == ROD) {
                normal = (point - a.xyz - h * axis) / a.w;
            } else {
                normal = cone_normal(point, a.xyz, b.xyz, a.w, b.w);
            }
        } else {
            normal = (point - a.xyz) / a.w;
        }
        normal = normalize(normal);
        color = unpack_color(attributes[which].y);
    }
    var out: Surface;
    out.t = t;
    out.position = ray.origin + t * ray.direction;
    out.normal = rotate(instance.rotation, normal);
    if (CLIPPED && hit.cap != 0u) {
        out.normal = -scene.planes[hit.cap - 1u].xyz;
    }
    out.color = color;
    out.element = attributes[which].x;
    out.instance = hit.instance;
    out.object = instance.object;
    return out;
}
