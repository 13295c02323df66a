// FXAA (Lottes 2009, version 3, console form extended by a search along the edge): blends across
// edges of brightness, in linear light and premultiplied, so that alpha edges come out right.

//#include "tiles.wgsl"

@group(2) @binding(0) var color: texture_2d<f32>;
// fxaa_luma.wgsl
@group(2) @binding(1) var brightness: texture_2d<f32>;
@group(2) @binding(2) var nearest: sampler; // nearest
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

// Contrast below which nothing is done, relative and absolute.
const RELATIVE: f32 = 0.125;
const ABSOLUTE: f32 = 0.0312;
// Farthest step along an edge; steps grow beyond the fourth pixel.
const SEARCH: i32 = 8;
// Share of the blur of single stray pixels.
const STRAY: f32 = 0.75;

fn luma(pixel: vec2i) -> f32 {
    let last = vec2i(textureDimensions(brightness)) - 1;
    return textureLoad(brightness, clamp(pixel, vec2i(0), last), 0).x;
}

// How far the pixel is covered by what lies across an edge: from its distance to the nearer end of
// the edge, where one of the two sides of the edge changes.
fn edge_share(pixel: vec2i, side: vec2i, along: vec2i, own: f32, other: f32) -> f32 {
    let middle = 0.5 * (own + other);
    let gradient = 0.25 * abs(other - own);
    var ends = vec2f(f32(SEARCH));
    var jumps = vec2f(0.0);
    for (var way = 0; way < 2; way += 1) {
        let go = select(along, -along, way == 1);
        for (var i = 1; i <= SEARCH; i += 1 + i / 4) {
            let place = pixel + i * go;
            let jump = 0.5 * (luma(place) + luma(place + side)) - middle;
            if (abs(jump) >= gradient || i == SEARCH) {
                ends[way] = f32(i);
                jumps[way] = jump;
                break;
            }
        }
    }
    let nearer = select(1, 0, ends.x <= ends.y);
    let crosses = (jumps[nearer] < 0.0) != (own < middle);
    return select(0.0, 0.5 - min(ends.x, ends.y) / (ends.x + ends.y), crosses);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    let size = textureDimensions(replaced);
    if (any(id >= size)) {
        return;
    }
    let pixel = vec2i(id);
    // the squares above to the left and below to the right, each counter-clockwise from its lower
    // left; the sampler repeats the last texels beyond the picture
    let scale = 1.0 / vec2f(size);
    let upper = textureGather(0, brightness, nearest, vec2f(id) * scale);
    let lower = textureGather(0, brightness, nearest, (vec2f(id) + 1.0) * scale);
    let w = upper.x;
    let m = upper.y;
    let n = upper.z;
    let nw = upper.w;
    let s = lower.x;
    let se = lower.y;
    let e = lower.z;
    let highest = max(m, max(max(n, s), max(w, e)));
    let contrast = highest - min(m, min(min(n, s), min(w, e)));
    var result = textureLoad(color, id, 0);
    // once or never: a loop that no neighbour enters is skipped where a branch would not be
    for (var edge = contrast >= max(ABSOLUTE, highest * RELATIVE); edge; edge = false) {
        let ne = luma(pixel + vec2i(1, -1));
        let sw = luma(pixel + vec2i(-1, 1));
        // how much the pixel stands out from its surroundings
        let mean = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
        let stray = smoothstep(0.0, 1.0, saturate(abs(mean - m) / max(contrast, 1e-6)));
        let down = abs(nw + sw - 2.0 * w) + 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e);
        let across = abs(nw + ne - 2.0 * n) + 2.0 * abs(w + e - 2.0 * m)
            + abs(sw + se - 2.0 * s);
        let horizontal = down >= across;
        // the side on which the edge lies
        let before = select(w, n, horizontal);
        let after = select(e, s, horizontal);
        let to_after = abs(after - m) >= abs(before - m);
        let other = select(before, after, to_after);
        let unit = select(vec2i(1, 0), vec2i(0, 1), horizontal);
        let side = select(-unit, unit, to_after);
        let found = edge_share(pixel, side, unit.yx, m, other);
        let beside = vec2u(clamp(pixel + side, vec2i(0), vec2i(size) - 1));
        result = mix(result, textureLoad(color, beside, 0), max(found, STRAY * stray * stray));
    }
    textureStore(replaced, id, result);
}
