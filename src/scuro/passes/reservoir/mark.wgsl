// Which cells are to be seen: those that hold a value if the transfer function shows any value
// between the lowest and highest of their corners.

//#include "columns.wgsl"

struct Mark {
    // words of flags a column
    words: u32,
    // last index of the transfer function's table
    table_end: f32,
}

@group(2) @binding(0) var<uniform> mark: Mark;
@group(2) @binding(1) var cell_values: texture_2d<u32>;
@group(2) @binding(2) var values: texture_2d<u32>;
// how many entries of the table up to each one are visible
@group(2) @binding(3) var visible: texture_2d<u32>;
@group(2) @binding(4) var flags: texture_storage_2d<rg32uint, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let place = id.x + id.y * 65535u * 64u;
    if (place >= model.columns.x * model.columns.y) {
        return;
    }
    let column = column_number(i32(place));
    for (var word = 0; word < i32(mark.words); word++) {
        var shown = 0u;
        var valued = 0u;
        for (var bit = 0; bit < 32; bit++) {
            let layer = word * 32 + bit;
            if (layer + 1 >= column.count) {
                break;
            }
            let at = column.start + layer;
            if (textureLoad(cell_values, texel_of(at), 0).x == 65535u) {
                continue;
            }
            valued |= 1u << u32(bit);
            let top = vec4f(textureLoad(values, texel_of(at), 0)) / 65535.0;
            let bottom = vec4f(textureLoad(values, texel_of(at + 1), 0)) / 65535.0;
            let low4 = min(top, bottom);
            let high4 = max(top, bottom);
            let low = min(min(low4.x, low4.y), min(low4.z, low4.w));
            let high = max(max(high4.x, high4.y), max(high4.z, high4.w));
            let first = i32(low * mark.table_end);
            let last = i32(ceil(high * mark.table_end));
            let before = textureLoad(visible, vec2i(first, 0), 0).x;
            if (textureLoad(visible, vec2i(last + 1, 0), 0).x > before) {
                shown |= 1u << u32(bit);
            }
        }
        textureStore(flags, texel_of(column.words + word), vec4u(shown, valued, 0u, 0u));
    }
}
