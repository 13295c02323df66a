// The second half of FXAA (Lottes 2009, version 3 with its search for the ends of an edge): blends
// listed pixels across edges of brightness, in linear light and premultiplied, so that alpha edges
// come out right.

@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(1) var brightness: texture_2d<f32>;
@group(2) @binding(2) var nearest: sampler; // nearest
// fxaa_edges.wgsl
@group(2) @binding(3) var<storage, read> edge_count: array<u32, 4>;
@group(2) @binding(4) var<storage, read> edge_list: array<u32>;

// Farthest pair of pixels along an edge; odd.
const SEARCH: f32 = 9.0;
// Share of the blur of single stray pixels.
const STRAY: f32 = 0.75;

// Sums of brightness across the edge of two neighbouring pairs of pixels, first and last along it,
// around a corner of pixels. The sampler repeats the last texels beyond the picture.
fn pairs(corner: vec2f, scale: vec2f, horizontal: bool) -> vec2f {
    let four = textureGather(0, brightness, nearest, corner * scale);
    return select(four.wx + four.zy, four.xy + four.wz, horizontal);
}

// How far a pixel is covered by what lies across an edge: from its distance to the nearer end of the
// edge, where one of the two sides of the edge changes. `corner` is the pixel's first corner on the
// edge, `scale` one over the picture's size, `beside` the sums of the pairs before and after it, `own`
// and `other` the pixel and the one across.
fn edge_share(
    corner: vec2f, scale: vec2f, horizontal: bool, beside: vec2f, own: f32, other: f32,
) -> f32 {
    let middle = own + other;
    let gradient = vec2f(0.5 * abs(other - own));
    let along = select(vec2f(0.0, 1.0), vec2f(1.0, 0.0), horizontal);
    // of the ends before and after the pixel
    var ends = vec2f(1.0);
    var jumps = beside - middle;
    var on = abs(jumps) < gradient;
    for (var i = 2.0; any(on) && i < SEARCH; i += 2.0) {
        let before = pairs(corner - i * along, scale, horizontal).yx - middle;
        let after = pairs(corner + (i + 1.0) * along, scale, horizontal) - middle;
        let near = vec2f(before.x, after.x);
        let ended = abs(near) >= gradient;
        let jump = select(vec2f(before.y, after.y), near, ended);
        ends = select(ends, select(vec2f(i + 1.0), vec2f(i), ended), on);
        jumps = select(jumps, jump, on);
        on = on & (abs(jump) < gradient);
    }
    let jump = select(jumps.x, jumps.y, ends.y <= ends.x);
    let crosses = (jump < 0.0) != (own < other);
    return select(0.0, 0.5 - min(ends.x, ends.y) / (ends.x + ends.y), crosses);
}

// The smoothed color of a pixel.
fn smoothed(pixel: vec2u) -> vec4f {
    let scale = 1.0 / vec2f(textureDimensions(brightness));
    // the four squares about the pixel, each counter-clockwise from its lower left
    let place = vec2f(pixel) * scale;
    let upper = textureGather(0, brightness, nearest, place);
    let lower = textureGather(0, brightness, nearest, place + scale);
    // loads of one texel cost half as much
    let end = textureDimensions(brightness) - 1u;
    let before = max(pixel, vec2u(1u)) - 1u;
    let after = min(pixel + 1u, end);
    let ne = textureLoad(brightness, vec2u(after.x, before.y), 0).x;
    let sw = textureLoad(brightness, vec2u(before.x, after.y), 0).x;
    let w = upper.x;
    let m = upper.y;
    let n = upper.z;
    let nw = upper.w;
    let s = lower.x;
    let se = lower.y;
    let e = lower.z;
    let contrast = max(m, max(max(n, s), max(w, e))) - min(m, min(min(n, s), min(w, e)));
    // how much the pixel stands out from its surroundings
    let mean = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
    let stray = smoothstep(0.0, 1.0, saturate(abs(mean - m) / max(contrast, 1e-6)));
    let down = abs(nw + sw - 2.0 * w) + 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e);
    let across = abs(nw + ne - 2.0 * n) + 2.0 * abs(w + e - 2.0 * m) + abs(sw + se - 2.0 * s);
    let horizontal = down >= across;
    // the side on which the edge lies
    let sides = select(vec2f(w, e), vec2f(n, s), horizontal);
    let far = abs(sides.y - m) >= abs(sides.x - m);
    let corners = select(
        select(vec2f(nw, sw), vec2f(ne, se), far),
        select(vec2f(nw, ne), vec2f(sw, se), far),
        horizontal,
    );
    let beside = corners + select(vec2f(n, s), vec2f(w, e), horizontal);
    let across_edge = select(vec2i(1, 0), vec2i(0, 1), horizontal);
    let corner = vec2f(pixel) + f32(far) * vec2f(across_edge);
    let found = edge_share(corner, scale, horizontal, beside, m, select(sides.x, sides.y, far));
    let last = vec2i(textureDimensions(color)) - 1;
    let other = clamp(vec2i(pixel) + select(-across_edge, across_edge, far), vec2i(0), last);
    return mix(
        textureLoad(color, pixel, 0),
        textureLoad(color, other, 0),
        max(found, STRAY * stray * stray),
    );
}

// Pixel of an invocation; beyond all pictures if there are no more edges.
fn edge_pixel(index: u32) -> vec2u {
    let edge = select(0xffffffffu, edge_list[index], index < edge_count[3]);
    return vec2u(edge & 0xffffu, edge >> 16u);
}
