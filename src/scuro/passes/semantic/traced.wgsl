// The same semantics in object space: rays count a hit only if it lies in another region, so that
// nothing depends on what the picture shows. Occlusion with light from the open directions, and
// shadows of the key light.

//#include "seen.wgsl"
//#include "trace.wgsl"
//#include "surface.wgsl"
//#include "region.wgsl"
//#include "gather.wgsl"

struct Rays {
    samples: u32,
    near_radius: f32,
    far_radius: f32,
    strength: f32,
    // how much the near reach counts: less with distance
    near_weight: f32,
    // how dark a full shadow is
    shadow: f32,
}

@group(2) @binding(1) var<uniform> rays: Rays;
@group(2) @binding(4) var ids: texture_2d<u32>;
// as in shadow.wgsl
@group(2) @binding(5) var lit: texture_storage_2d<r32float, write>;

override HAS_NEAR: bool = true;
override HAS_SHADOW: bool = true;
// Whether either level divides instances into groups of atoms.
override HAS_GROUPS: bool = true;

// A ray inside one instance passes at most so many atoms of its own group.
const MOST_OWN: u32 = 32u;

// Whether something of another region lies on the ray.
fn blocked(ray: Ray, reach: f32, level: LevelOf, own: vec4u) -> bool {
    skipped = vec4u(0u);
    if (level.kind == BY_OBJECT) {
        let range = region_range(level, own.z);
        skipped = vec4u(range, 0u, 0u);
    } else if (!HAS_GROUPS || level.kind == BY_INSTANCE) {
        skipped = vec4u(0u, 0u, own.y, own.y + 1u);
    } else {
        // groups of atoms: step through those of the own group
        let label = region_of(level, own.z, own.y, own.x);
        var t = 0.0;
        for (var i = 0u; i < MOST_OWN; i += 1u) {
            let hit = trace_nearest(ray, t, reach);
            if (hit.primitive == NO_PRIMITIVE) {
                return false;
            }
            let found = surface_at(ray, hit);
            if (region_of(level, found.object, found.instance, found.element) != label) {
                return true;
            }
            t = hit.t + 0.01 * scene.primitive_radius;
        }
        return false;
    }
    return trace_any(ray, 0.0, reach);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let position = seen_position(here);
    let origin = position + here.normal * surface_offset(position, here.depth);
    let own = textureLoad(ids, here.pixel, 0);
    let noise = pixel_noise(here.pixel + vec2u(view.origin), view.seed);
    let basis = tangent_frame(here.normal);
    var sum = Gathering(vec3f(0.0), 0.0);
    for (var i = 0u; i < rays.samples; i += 1u) {
        let u = fract(halton(i) + noise);
        let ray = Ray(origin, basis * malley(u.xy));
        var open = 1.0;
        if (HAS_NEAR) {
            skipped = vec4u(0u);
            open -= rays.near_weight * select(0.0, 1.0, trace_any(ray, 0.0, rays.near_radius));
        }
        // each ray belongs to level t or t + 1, by chance as near as the camera is to either:
        // their mean is the interpolation of both levels' results
        var level = levels.here;
        if (u.z < levels.blend) {
            level = levels.next;
        }
        open *= select(1.0, 0.0, blocked(ray, rays.far_radius, level, own));
        gather(&sum, ray.direction, open, position);
    }
    store_gathered(here.pixel, sum, rays.samples, rays.strength);
    if (!HAS_SHADOW || lights.count == 0u) {
        return;
    }
    let arriving = incoming_light(lights.list[0], position);
    let ray = Ray(origin, arriving.direction);
    var dark = 0.0;
    // a loop, so that the tracer is compiled into it once
    let first = select(0u, 1u, levels.blend >= 1.0);
    let end = select(1u, 2u, levels.blend > 0.0);
    for (var k = first; k < end; k += 1u) {
        var level = levels.here;
        if (k == 1u) {
            level = levels.next;
        }
        let share = select(1.0 - levels.blend, levels.blend, k == 1u);
        dark += share * select(0.0, 1.0, blocked(ray, arriving.distance, level, own));
    }
    textureStore(lit, here.pixel, vec4f(1.0 - rays.shadow * dark));
}
