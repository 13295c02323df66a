// Primitives and grids: what the tracer and the builder of its grids share.

// A primitive is its kind (bits 29, 30) and its first slot; bit 31 marks the last of a cell.
const SPHERE: u32 = 0u;
const ROD: u32 = 1u;
const CONE: u32 = 2u;
const TRIANGLE: u32 = 3u;
const LAST_OF_CELL: u32 = 0x80000000u;
const NO_PRIMITIVE: u32 = 0xffffffffu;
const EMPTY_CELL: u32 = 0xffffffffu;
// marks an empty cell of a grid over instances
const NO_ENTRIES: u32 = 0x80000000u;

fn kind_of(primitive: u32) -> u32 {
    return (primitive >> 29u) & 3u;
}

fn slot_of(primitive: u32) -> u32 {
    return primitive & 0x1fffffffu;
}

struct Grid {
    origin: vec3f,
    // edge length of a cell
    cell: f32,
    dims: vec3u,
    // index of its first cell in `cells`
    cells: u32,
}

// Tables live in textures: a software adapter fetches texels many times faster than it gathers from
// storage buffers, hardware is as fast either way, and textures have no limit of 128 MiB a binding.
const TABLE_BITS: u32 = 13u;

fn table_place(index: u32) -> vec2u {
    return vec2u(index & ((1u << TABLE_BITS) - 1u), index >> TABLE_BITS);
}
