// From data to emptiness: smallest and largest value of each block (once), which blocks the
// transfer function shows (when it changes), and for the others how far the nearest one is.

struct Blocks {
    size: vec3u,
    block: u32,
    blocks: vec3u,
    table_end: f32,
    // axis of the distance pass
    axis: u32,
    // no distance beyond this is told
    reach: u32,
    // first layer of blocks whose ranges are found
    first: u32,
}

@group(0) @binding(0) var<uniform> params: Blocks;
@group(0) @binding(1) var samples: texture_3d<f32>;
@group(0) @binding(2) var<storage, read_write> ranges: array<u32>;
// how many table entries before each one are not clear
@group(0) @binding(3) var<storage, read> shown: array<u32>;
@group(0) @binding(4) var<storage, read> source: array<u32>;
@group(0) @binding(5) var<storage, read_write> target_: array<u32>;

fn flat(b: vec3u) -> u32 {
    return (b.z * params.blocks.y + b.y) * params.blocks.x + b.x;
}

// Trilinear samples in a block also see the voxels around it.
@compute @workgroup_size(4, 4, 4)
fn find_ranges(@builtin(global_invocation_id) id: vec3u) {
    let block = id + vec3u(0u, 0u, params.first);
    if (any(block >= params.blocks)) {
        return;
    }
    let low = vec3u(max(vec3i(block * params.block) - 1, vec3i(0)));
    let high = min((block + 1u) * params.block + 1u, params.size);
    var smallest = 1.0;
    var largest = 0.0;
    for (var z = low.z; z < high.z; z++) {
        for (var y = low.y; y < high.y; y++) {
            for (var x = low.x; x < high.x; x++) {
                let v = textureLoad(samples, vec3u(x, y, z), 0).r;
                smallest = min(smallest, v);
                largest = max(largest, v);
            }
        }
    }
    ranges[flat(block)] = pack2x16unorm(vec2f(smallest, largest));
}

@compute @workgroup_size(4, 4, 4)
fn find_occupied(@builtin(global_invocation_id) block: vec3u) {
    if (any(block >= params.blocks)) {
        return;
    }
    let range = unpack2x16unorm(ranges[flat(block)]) * params.table_end;
    // the entries that look-ups can round to; the margin covers the rounding of the ranges. A whole
    // entry would be too much: many functions begin to rise at the background's own value
    let first = u32(max(range.x + 0.48, 0.0));
    let last = u32(min(range.y + 0.52, params.table_end));
    target_[flat(block)] = select(params.reach, 0u, shown[last + 1u] > shown[first]);
}

// One axis of the Chebyshev distance: the least, over blocks along the axis, of the larger of the
// distance to that block and the distance found from it along the axes before.
@compute @workgroup_size(4, 4, 4)
fn spread(@builtin(global_invocation_id) block: vec3u) {
    if (any(block >= params.blocks)) {
        return;
    }
    let place = i32(block[params.axis]);
    let count = i32(params.blocks[params.axis]);
    var best = source[flat(block)];
    for (var k = 1u; k < best; k++) {
        for (var side = -1; side <= 1; side += 2) {
            let other = place + side * i32(k);
            if (other >= 0 && other < count) {
                var b = block;
                b[params.axis] = u32(other);
                best = min(best, max(k, source[flat(b)]));
            }
        }
    }
    target_[flat(block)] = best;
}
