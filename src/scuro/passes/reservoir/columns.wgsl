// A corner-point grid: columns of layers between four pillars. Filled by pack.py and model.py.
//
// Corners of a column are in ring order, (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1), as the four
// components of a vector; parametric coordinates s, t, r run from 0 to 1 along i, j and downward.
// Tables are textures, in rows of a power of two: software adapters read those several times faster.

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
    start: i32,
    // that surface's number, the same in all columns
    first: i32,
    // how many surfaces: one more than layers; 0 for a column without active cells
    count: i32,
    // index of its first word in `flags`
    words: i32,
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
    // lowest and highest z of all cells
    z_range: vec2f,
    // texels in a row of a table: as the power of two, and less one
    row_power: u32,
    row_mask: i32,
}

@group(1) @binding(0) var<uniform> model: Model;
// two texels a pillar
@group(1) @binding(1) var pillars: texture_2d<f32>;
@group(1) @binding(2) var columns: texture_2d<u32>;
// four 16-bit depths a surface, in steps of the pillar's range
@group(1) @binding(3) var depths: texture_2d<u32>;

fn texel_of(index: i32) -> vec2i {
    return vec2i(index & model.row_mask, index >> model.row_power);
}

fn pillar_at(index: i32) -> Pillar {
    let place = textureLoad(pillars, texel_of(2 * index), 0);
    let heights = textureLoad(pillars, texel_of(2 * index + 1), 0);
    return Pillar(place.xy, place.zw, heights.x, heights.y);
}

fn column_number(index: i32) -> Column {
    let column = vec4i(textureLoad(columns, texel_of(index), 0));
    return Column(column.x, column.y, column.z, column.w);
}

fn column_at(index: vec2i) -> Column {
    return column_number(index.y * i32(model.columns.x) + index.x);
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
    let a = pillar_at(first);
    let b = pillar_at(first + 1);
    let c = pillar_at(first + row + 1);
    let d = pillar_at(first + row);
    return Frame(
        index,
        column_at(index),
        vec4f(a.at.x, b.at.x, c.at.x, d.at.x),
        vec4f(a.at.y, b.at.y, c.at.y, d.at.y),
        vec4f(a.slope.x, b.slope.x, c.slope.x, d.slope.x),
        vec4f(a.slope.y, b.slope.y, c.slope.y, d.slope.y),
        vec4f(a.base, b.base, c.base, d.base),
        vec4f(a.step, b.step, c.step, d.step),
    );
}

fn in_grid(index: vec2i) -> bool {
    return all(index >= vec2i(0)) && all(index < vec2i(model.columns));
}

// Depths of a surface at its four pillars, in steps.
fn depth_steps(surface: i32) -> vec4f {
    return vec4f(textureLoad(depths, texel_of(surface), 0));
}

// Heights at which a surface (counted from the column's first) meets the four pillars.
fn surface_z(frame: Frame, surface: i32) -> vec4f {
    return frame.base - frame.step * depth_steps(frame.column.start + surface);
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
    var high = frame.column.count - 1;
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

// Sides: 0 toward -j, 1 toward +i, 2 toward +j, 3 toward -i.
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
