// Copies what the cells list beside their references: see Entry in wgsl/trace.wgsl.

//#include "scene_types.wgsl"

struct Copying {
    first: u32,
    count: u32,
}

@group(0) @binding(0) var<uniform> copying: Copying;
@group(0) @binding(1) var slots: texture_2d<f32>;
@group(0) @binding(2) var ref_table: texture_2d<u32>;
@group(0) @binding(3) var entry_table: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let index = copying.first + id.x;
    if (index >= copying.count) {
        return;
    }
    let reference = textureLoad(ref_table, table_place(index), 0).x;
    let primitive = reference & ~LAST_OF_CELL;
    let last = (reference & LAST_OF_CELL) != 0u;
    var texel = vec4f(f32(primitive & 0xffffu), f32(primitive >> 16u), select(0.0, 1.0, last), 0.0);
    if (kind_of(primitive) == SPHERE) {
        texel = textureLoad(slots, table_place(slot_of(primitive)), 0);
        texel.w = select(texel.w, -texel.w, last);
    }
    textureStore(entry_table, table_place(index), texel);
}
