// The same semantics in object space: rays count a hit only if it lies in another region, so that
// nothing depends on what the picture shows. Occlusion with light from the open directions.

//#include "seen.wgsl"
//#include "blocked.wgsl"
//#include "gather.wgsl"

struct Rays {
    samples: u32,
    near_radius: f32,
    far_radius: f32,
    strength: f32,
    // how much the near reach counts: less with distance
    near_weight: f32,
}

@group(2) @binding(1) var<uniform> rays: Rays;
@group(2) @binding(4) var ids: texture_2d<u32>;

override HAS_NEAR: bool = true;

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
}
