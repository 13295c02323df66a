// A corner-point grid: columns of layers between four pillars. Filled by pack.py and model.py.
//
// Corners of a column are in ring order, (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1), as the four
// components of a vector; parametric coordinates s, t, r run from 0 to 1 along i, j and downward.

struct Pillar {
    // x and y at z = 0, and their change over z
    at: vec2f,
    slope: vec2f,
    // z of depth 0, and how much z sinks a step
    base: f32,
    step: f32,
}

struct Column {
    // index of its first surface in `depths` and `values`
    start: u32,
    // that surface's number, the same in all columns
    first: u32,
    // how many surfaces: one more than layers; 0 for a column without active cells
    count: u32,
    // index of its first word in `flags`
    words: u32,
}

struct Model {
    // the regular grid in x and y: lower corner, size of a voxel, voxels
    areal_origin: vec2f,
    areal_voxel: vec2f,
    areal_dims: vec2u,
    // columns along i and j
    columns: vec2u,
    // corners closer than this (scene units) are one vertex
    tolerance: f32,
    // half the diagonal of the model's box
    extent: f32,
    // words of `shown` before those that tell which cells are active
    flag_words: u32,
    pad: u32,
    // lowest and highest z of all cells
    z_range: vec2f,
}

@group(1) @binding(0) var<uniform> model: Model;
@group(1) @binding(1) var<storage, read> pillars: array<Pillar>;
@group(1) @binding(2) var<storage, read> columns: array<Column>;
// four 16-bit depths a surface, in steps of the pillar's range
@group(1) @binding(3) var<storage, read> depths: array<vec2u>;

fn unpack_steps(packed: vec2u) -> vec4f {
    let low = packed & vec2u(0xffffu);
    let high = packed >> vec2u(16u);
    return vec4f(vec4u(low.x, high.x, low.y, high.y));
}

// Four pillars and the column between them.
struct Frame {
    index: vec2i,
    column: Column,
    x: vec4f,
    y: vec4f,
    slope_x: vec4f,
    slope_y: vec4f,
    base: vec4f,
    step: vec4f,
}

fn frame_of(index: vec2i) -> Frame {
    let row = i32(model.columns.x) + 1;
    let first = index.y * row + index.x;
    let a = pillars[first];
    let b = pillars[first + 1];
    let c = pillars[first + row + 1];
    let d = pillars[first + row];
    return Frame(
        index,
        columns[index.y * (row - 1) + index.x],
        vec4f(a.at.x, b.at.x, c.at.x, d.at.x),
        vec4f(a.at.y, b.at.y, c.at.y, d.at.y),
        vec4f(a.slope.x, b.slope.x, c.slope.x, d.slope.x),
        vec4f(a.slope.y, b.slope.y, c.slope.y, d.slope.y),
        vec4f(a.base, b.base, c.base, d.base),
        vec4f(a.step, b.step, c.step, d.step),
    );
}

fn column_at(index: vec2i) -> Column {
    return columns[index.y * i32(model.columns.x) + index.x];
}

fn in_grid(index: vec2i) -> bool {
    return all(index >= vec2i(0)) && all(index < vec2i(model.columns));
}

// Heights at which a surface (counted from the column's first) meets the four pillars.
fn surface_z(frame: Frame, surface: i32) -> vec4f {
    return frame.base - frame.step * unpack_steps(depths[i32(frame.column.start) + surface]);
}

// Weights of the four corners at (s, t).
fn ring_weights(st: vec2f) -> vec4f {
    let a = 1.0 - st;
    return vec4f(a.x * a.y, st.x * a.y, st.x * st.y, a.x * st.y);
}

// The layer (counted from the column's first) around height z at (s, t); -1 above, count - 1 below.
fn layer_around(frame: Frame, st: vec2f, z: f32) -> i32 {
    let weights = ring_weights(st);
    var low = 0;
    var high = i32(frame.column.count) - 1;
    if (z > dot(weights, surface_z(frame, 0))) {
        return -1;
    }
    if (z < dot(weights, surface_z(frame, high))) {
        return high;
    }
    while (high - low > 1) {
        let middle = (low + high) / 2;
        if (z <= dot(weights, surface_z(frame, middle))) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Whether the column next across a side agrees with this one at a layer: one face, not a fault.
// Sides: 0 toward -j, 1 toward +i, 2 toward +j, 3 toward -i.
fn agrees(frame: Frame, next: Column, side: i32, layer: i32) -> bool {
    let other = layer + i32(frame.column.first) - i32(next.first);
    if (other < 0 || other + 1 >= i32(next.count)) {
        return false;
    }
    for (var n = 0; n < 2; n++) {
        let mine = unpack_steps(depths[i32(frame.column.start) + layer + n]);
        let theirs = unpack_steps(depths[i32(next.start) + other + n]);
        var apart: vec2f;
        switch side {
            case 0 { apart = (mine.xy - theirs.wz) * frame.step.xy; }
            case 1 { apart = (mine.yz - theirs.xw) * frame.step.yz; }
            case 2 { apart = (mine.wz - theirs.xy) * frame.step.wz; }
            default { apart = (mine.xw - theirs.yz) * frame.step.xw; }
        }
        if (any(abs(apart) > vec2f(model.tolerance))) {
            return false;
        }
    }
    return true;
}

fn side_step(side: i32) -> vec2i {
    return select(
        vec2i(select(-1, 1, side == 1), 0),
        vec2i(0, select(-1, 1, side == 2)),
        (side & 1) == 0,
    );
}

fn trilinear(top: vec4f, bottom: vec4f, p: vec3f) -> f32 {
    return dot(ring_weights(p.xy), mix(top, bottom, p.z));
}
