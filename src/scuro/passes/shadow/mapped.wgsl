// Shadow maps (Williams 1978) with percentage-closer filtering (Reeves et al. 1987). The map is cast
// by rays: orthographic for directional lights, octahedral around all others.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace_transmittance.wgsl"
//#include "lights.wgsl"
//#include "octahedral.wgsl"
//#include "sampling.wgsl"

struct Mapped {
    light: u32,
    // texels along an edge of the map
    size: u32,
    // what counts as the same surface, in texels
    bias: f32,
    // texels around the nearest one that are compared
    taps: i32,
}

@group(2) @binding(0) var<uniform> mapped: Mapped;
@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var depths_out: texture_storage_2d<r32float, write>;
@group(2) @binding(3) var depths: texture_2d<f32>;
@group(2) @binding(4) var surface: texture_2d<f32>;
@group(2) @binding(5) var result: texture_storage_2d<r32float, write>;

// The map's ray through a point of the square [-1, 1]^2.
fn map_ray(light: Light, at: vec2f) -> Ray {
    if (light.kind != DIRECTIONAL) {
        return Ray(light.position, octahedral_direction(at));
    }
    let frame = tangent_frame(-light.direction);
    return Ray(frame * (vec3f(at, 1.0) * scene.extent), light.direction);
}

// Place in the square and distance along the map's ray of a point of the scene.
fn map_place(light: Light, position: vec3f) -> vec3f {
    if (light.kind != DIRECTIONAL) {
        let from_light = position - light.position;
        let range = length(from_light);
        return vec3f(octahedral_square(from_light / max(range, 1e-12)), range);
    }
    let p = transpose(tangent_frame(-light.direction)) * position / scene.extent;
    return vec3f(p.xy, (1.0 - p.z) * scene.extent);
}

@compute @workgroup_size(8, 8)
fn fill_map(@builtin(global_invocation_id) id: vec3u) {
    let at = (vec2f(id.xy) + 0.5) / f32(mapped.size) * 2.0 - 1.0;
    ray_part = OPAQUE_PART;
    let hit = trace_nearest(map_ray(lights.list[mapped.light], at), 0.0, NOTHING);
    if (all(id.xy < vec2u(mapped.size))) {
        textureStore(depths_out, id.xy, vec4f(hit.t));
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let light = lights.list[mapped.light];
    let arriving = incoming_light(light, position);
    let facing = dot(texel.xyz, arriving.direction);
    if (texel.w <= 0.0 || facing <= 0.0) {
        textureStore(result, pixel, vec4f(1.0));
        return;
    }
    let size = f32(mapped.size);
    // an octahedral texel spans at most 4 / size of the distance, others 2 / size of the extent
    let range = select(2.0 * distance(light.position, position), scene.extent,
        light.kind == DIRECTIONAL);
    let bias = mapped.bias * 2.0 / size * range;
    // a tilted surface's texels differ in depth: compare above it, by as far as the kernel reaches
    let sine = sqrt(max(0.0, 1.0 - facing * facing));
    let above = position + texel.xyz * (bias * (f32(mapped.taps) + 1.5) * sine);
    let place = map_place(light, above);
    let at = (place.xy * 0.5 + 0.5) * size - 0.5;
    let base = vec2i(floor(at));
    let part = at - floor(at);
    var lit = 0.0;
    var total = 0.0;
    for (var y = -mapped.taps; y <= mapped.taps + 1; y += 1) {
        for (var x = -mapped.taps; x <= mapped.taps + 1; x += 1) {
            let cell = clamp(base + vec2i(x, y), vec2i(0), vec2i(i32(mapped.size) - 1));
            // the outermost taps count by how far the kernel reaches into them
            let reach = vec2f(f32(mapped.taps) + 1.0) - abs(vec2f(f32(x), f32(y)) - part);
            let w = saturate(reach.x) * saturate(reach.y);
            lit += w * select(0.0, 1.0, textureLoad(depths, cell, 0).x >= place.z - bias);
            total += w;
        }
    }
    // a map has one depth: what transparent objects leave of the light is found by rays
    let origin = position + texel.xyz * surface_offset(position, texel.w);
    let films = trace_films(Ray(origin, arriving.direction), 0.0, arriving.distance);
    textureStore(result, pixel, vec4f(films * lit / total));
}
