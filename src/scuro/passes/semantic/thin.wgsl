// What is found in one pixel of each block of THIN x THIN, its first (seen_thinly), and what is between.

//#include "seen.wgsl"

struct Edges {
    // what is an edge, as in blur.wgsl
    depth_limit: f32,
    normal_limit: f32,
}

@group(2) @binding(8) var<uniform> edges: Edges;

// The first pixel of the block of another, or of the next one along x (k = 1), y (2) or both (3).
struct Corner {
    pixel: vec2u,
    // its texel of `surface`; nothing where it is outside
    there: vec4f,
}

fn corner(k: u32, here: Seen) -> Corner {
    let at = here.pixel / THIN * THIN + THIN * vec2u(k & 1u, k >> 1u);
    let inside = min(at, here.size - 1u);
    let there = textureLoad(surface, inside, 0);
    return Corner(inside, select(vec4f(0.0), there, all(inside == at)));
}

// Whether a depth lies on the surface of another.
fn level_with(one: f32, other: f32) -> bool {
    return one > 0.0 && abs(one - other) < edges.depth_limit;
}

// What must be found in the block of its first pixel for shadows: one bit a pixel, along x, then y. The
// first, and those that lie in other depths than all first pixels about them: narrow gaps between
// what is near.
fn wanted_of(first: Seen) -> u32 {
    let depths = vec4f(
        first.depth,
        corner(1u, first).there.w,
        corner(2u, first).there.w,
        corner(3u, first).there.w,
    );
    var wanted = select(1u, 0u, first.empty);
    for (var k = 1u; k < 4u; k += 1u) {
        let here = seen_at(first.pixel + vec2u(k & 1u, k >> 1u));
        var held = false;
        for (var i = 0u; i < 4u; i += 1u) {
            held |= (i | k) == k && level_with(depths[i], here.depth);
        }
        wanted |= select(1u << k, 0u, held || here.outside || here.empty);
    }
    return wanted;
}
