// The first half of FXAA (Lottes 2009): which pixels stand out from their neighbours. They are few,
// and listed, so that only they are looked at closer (fxaa.wgsl).

//#include "tiles.wgsl"

@group(2) @binding(0) var brightness: texture_2d<f32>;
@group(2) @binding(1) var nearest: sampler; // nearest
// workgroups for 64 edges each, 1, 1; number of edges
@group(2) @binding(2) var<storage, read_write> edge_count: array<atomic<u32>, 4>;
// x and y in 16 bits each
@group(2) @binding(3) var<storage, read_write> edge_list: array<u32>;

// Contrast below which nothing is done, relative and absolute.
const RELATIVE: f32 = 0.166;
const ABSOLUTE: f32 = 0.0312;
const GROUP: u32 = 64u;


// Two rows of four texels.
struct Rows {
    first: vec4f,
    second: vec4f,
}

// The two rows of texels that meet at a corner, from one before it to two behind; the sampler
// repeats the last texels beyond the picture.
fn rows_at(corner: vec2f, scale: vec2f) -> Rows {
    let left = textureGather(0, brightness, nearest, corner * scale);
    let right = textureGather(0, brightness, nearest, (corner + vec2f(2.0, 0.0)) * scale);
    return Rows(vec4f(left.wz, right.wz), vec4f(left.xy, right.xy));
}

// Whether the middle two of a row stand out.
fn stand_out(above: vec4f, row: vec4f, below: vec4f) -> vec2u {
    let highest = max(max(row.yz, max(row.xy, row.zw)), max(above.yz, below.yz));
    let lowest = min(min(row.yz, min(row.xy, row.zw)), min(above.yz, below.yz));
    return vec2u(highest - lowest >= max(vec2f(ABSOLUTE), highest * RELATIVE));
}

// Lists the edges among 2 x 4 pixels.
fn list_edges(corner: vec2u) {
    let size = textureDimensions(brightness);
    let scale = 1.0 / vec2f(size);
    var found = 0u;
    var before = rows_at(vec2f(corner), scale);
    for (var y = 0u; y < 4u; y += 2u) {
        let after = rows_at(vec2f(corner + vec2u(0u, y + 2u)), scale);
        let upper = stand_out(before.first, before.second, after.first);
        let lower = stand_out(before.second, after.first, after.second);
        found |= (upper.x | (upper.y << 1u) | (lower.x << 2u) | (lower.y << 3u)) << (2u * y);
        before = after;
    }
    // not beyond the picture
    let rest_rows = min(size.y - min(corner.y, size.y), 4u);
    let columns = select(select(0u, 0x55u, corner.x < size.x), 0xffu, corner.x + 1u < size.x);
    found &= columns & ((1u << (2u * rest_rows)) - 1u);
    let count = countOneBits(found);
    if (count == 0u) {
        return;
    }
    var place = atomicAdd(&edge_count[3], count);
    let groups = (place + count + GROUP - 1u) / GROUP - (place + GROUP - 1u) / GROUP;
    if (groups > 0u) {
        atomicAdd(&edge_count[0], groups);
    }
    for (var rest = found; rest != 0u; rest &= rest - 1u) {
        let bit = countTrailingZeros(rest);
        edge_list[place] = (corner.x + (bit & 1u)) | ((corner.y + (bit >> 1u)) << 16u);
        place += 1u;
    }
}

@compute @workgroup_size(8, 8)
fn everywhere(@builtin(global_invocation_id) id: vec3u) {
    list_edges(id.xy * vec2u(2u, 4u));
}

// All eight blocks of a tile in a row: lavapipe makes vectors along x alone, and four would leave half of
// one empty.
@compute @workgroup_size(8)
fn tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    list_edges(tile_pixel(group, vec3u(0u)) + vec2u(local.x & 3u, local.x >> 2u) * vec2u(2u, 4u));
}
