// The 8 x 8 pixel tiles of the picture in which there may be a surface. Passes over surfaces run on
// these only (Frame.compute_tiles): a software adapter pays in full for pixels that return early.

const TILE: u32 = 8u;

@group(0) @binding(1) var<storage, read> tile_list: array<u32>;

// The same invocations so that each eight in a row are a block of 4 x 2 pixels, not a line: lanes of one
// vector whose rays keep together longer.
fn in_blocks(local: vec3u) -> vec3u {
    return vec3u((local.x & 3u) + 4u * (local.y & 1u), (local.x >> 2u) + 2u * (local.y >> 1u), 0u);
}

// Pixel of an invocation of a tiled pass with @workgroup_size(8, 8).
fn tile_pixel(group: vec3u, local: vec3u) -> vec2u {
    let tile = tile_list[group.x];
    return vec2u(tile & 0xffffu, tile >> 16u) * TILE + local.xy;
}
