// FXAA (Lottes 2009, version 3, console form extended by a search along the edge): blends across
// edges of brightness, in linear light and premultiplied, so that alpha edges come out right.

//#include "tiles.wgsl"
//#include "color.wgsl"

struct Fxaa {
    // linear, premultiplied
    background: vec4f,
}

@group(2) @binding(0) var<uniform> fxaa: Fxaa;
@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var replaced: texture_storage_2d<rgba16float, write>;

// Contrast below which nothing is done, relative and absolute.
const RELATIVE: f32 = 0.125;
const ABSOLUTE: f32 = 0.0312;
const SEARCH: i32 = 10;
// Share of the blur of single stray pixels.
const STRAY: f32 = 0.75;

fn texel(pixel: vec2i) -> vec4f {
    return textureLoad(color, clamp(pixel, vec2i(0), vec2i(textureDimensions(color)) - 1), 0);
}

// Brightness as seen over the background; what is transparent in the end differs by its alpha.
fn luma(pixel: vec2i) -> f32 {
    let c = texel(pixel);
    let over = saturate(c.rgb + fxaa.background.rgb * (1.0 - c.a));
    return mix(0.5 * c.a, 0.0, fxaa.background.a) + sqrt(luminance(over));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    let pixel = vec2i(id);
    if (any(pixel >= vec2i(textureDimensions(replaced)))) {
        return;
    }
    let m = luma(pixel);
    let n = luma(pixel + vec2i(0, -1));
    let s = luma(pixel + vec2i(0, 1));
    let w = luma(pixel + vec2i(-1, 0));
    let e = luma(pixel + vec2i(1, 0));
    let highest = max(m, max(max(n, s), max(w, e)));
    let contrast = highest - min(m, min(min(n, s), min(w, e)));
    let flat = contrast < max(ABSOLUTE, highest * RELATIVE);

    let nw = luma(pixel + vec2i(-1, -1));
    let ne = luma(pixel + vec2i(1, -1));
    let sw = luma(pixel + vec2i(-1, 1));
    let se = luma(pixel + vec2i(1, 1));
    // how much the pixel stands out from its surroundings
    let mean = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
    let stray = smoothstep(0.0, 1.0, saturate(abs(mean - m) / max(contrast, 1e-6)));
    let down = abs(nw + sw - 2.0 * w) + 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e);
    let across = abs(nw + ne - 2.0 * n) + 2.0 * abs(w + e - 2.0 * m) + abs(sw + se - 2.0 * s);
    let horizontal = down >= across;
    // the side on which the edge lies
    let before = select(w, n, horizontal);
    let after = select(e, s, horizontal);
    let to_after = abs(after - m) >= abs(before - m);
    let other = select(before, after, to_after);
    let unit = select(vec2i(1, 0), vec2i(0, 1), horizontal);
    let side = select(-unit, unit, to_after);
    let along = unit.yx;
    // walk along the edge until it ends on either side
    let middle = 0.5 * (m + other);
    let gradient = 0.25 * abs(other - m);
    var ends = vec2f(f32(SEARCH));
    var jumps = vec2f(0.0);
    for (var way = 0; way < 2; way += 1) {
        let go = select(along, -along, way == 1);
        for (var i = 1; i <= select(SEARCH, 0, flat); i += 1) {
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
    let crosses = (jumps[nearer] < 0.0) != (m < middle);
    let edge = select(0.0, 0.5 - min(ends.x, ends.y) / (ends.x + ends.y), crosses);
    let share = select(max(edge, STRAY * stray * stray), 0.0, flat);
    textureStore(replaced, pixel, mix(texel(pixel), texel(pixel + side), share));
}
