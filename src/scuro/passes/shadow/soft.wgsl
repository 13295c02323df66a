// Soft shadows by one ray a pixel (Easdon 2013, 5.5).

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace_soft.wgsl"
//#include "trace_transmittance.wgsl"
//#include "light_samples.wgsl"

struct Soft {
    light: u32,
    // tangent of the angular radius of lights without a size
    spread: f32,
    // half of the penumbra's width at most, in scene units
    most: f32,
    // of outer to inner radius, if PARKER
    ratio: f32,
}

@group(2) @binding(0) var<uniform> soft: Soft;
@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var surface: texture_2d<f32>;
@group(2) @binding(3) var result: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, in_blocks(local));
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let light = lights.list[soft.light];
    let arriving = incoming_light(light, position);
    let reached = texel.w > 0.0 && dot(texel.xyz, arriving.direction) > 0.0
        && any(arriving.color > vec3f(0.0));
    let origin = position + texel.xyz * surface_offset(position, texel.w);
    let end = select(-1.0, arriving.distance, reached);
    let penumbra = Penumbra(light_spread(light, arriving.distance, soft.spread), soft.most, soft.ratio);
    let ray = Ray(origin, arriving.direction);
    // penumbras are those of opaque solids; transparent ones dim with a hard edge
    ray_part = OPAQUE_PART;
    let lit = trace_soft(ray, end, penumbra) * trace_films(ray, 0.0, end);
    textureStore(result, pixel, vec4f(lit));
}
