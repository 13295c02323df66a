// Ray-traced ambient occlusion: cosine-weighted rays through the tracer (Easdon 2013, 4.2).
//
// Pixels fall into interleaved classes, each with its own well spread directions, which a filter over
// a square of classes averages.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "fan_visibility.wgsl"
//#include "sampling.wgsl"

struct Rays {
    samples: u32,
    distance: f32,
    // which pixel of each 2 x 2 block stands for it, at half resolution
    offset: u32,
}

@group(2) @binding(0) var<uniform> rays: Rays;
@group(2) @binding(1) var surface: texture_2d<f32>;
// points of the unit sphere: `samples` for each class
@group(2) @binding(2) var directions: texture_2d<f32>;
@group(2) @binding(3) var result: texture_storage_2d<r32float, write>;

// Edge of the square of classes: 4, or 0 for a sequence of its own in each pixel.
override PATTERN: u32 = 4u;

fn direction_at(place: vec2u, index: u32) -> vec3f {
    if (PATTERN == 0u) {
        // further frames go on in the same sequence
        let start = hash(place.x + hash(place.y + hash(view.seed)));
        let first = view.frame * rays.samples;
        return sphere_direction(r2_point(first + index, vec2u(start, hash(start))));
    }
    let class_index = place.x % PATTERN + PATTERN * (place.y % PATTERN);
    return textureLoad(directions, table_place(class_index * rays.samples + index), 0).xyz;
}

// The sample of the picture at hand: a pixel, or a block at half resolution.
var<private> place_at_hand: vec2u;

fn fan_direction(fan: Fan, index: u32) -> vec3f {
    return cosine_direction(fan.normal, direction_at(place_at_hand, index));
}

fn visibility_at(pixel: vec2u, place: vec2u) -> f32 {
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        return 1.0;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let fan = fan_at(position + texel.xyz * surface_offset(position, texel.w), texel.xyz);
    place_at_hand = place;
    return fan_visibility(fan, rays.samples, rays.distance);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, in_blocks(local));
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    textureStore(result, pixel, vec4f(visibility_at(pixel, pixel + vec2u(view.origin))));
}

@compute @workgroup_size(4, 4)
fn half(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let place = tile_pixel(group, vec3u(0u)) / 2u + local.xy;
    if (any(place >= textureDimensions(result))) {
        return;
    }
    let pixel = min(place * 2u + vec2u(rays.offset & 1u, rays.offset >> 1u),
        textureDimensions(surface) - 1u);
    textureStore(result, place, vec4f(visibility_at(pixel, place + vec2u(view.origin) / 2u)));
}
