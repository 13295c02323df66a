// Writes what rays walk through: a texel for each cell, then one for each entry of a cell's list.
// Both in one table, so that one fetch serves whichever a ray needs next (wgsl/trace.wgsl).

//#include "scene_types.wgsl"

struct Copying {
    first: u32,
    cells: u32,
    // cells and entries
    total: u32,
}

@group(0) @binding(0) var<uniform> copying: Copying;
@group(0) @binding(1) var slots: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> cells: array<u32>;
@group(0) @binding(3) var<storage, read> refs: array<u32>;
@group(0) @binding(4) var walked: texture_storage_2d<rgba32uint, write>;
// how many entries each cell has
@group(0) @binding(5) var<storage, read> counts: array<u32>;
// bins of directions in which nothing lies ahead of a cell
@group(0) @binding(6) var<storage, read> clear: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let index = copying.first + id.x;
    if (index >= copying.total) {
        return;
    }
    var texel: vec4u;
    if (index < copying.cells) {
        // where the list begins, whether it is empty, and which way nothing lies
        let empty = counts[index] == 0u;
        texel = vec4u(select(cells[index], EMPTY_CELL, empty), select(0u, 1u, empty), clear[index], 0u);
    } else {
        let reference = refs[index - copying.cells];
        let primitive = reference & ~LAST_OF_CELL;
        let last = (reference & LAST_OF_CELL) != 0u;
        if (kind_of(primitive) == SPHERE) {
            // a sphere whole; radius negative for the last of a cell
            texel = bitcast<vec4u>(textureLoad(slots, table_place(slot_of(primitive)), 0));
            texel.w |= select(0u, 0x80000000u, last);
        } else {
            texel = vec4u(primitive, select(0u, 1u, last), 0u, 0u);
        }
    }
    textureStore(walked, table_place(index), texel);
}
