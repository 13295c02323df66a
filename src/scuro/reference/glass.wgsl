// Glass: smooth and clear. Solids of glass that overlap are one piece: a path that has entered one
// leaves where it leaves the last of them.

//#include "surface.wgsl"
//#include "materials.wgsl"

// Whether any material is glass.
override HAS_GLASS: bool = false;

// The solid a path is in; no primitive outside of all.
struct Inside {
    primitive: u32,
    instance: u32,
    frame: u32,
    ior: f32,
}

const OUTSIDE = Inside(NO_PRIMITIVE, 0u, NO_FRAME, 1.0);
// Overlapping solids that a path may cross without a bend.
const MOST_SOLIDS: u32 = 16u;

struct Passage {
    ray: Ray,
    inside: Inside,
    weight: vec3f,
    // whether the ray goes on to something opaque within the glass
    opaque: bool,
}

fn enter_glass(ray: Ray, hit: Hit, at: Surface, material: Material, choice: f32) -> Passage {
    let offset = at.normal * surface_offset(at.position, at.t);
    let cosine = -dot(ray.direction, at.normal);
    if (choice < dielectric(cosine, material.ior)) {
        let up = Ray(at.position + offset, reflect(ray.direction, at.normal));
        return Passage(up, OUTSIDE, vec3f(1.0), false);
    }
    let down = refract(ray.direction, at.normal, 1.0 / material.ior);
    let within = Inside(hit.primitive, hit.instance, hit.frame, material.ior);
    return Passage(Ray(at.position - offset, down), within, vec3f(1.0), false);
}

// Where a ray from within a primitive leaves it.
fn exit_distance(ray: Ray, primitive: u32, index: u32, frame: u32) -> f32 {
    let instance = placed(index, frame);
    let inverse = conjugate(instance.rotation);
    let local = Ray(rotate(inverse, ray.origin - instance.center), rotate(inverse, ray.direction));
    return max(primitive_span(local, primitive).far, 0.0);
}

fn leave_glass(ray: Ray, inside: Inside, choice: f32) -> Passage {
    var last = inside;
    var end = exit_distance(ray, inside.primitive, inside.instance, inside.frame);
    // the start lies in one solid only: all others on the way are entered
    var from_t = 0.0;
    for (var i = 0u; i < MOST_SOLIDS; i += 1u) {
        let hit = trace_nearest(ray, from_t, end);
        if (hit.primitive == NO_PRIMITIVE) {
            break;
        }
        let instance = instance_at(hit.instance);
        if (material_at(instance.object).kind != GLASS) {
            return Passage(ray, OUTSIDE, vec3f(1.0), true);
        }
        let beyond = exit_distance(ray, hit.primitive, hit.instance, hit.frame);
        if (beyond > end) {
            end = beyond;
            last = Inside(hit.primitive, hit.instance, hit.frame, inside.ior);
        }
        from_t = hit.t + 1e-5 * scene.primitive_radius;
    }
    // seen from outside, the exit is an entry
    let back = Ray(ray.origin + (end + scene.primitive_radius) * ray.direction, -ray.direction);
    let exit = Hit(scene.primitive_radius, last.primitive, last.instance, 0u, 2.0, last.frame);
    let at = surface_at(back, exit);
    let offset = at.normal * surface_offset(at.position, at.t);
    let cosine = dot(ray.direction, at.normal);
    if (choice < dielectric(cosine, 1.0 / inside.ior)) {
        let on = Ray(at.position - offset, reflect(ray.direction, at.normal));
        return Passage(on, last, vec3f(1.0), false);
    }
    let out = refract(ray.direction, -at.normal, inside.ior);
    return Passage(Ray(at.position + offset, out), OUTSIDE, vec3f(1.0), false);
}
