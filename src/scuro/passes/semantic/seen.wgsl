// How every pass over the picture begins: the pixel of an invocation and the surface it sees.

//#include "tiles.wgsl"
//#include "view.wgsl"

// normal and depth along -z; 0 where there is nothing
@group(2) @binding(0) var surface: texture_2d<f32>;

struct Seen {
    pixel: vec2u,
    size: vec2u,
    normal: vec3f,
    depth: f32,
    // the tile reaches over the picture's edge
    outside: bool,
    // nothing is there to be lit
    empty: bool,
}

fn seen(group: vec3u, local: vec3u) -> Seen {
    return seen_at(tile_pixel(group, local));
}

// The same of a pass over one pixel in THIN x THIN, with @workgroup_size(8, 2): the first of each block,
// for what is blurred so widely that it needs no more. Parts of a picture begin at even pixels.
const THIN: u32 = 2u;

fn seen_thinly(group: vec3u, local: vec3u) -> Seen {
    let block = vec2u(local.x & 3u, (local.x >> 2u) + 2u * local.y);
    return seen_at(tile_pixel(group, vec3u(0u)) + THIN * block);
}

fn seen_at(pixel: vec2u) -> Seen {
    let size = textureDimensions(surface);
    let texel = textureLoad(surface, pixel, 0);
    return Seen(pixel, size, texel.xyz, texel.w, any(pixel >= size), texel.w <= 0.0);
}

// Whether a texel of `surface` shows what `here` shows: no edge lies between.
fn joined(here: Seen, there: vec4f, depth_limit: f32, normal_limit: f32) -> bool {
    return there.w > 0.0 && abs(there.w - here.depth) < depth_limit
        && dot(there.xyz, here.normal) > normal_limit;
}

fn seen_position(here: Seen) -> vec3f {
    return scene_position(vec2f(here.pixel) + 0.5, here.depth);
}
