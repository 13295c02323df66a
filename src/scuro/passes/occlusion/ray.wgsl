// Ray-traced ambient occlusion: cosine-weighted rays through the tracer (Easdon 2013, 4.2).
//
// Pixels fall into CLASSES interleaved classes, each with its own well spread directions; rays of
// one class are nearly parallel and lie in neighbouring lanes, so that they walk the same cells.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "trace_stream.wgsl"
//#include "sampling.wgsl"

struct Rays {
    samples: u32,
    distance: f32,
    strength: f32,
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
        let start = hash(place.x + hash(place.y + hash(view.seed + view.frame)));
        return sphere_direction(r2_point(index, vec2u(start, hash(start))));
    }
    let class_index = place.x % PATTERN + PATTERN * (place.y % PATTERN);
    return textureLoad(directions, table_place(class_index * rays.samples + index), 0).xyz;
}

// `place` counts the samples of the picture: pixels, or blocks at half resolution.
fn visibility_at(pixel: vec2u, place: vec2u) -> f32 {
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        return 1.0;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let origin = position + texel.xyz * surface_offset(position, texel.w);
    var open = 0.0;
    var sample = 0u;
    var direction = cosine_direction(texel.xyz, direction_at(place, sample));
    var query = any_begin(Ray(origin, direction), 0.0, rays.distance);
    loop {
        any_go_on(&query);
        if (query.ended) {
            open += select(1.0, 0.0, query.found);
            sample += 1u;
            if (sample >= rays.samples) {
                break;
            }
            direction = cosine_direction(texel.xyz, direction_at(place, sample));
            query = any_begin(Ray(origin, direction), 0.0, rays.distance);
        }
    }
    return pow(open / f32(rays.samples), rays.strength);
}

// Lanes of one class next to each other: `lane` of `edge` x `edge` pixels to a place among them.
fn class_order(lane: u32, edge: u32) -> vec2u {
    let across = edge / 4u;
    let place = lane / (across * across);
    let within = lane % (across * across);
    return vec2u(place % 4u + 4u * (within % across), place / 4u + 4u * (within / across));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = tile_pixel(group, vec3u(class_order(lane, 8u), 0u));
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
