// What is left of light along a ray through transparent objects: the product of what each leaves.

//#include "trace.wgsl"

// Objects that a ray is dimmed by at most.
const MOST_FILMS: u32 = 8u;

fn trace_transmittance(ray: Ray, t_min: f32, t_max: f32) -> f32 {
    if (!HAS_OPACITY) {
        return select(1.0, 0.0, trace_any(ray, t_min, t_max));
    }
    ray_part = OPAQUE_PART;
    var left = select(1.0, 0.0, trace_any(ray, t_min, t_max));
    left *= trace_films(ray, t_min, select(t_max, -1.0, left == 0.0));
    ray_part = ANY_PART;
    return left;
}

// The same of transparent objects alone.
fn trace_films(ray: Ray, t_min: f32, t_max: f32) -> f32 {
    if (!HAS_OPACITY) {
        return 1.0;
    }
    ray_part = TRANSPARENT_PART;
    ray_passed = NO_PRIMITIVE;
    var left = 1.0;
    var from_t = t_min;
    for (var i = 0u; i < MOST_FILMS && t_max > from_t; i += 1u) {
        let hit = trace_nearest(ray, from_t, t_max);
        if (hit.primitive == NO_PRIMITIVE) {
            break;
        }
        left *= 1.0 - opacity_of(traced_object(instance_at(hit.instance).object).flags);
        ray_passed = hit_number(hit);
        from_t = hit.t;
    }
    ray_passed = NO_PRIMITIVE;
    ray_part = ANY_PART;
    return left;
}
