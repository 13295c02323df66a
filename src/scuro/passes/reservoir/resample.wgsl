// The model sampled on a regular grid: value x inside and inside (Campagnolo 2021, section 4.1.1).

//#include "locate.wgsl"

struct Resample {
    low: vec3f,
    // 32-bit words in a row, padded as copies into textures want it
    row: u32,
    voxel: vec3f,
    first: u32,
    size: vec3u,
    pad: u32,
}

@group(2) @binding(0) var<uniform> resample: Resample;
@group(2) @binding(1) var<storage, read_write> texels: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= resample.size)) {
        return;
    }
    let p = resample.low + (vec3f(id) + 0.5) * resample.voxel;
    var frame: Frame;
    let found = locate(p, &frame);
    var out = vec2f(0.0);
    if (found.found && has_bit(flag_words(frame.column, found.layer).y, found.layer)) {
        out = vec2f(value_in(frame.column, found.layer, found.at), 1.0);
    }
    texels[(id.z * resample.size.y + id.y) * resample.row + id.x] = pack2x16float(out);
}

