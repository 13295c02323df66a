// The same semantics in object space: rays count a hit only if it lies in another region, so that
// nothing depends on what the picture shows. Occlusion with light from the open directions, and
// shadows of the key light.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace.wgsl"
//#include "surface.wgsl"
//#include "lights.wgsl"
//#include "region.wgsl"
//#include "halton.wgsl"

struct Rays {
    samples: u32,
    near_radius: f32,
    far_radius: f32,
    strength: f32,
    shadow: f32,
}

@group(2) @binding(0) var<uniform> rays: Rays;
@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var surface: texture_2d<f32>;
@group(2) @binding(3) var ids: texture_2d<u32>;
// as in ssdo.wgsl and shadow.wgsl
@group(2) @binding(4) var gathered: texture_storage_2d<rgba16float, write>;
@group(2) @binding(5) var lit: texture_storage_2d<rgba16float, write>;

// As in ssdo.wgsl.
const FACING: f32 = 1.5;
// A ray inside one instance passes at most so many atoms of its own group.
const MOST_OWN: u32 = 32u;

// Whether something of another region lies on the ray.
fn blocked(ray: Ray, reach: f32, level: LevelOf, own: vec4u) -> bool {
    skipped = vec4u(0u);
    if (level.kind == BY_OBJECT) {
        let range = region_range(level, own.z);
        skipped = vec4u(range, 0u, 0u);
    } else if (level.kind == BY_INSTANCE) {
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
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(surface);
    if (any(pixel >= size)) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        textureStore(gathered, pixel, vec4f(0.0));
        textureStore(lit, pixel, vec4f(1.0));
        return;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let origin = position + texel.xyz * surface_offset(position, texel.w);
    let own = textureLoad(ids, pixel, 0);
    let noise = pixel_noise(pixel + vec2u(view.origin), view.seed);
    let basis = tangent_frame(texel.xyz);
    let near_weight = 1.0 - levels.depth;
    var light = vec3f(0.0);
    var open_sum = 0.0;
    for (var i = 0u; i < rays.samples; i += 1u) {
        let u = fract(halton(i) + noise);
        let ray = Ray(origin, basis * malley(u.xy));
        var open = 1.0;
        if (near_weight > 0.0) {
            skipped = vec4u(0u);
            open -= near_weight * select(0.0, 1.0, trace_any(ray, 0.0, rays.near_radius));
        }
        // each ray belongs to level t or t + 1, by chance as near as the camera is to either:
        // their mean is the interpolation of both levels' results
        if (u.z < levels.blend) {
            open *= select(1.0, 0.0, blocked(ray, rays.far_radius, levels.next, own));
        } else {
            open *= select(1.0, 0.0, blocked(ray, rays.far_radius, levels.here, own));
        }
        open_sum += open;
        for (var k = 0u; k < lights.count; k += 1u) {
            let arriving = incoming_light(lights.list[k], position);
            light += open * FACING * max(dot(ray.direction, arriving.direction), 0.0)
                * arriving.color;
        }
        light += open * lights.ambient;
    }
    let count = f32(rays.samples);
    let visibility = open_sum / count;
    let bend = pow(max(visibility, 1e-4), rays.strength - 1.0);
    textureStore(gathered, pixel, vec4f(light / count * bend, visibility * bend));

    var dark = 0.0;
    if (rays.shadow > 0.0 && lights.count > 0u) {
        let arriving = incoming_light(lights.list[0], position);
        let ray = Ray(origin, arriving.direction);
        if (levels.blend < 1.0) {
            dark += (1.0 - levels.blend)
                * select(0.0, 1.0, blocked(ray, arriving.distance, levels.here, own));
        }
        if (levels.blend > 0.0) {
            dark += levels.blend
                * select(0.0, 1.0, blocked(ray, arriving.distance, levels.next, own));
        }
    }
    textureStore(lit, pixel, vec4f(1.0 - rays.shadow * dark));
}
