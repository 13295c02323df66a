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
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(surface);
    let texel = textureLoad(surface, pixel, 0);
    return Seen(pixel, size, texel.xyz, texel.w, any(pixel >= size), texel.w <= 0.0);
}

fn seen_position(here: Seen) -> vec3f {
    return scene_position(vec2f(here.pixel) + 0.5, here.depth);
}
