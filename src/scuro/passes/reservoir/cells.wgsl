// The cells' values, which of them are seen, and the areal grid that finds columns.

//#include "ray.wgsl"
//#include "columns.wgsl"

// four 16-bit values a surface, 0 to 1 over the property's range
@group(1) @binding(4) var values: texture_2d<u32>;
// a bit a layer: whether the cell is to be seen, and whether it holds a value at all
@group(1) @binding(5) var flags: texture_2d<u32>;
// each voxel of the areal grid: first in the list of columns, how many, bits of lowest and highest z
@group(1) @binding(6) var voxels: texture_2d<u32>;
// the lists of columns
@group(1) @binding(7) var areal: texture_2d<u32>;

struct Voxel {
    first: i32,
    count: i32,
    low: f32,
    high: f32,
}

fn voxel_at(index: vec2i) -> Voxel {
    let entry = textureLoad(voxels, texel_of(index.y * i32(model.areal_dims.x) + index.x), 0);
    return Voxel(i32(entry.x), i32(entry.y), bitcast<f32>(entry.z), bitcast<f32>(entry.w));
}

fn listed_column(number: i32) -> vec2i {
    let column = i32(textureLoad(areal, texel_of(number), 0).x);
    let width = i32(model.columns.x);
    return vec2i(column % width, column / width);
}

fn surface_values(column: Column, surface: i32) -> vec4f {
    return vec4f(textureLoad(values, texel_of(column.start + surface), 0)) / 65535.0;
}

// Bits of 32 layers of a column, the given one's among them: seen, and valued.
fn flag_words(column: Column, layer: i32) -> vec2u {
    return textureLoad(flags, texel_of(column.words + (layer >> 5u)), 0).xy;
}

fn has_bit(word: u32, layer: i32) -> bool {
    return ((word >> u32(layer & 31)) & 1u) != 0u;
}
