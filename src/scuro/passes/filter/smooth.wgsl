// Edge-aware smoothing of a noisy picture, or of its ratio to a guide without noise:
//
//     result = guide · Σ w value / Σ w guide        (guide = 1: the plain weighted mean)
//
// What guide and value both know of a crease is then not blurred, and the mean over a neighbourhood
// is that of the values. Pairs (value, guide) are smoothed; unknown values (below 0) are pairs of
// zeros, which count for nothing.

//#include "tiles.wgsl"
//#include "edges.wgsl"

struct Smooth {
    // radius of the kernel, or step between taps (atrous), in texels of the source
    reach: i32,
    // which pixel of each 2 x 2 block a half-resolution texel stands for
    offset: u32,
    // distance from the tangent plane that counts as another surface, in typical radii
    tolerance: f32,
    // how much normals must agree: 1 for one sample a pixel, more for more
    selective: f32,
    // one over the difference beyond which another value counts for nothing
    distinct: f32,
}

@group(2) @binding(0) var<uniform> smooth_settings: Smooth;
@group(2) @binding(1) var surface: texture_2d<f32>;
// the values, and for the first pass what becomes of them
@group(2) @binding(2) var source: texture_2d<f32>;
// at full resolution
@group(2) @binding(3) var guide: texture_2d<f32>;
@group(2) @binding(4) var pairs: texture_2d<f32>;
@group(2) @binding(5) var smoothed: texture_storage_2d<rg32float, write>;
@group(2) @binding(6) var result: texture_storage_2d<r32float, write>;

// Pixels along the edge of a block that one texel of the source stands for: 1 or 2.
override BLOCK: u32 = 1u;
override GUIDED: bool = false;
// Whether this pass reads the source (or the pairs of the one before), and writes the result.
override FIRST: bool = true;
override LAST: bool = false;

fn size() -> vec2i {
    return vec2i(textureDimensions(source));
}

fn inside(place: vec2i) -> bool {
    return all(place >= vec2i(0)) && all(place < size());
}

// The pixel of the G-buffer that a texel of the source stands for.
fn pixel_of(place: vec2i) -> vec2i {
    if (BLOCK == 1u) {
        return place;
    }
    let offset = vec2i(vec2u(smooth_settings.offset & 1u, smooth_settings.offset >> 1u));
    return min(place * 2 + offset, vec2i(textureDimensions(surface)) - 1);
}

fn guide_at(pixel: vec2i) -> f32 {
    if (!GUIDED) {
        return 1.0;
    }
    return max(textureLoad(guide, pixel, 0).x, 1e-3);
}

fn pair_at(place: vec2i) -> vec2f {
    if (!FIRST) {
        return textureLoad(pairs, place, 0).xy;
    }
    let value = textureLoad(source, place, 0).x;
    return select(vec2f(value, guide_at(pixel_of(place))), vec2f(0.0), value < 0.0);
}

fn store(place: vec2i, pair: vec2f) {
    if (!LAST) {
        textureStore(smoothed, place, vec4f(pair, 0.0, 0.0));
        return;
    }
    let known = textureLoad(source, place, 0).x;
    // -1: no value belongs here; -2: there is one, which only neighbours tell
    let unknown = (known < 0.0 && known > -1.5) || pair.y <= 0.0;
    let value = guide_at(place) * pair.x / max(pair.y, 1e-6);
    textureStore(result, place, vec4f(select(saturate(value), 1.0, unknown)));
}

fn along(place: vec2i, axis: vec2i) {
    if (!inside(place)) {
        return;
    }
    let pixel = pixel_of(place);
    let center = center_at(pixel, textureLoad(surface, pixel, 0), smooth_settings.tolerance,
        smooth_settings.selective);
    let reach = smooth_settings.reach;
    var sum = pair_at(place);
    var total = select(0.0, 1.0, sum.y > 0.0);
    let mine = sum.x / max(sum.y, 1e-6);
    // wide enough for the pattern of ray directions, with a soft end
    for (var i = -reach; i <= reach; i += 1) {
        let there = clamp(place + i * axis, vec2i(0), size() - 1);
        let at = pixel_of(there);
        let x = f32(i) / (f32(reach) + 0.5);
        let fall = select(1.0 - x * x, 0.0, i == 0 || !inside(place + i * axis));
        var w = fall * edge_weight(center, at, textureLoad(surface, at, 0));
        let pair = pair_at(there);
        // what differs by more than its rays' noise is another value, be it as near as across a crease
        let off = (pair.x / max(pair.y, 1e-6) - mine) * smooth_settings.distinct;
        let like = max(1.0 - off * off, 0.0);
        w *= select(1.0, like * like, sum.y > 0.0 && pair.y > 0.0);
        sum += w * pair;
        total += select(0.0, w, pair.y > 0.0);
    }
    store(place, sum / max(total, 1e-9));
}

fn place_in(group: vec3u, local: vec3u) -> vec2i {
    return vec2i(tile_pixel(group, vec3u(0u)) / BLOCK + local.xy);
}

// One texel of the source for each invocation: 8 x 8 a tile, or 4 x 4 at half resolution.
@compute @workgroup_size(8, 8)
fn across(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    along(place_in(group, local), vec2i(1, 0));
}

@compute @workgroup_size(8, 8)
fn down(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    along(place_in(group, local), vec2i(0, 1));
}

@compute @workgroup_size(4, 4)
fn half_across(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    along(place_in(group, local), vec2i(1, 0));
}

@compute @workgroup_size(4, 4)
fn half_down(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    along(place_in(group, local), vec2i(0, 1));
}

// One level of the a-trous wavelet transform: a 5 x 5 B3 spline with holes (Dammertz et al. 2010).
fn atrous_at(place: vec2i) {
    if (!inside(place)) {
        return;
    }
    let pixel = pixel_of(place);
    let step = smooth_settings.reach;
    let center = center_at(pixel, textureLoad(surface, pixel, 0), smooth_settings.tolerance,
        smooth_settings.selective);
    var sum = vec2f(0.0);
    for (var y = -2; y <= 2; y += 1) {
        for (var x = -2; x <= 2; x += 1) {
            let wanted = place + step * vec2i(x, y);
            let there = clamp(wanted, vec2i(0), size() - 1);
            let at = pixel_of(there);
            let kernel = spline(x) * spline(y) * select(0.0, 1.0, inside(wanted));
            let edge = edge_weight(center, at, textureLoad(surface, at, 0));
            let w = kernel * select(edge, 1.0, x == 0 && y == 0);
            sum += w * pair_at(there);
            }
    }
    store(place, sum);
}

// B3 spline: 1, 4, 6, 4, 1 sixteenths.
fn spline(x: i32) -> f32 {
    return select(select(0.375, 0.25, abs(x) == 1), 0.0625, abs(x) == 2);
}

@compute @workgroup_size(8, 8)
fn atrous(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    atrous_at(place_in(group, local));
}

@compute @workgroup_size(4, 4)
fn half_atrous(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    atrous_at(place_in(group, local));
}

// Joint bilateral upsampling (Kopf et al. 2007) from one real pixel of each 2 x 2 block.
@compute @workgroup_size(8, 8)
fn upsample(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = vec2i(tile_pixel(group, local));
    if (any(pixel >= vec2i(textureDimensions(surface)))) {
        return;
    }
    let offset = vec2i(vec2u(smooth_settings.offset & 1u, smooth_settings.offset >> 1u));
    let center = center_at(pixel, textureLoad(surface, pixel, 0), smooth_settings.tolerance,
        smooth_settings.selective);
    let base = (pixel - offset) / 2 - select(vec2i(0), vec2i(1), pixel < offset);
    var sum = vec2f(0.0);
    for (var y = 0; y <= 1; y += 1) {
        for (var x = 0; x <= 1; x += 1) {
            let place = clamp(base + vec2i(x, y), vec2i(0), size() - 1);
            let at = pixel_of(place);
            let near = max(vec2f(0.1), 1.0 - 0.5 * abs(vec2f(pixel - at)));
            // never nothing: the pixel's own block is better than no answer
            let w = near.x * near.y * edge_weight(center, at, textureLoad(surface, at, 0)) + 1e-5;
            sum += w * textureLoad(pairs, place, 0).xy;
        }
    }
    let value = guide_at(pixel) * sum.x / max(sum.y, 1e-9);
    textureStore(result, pixel, vec4f(select(saturate(value), 1.0, sum.y <= 0.0)));
}
