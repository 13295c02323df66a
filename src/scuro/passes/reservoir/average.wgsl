// From cells to vertices: each corner of a surface gets the mean of the valued cells around it that
// share the vertex, so that nothing bleeds across faults; and which cells then are to be seen.

//#include "columns.wgsl"

struct Average {
    // words of `flags` before those that tell which cells hold a value
    words: u32,
    // words of flags a column
    column_words: u32,
    // last index of the transfer function's table
    table_end: f32,
    pad: u32,
}

@group(2) @binding(0) var<uniform> average: Average;
// of cells, 0 to 1, by place among the layers; negative where a layer holds no value
@group(2) @binding(1) var<storage, read> cell_values: array<f32>;
@group(2) @binding(2) var<storage, read_write> values: array<vec2u>;
@group(2) @binding(3) var<storage, read_write> flags: array<u32>;
// how many entries of the table up to each one are visible
@group(2) @binding(4) var<storage, read> visible: array<u32>;

fn height_at(pillar: Pillar, surface: i32, corner: u32) -> f32 {
    return pillar.base - pillar.step * unpack_steps(depths[surface])[corner];
}

// Add the cells above and below a surface of one column at a vertex.
fn add_column(
    index: vec2i, corner: u32, number: i32, z: f32, pillar: Pillar, sum: ptr<function, vec2f>,
) {
    if (!in_grid(index)) {
        return;
    }
    let column = column_at(index);
    let surface = number - i32(column.first);
    let count = i32(column.count);
    if (surface < 0 || surface >= count) {
        return;
    }
    let start = i32(column.start);
    if (abs(height_at(pillar, start + surface, corner) - z) > model.tolerance) {
        return;
    }
    // layers of no thickness and no value (closed gaps, pinched-out cells) are looked through
    for (var layer = surface - 1; layer >= 0; layer--) {
        if (cell_values[start + layer] >= 0.0) {
            *sum += vec2f(cell_values[start + layer], 1.0);
            break;
        }
        if (abs(height_at(pillar, start + layer, corner) - z) > model.tolerance) {
            break;
        }
    }
    for (var layer = surface; layer + 1 < count; layer++) {
        if (cell_values[start + layer] >= 0.0) {
            *sum += vec2f(cell_values[start + layer], 1.0);
            break;
        }
        if (abs(height_at(pillar, start + layer + 1, corner) - z) > model.tolerance) {
            break;
        }
    }
}

fn vertex_value(index: vec2i, corner: u32, number: i32, z: f32) -> f32 {
    let offset = vec2i(select(0, 1, corner == 1u || corner == 2u), select(0, 1, corner >= 2u));
    let node = index + offset;
    let pillar = pillars[node.y * (i32(model.columns.x) + 1) + node.x];
    var sum = vec2f(0.0);
    // the four columns around the pillar, each with the corner that stands at it
    add_column(node, 0u, number, z, pillar, &sum);
    add_column(node - vec2i(1, 0), 1u, number, z, pillar, &sum);
    add_column(node - vec2i(1, 1), 2u, number, z, pillar, &sum);
    add_column(node - vec2i(0, 1), 3u, number, z, pillar, &sum);
    return select(0.0, sum.x / max(sum.y, 1.0), sum.y > 0.0);
}

@compute @workgroup_size(64)
fn spread(@builtin(global_invocation_id) id: vec3u) {
    let width = model.columns.x;
    let place = id.x + id.y * 65535u * 64u;
    if (place >= width * model.columns.y) {
        return;
    }
    let index = vec2i(vec2u(place % width, place / width));
    let frame = frame_of(index);
    for (var surface = 0; surface < i32(frame.column.count); surface++) {
        let z = surface_z(frame, surface);
        let number = surface + i32(frame.column.first);
        var steps: vec4u;
        for (var corner = 0u; corner < 4u; corner++) {
            steps[corner] = u32(vertex_value(index, corner, number, z[corner]) * 65535.0 + 0.5);
        }
        values[i32(frame.column.start) + surface] =
            vec2u(steps.x | (steps.y << 16u), steps.z | (steps.w << 16u));
    }
}

// A cell is to be seen if it holds a value and the transfer function shows any value between the
// lowest and highest of its corners.
@compute @workgroup_size(64)
fn mark(@builtin(global_invocation_id) id: vec3u) {
    let place = id.x + id.y * 65535u * 64u;
    if (place >= model.columns.x * model.columns.y) {
        return;
    }
    let column = columns[place];
    for (var word = 0u; word < average.column_words; word++) {
        var shown = 0u;
        var valued = 0u;
        for (var bit = 0u; bit < 32u; bit++) {
            let layer = word * 32u + bit;
            if (layer + 1u >= column.count || cell_values[column.start + layer] < 0.0) {
                continue;
            }
            valued |= 1u << bit;
            let top = unpack_steps(values[column.start + layer]) / 65535.0;
            let bottom = unpack_steps(values[column.start + layer + 1u]) / 65535.0;
            let low4 = min(top, bottom);
            let high4 = max(top, bottom);
            let low = min(min(low4.x, low4.y), min(low4.z, low4.w));
            let high = max(max(high4.x, high4.y), max(high4.z, high4.w));
            let first = u32(low * average.table_end);
            let last = u32(ceil(high * average.table_end));
            if (visible[last + 1u] > visible[first]) {
                shown |= 1u << bit;
            }
        }
        flags[column.words + word] = shown;
        flags[average.words + column.words + word] = valued;
    }
}
