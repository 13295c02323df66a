// Ray-traced shadows: rays from each surface point to a light's middle (hard) or to points of its
// disc (area). A ray to a point light ends there; where no light arrives, no ray is traced.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace_transmittance.wgsl"
//#include "lights.wgsl"
//#include "sampling.wgsl"
//#include "light_samples.wgsl"

struct Rays {
    light: u32,
    samples: u32,
    // tangent of the angular radius of lights without a size
    spread: f32,
    // edge of the square of interleaved classes; 0 for a sequence of its own in each pixel
    pattern: u32,
}

@group(2) @binding(0) var<uniform> rays: Rays;
@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var surface: texture_2d<f32>;
@group(2) @binding(3) var result: texture_storage_2d<r32float, write>;

// Whether lights have a size.
override AREA: bool = false;

// Point `index` of the pixel's own sequence in the unit square.
fn square_point(pixel: vec2u, index: u32) -> vec2f {
    let place = pixel + vec2u(view.origin);
    let first = view.frame * rays.samples + index;
    let seed = hash(view.seed + rays.light);
    if (rays.pattern == 0u) {
        let start = hash(place.x + hash(place.y + seed));
        return r2_point(first, vec2u(start, hash(start)));
    }
    // the classes share one sequence, which is what the filter averages
    let corner = place % rays.pattern;
    let count = rays.pattern * rays.pattern;
    return r2_point(first * count + corner.x + rays.pattern * corner.y, vec2u(seed, hash(seed)));
}

// Where no ray is traced: 1, or -1 for the filter.
fn lit_at(pixel: vec2u) -> f32 {
    let texel = textureLoad(surface, pixel, 0);
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let light = lights.list[rays.light];
    let arriving = incoming_light(light, position);
    let reached = texel.w > 0.0 && dot(texel.xyz, arriving.direction) > 0.0
        && any(arriving.color > vec3f(0.0));
    let origin = position + texel.xyz * surface_offset(position, texel.w);
    // an empty interval costs no step through the grid: cheaper than a branch that all lanes take
    let end = select(-1.0, arriving.distance, reached);
    if (!AREA) {
        return trace_transmittance(Ray(origin, arriving.direction), 0.0, end);
    }
    var lit = 0.0;
    let unknown = select(1.0, -1.0, rays.pattern != 0u);
    for (var i = 0u; i < rays.samples; i += 1u) {
        let direction = light_direction(light, arriving, rays.spread, square_point(pixel, i));
        lit += trace_transmittance(Ray(origin, direction), 0.0, end);
    }
    // what the light does not reach must not brighten its neighbours when they are smoothed
    return select(unknown, lit / f32(rays.samples), reached);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, in_blocks(local));
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    textureStore(result, pixel, vec4f(lit_at(pixel)));
}
