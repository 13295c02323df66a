// The cells' values, which of them are seen, and the areal grid that finds columns.

//#include "ray.wgsl"
//#include "columns.wgsl"

// four 16-bit values a surface, 0 to 1 over the property's range
@group(1) @binding(4) var<storage, read> values: array<vec2u>;
// a bit a layer: whether the cell is to be seen; then whether it holds a value at all
@group(1) @binding(5) var<storage, read> flags: array<u32>;
// first index of each voxel's list of columns, and the lists
@group(1) @binding(6) var<storage, read> areal: array<u32>;
// lowest and highest z of the columns over each voxel
@group(1) @binding(7) var<storage, read> heights: array<vec2f>;

fn surface_values(column: Column, surface: i32) -> vec4f {
    return unpack_steps(values[i32(column.start) + surface]) / 65535.0;
}

fn flag(column: Column, layer: i32, offset: u32) -> bool {
    let word = flags[offset + column.words + u32(layer >> 5)];
    return ((word >> u32(layer & 31)) & 1u) != 0u;
}

fn is_shown(column: Column, layer: i32) -> bool {
    return flag(column, layer, 0u);
}

fn is_valued(column: Column, layer: i32) -> bool {
    return flag(column, layer, model.flag_words);
}
