// What earlier frames of the same scene found, joined with what this one did.
//
// While the camera rests every pixel keeps the plain mean of its frames, which converges to the
// truth. When it moves, what was known is looked up where the point was seen before; it then counts
// as a guess that fades out as the camera rests.

//#include "tiles.wgsl"
//#include "view.wgsl"

struct Temporal {
    // whether the camera differs from the frame before
    moved: u32,
    // pixels along the edge of a block that one texel of the source stands for, and which it is
    block: u32,
    offset: u32,
    // value of what is not known
    unknown: f32,
}

@group(2) @binding(0) var<uniform> temporal: Temporal;
// the camera of the frame before
@group(2) @binding(1) var<uniform> before: View;
@group(2) @binding(2) var surface: texture_2d<f32>;
@group(2) @binding(3) var surface_before: texture_2d<f32>;
// this frame's values, below 0 where it has none
@group(2) @binding(4) var source: texture_2d<f32>;
// mean and frames since the camera rests; mean and frames of the guess from before
@group(2) @binding(5) var known: texture_2d<f32>;
@group(2) @binding(6) var joined: texture_storage_2d<rgba32float, write>;
@group(2) @binding(7) var result: texture_storage_2d<r32float, write>;

// Frames that a guess counts for at most, and after how many at rest it counts for none.
const MOST: f32 = 24.0;
const FADE: f32 = 16.0;

// Mean and frames of all that a pixel knows.
fn merged(state: vec4f) -> vec2f {
    let guess = state.w * max(0.0, 1.0 - state.y / FADE);
    let frames = state.y + guess;
    return vec2f((state.x * state.y + state.z * guess) / max(frames, 1e-6), frames);
}

// Pixel of the frame before at which a point of its view space lay.
fn pixel_before(p: vec3f) -> vec2f {
    let scale = select(-p.z, 1.0, before.orthographic != 0u);
    let picture = p.xy / (scale * before.half_extent);
    return (vec2f(picture.x, -picture.y) * 0.5 + 0.5) * before.size - before.origin - before.jitter;
}

fn position_before(pixel: vec2f, depth: f32) -> vec3f {
    let p = (pixel + before.origin + before.jitter) / before.size * 2.0 - 1.0;
    let at = vec2f(p.x, -p.y) * before.half_extent;
    return vec3f(at * select(depth, 1.0, before.orthographic != 0u), -depth);
}

// Mean and frames known of a surface point by the frame before, from the four pixels around it that
// showed the same surface.
fn looked_up(position: vec3f, normal: vec3f) -> vec2f {
    let p = (before.view_from_scene * vec4f(position, 1.0)).xyz;
    let n = (before.view_from_scene * vec4f(normal, 0.0)).xyz;
    let at = pixel_before(p) - 0.5;
    let base = vec2i(floor(at));
    let part = at - floor(at);
    let width = 2.0 * before.half_extent.y / before.size.y
        * select(-p.z, 1.0, before.orthographic != 0u);
    var sum = vec2f(0.0);
    var total = 0.0;
    for (var i = 0u; i < 4u; i += 1u) {
        let corner = vec2i(vec2u(i & 1u, i >> 1u));
        let place = base + corner;
        let inside = all(place >= vec2i(0)) && all(place < vec2i(textureDimensions(surface)))
            && (before.orthographic != 0u || p.z < 0.0);
        let seen = vec2u(select(vec2i(0), place, inside));
        let texel = textureLoad(surface_before, seen, 0);
        // the same surface: in the tangent plane but for what a pixel spans, and turned alike
        let off = dot(n, position_before(vec2f(seen) + 0.5, texel.w) - p);
        let same = inside && texel.w > 0.0 && abs(off) < width && dot(texel.xyz, normal) > 0.8;
        let known_there = merged(textureLoad(known, seen, 0));
        let share = abs(1.0 - vec2f(corner) - part);
        let w = select(0.0, share.x * share.y, same && known_there.y > 0.0);
        sum += w * known_there;
        total += w;
    }
    if (total < 0.05) {
        return vec2f(0.0);
    }
    return vec2f(sum.x / total, min(sum.y / total, MOST));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        textureStore(joined, pixel, vec4f(0.0));
        textureStore(result, pixel, vec4f(1.0));
        return;
    }
    var state = vec4f(0.0);
    if (temporal.moved == 0u) {
        state = textureLoad(known, pixel, 0);
    } else {
        let guess = looked_up(scene_position(vec2f(pixel) + 0.5, texel.w), texel.xyz);
        state = vec4f(0.0, 0.0, guess);
    }
    let offset = vec2u(temporal.offset & 1u, temporal.offset >> 1u);
    let mine = temporal.block == 1u || all(pixel % 2u == offset);
    let fresh = textureLoad(source, pixel / temporal.block, 0).x;
    if (mine && fresh >= 0.0) {
        state.y += 1.0;
        state.x += (fresh - state.x) / state.y;
    }
    let all_known = merged(state);
    textureStore(joined, pixel, state);
    textureStore(result, pixel, vec4f(select(temporal.unknown, all_known.x, all_known.y > 0.0)));
}
