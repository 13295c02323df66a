// From cells to vertices: each corner of a surface gets the mean of the valued cells around it that
// share the vertex, so that nothing bleeds across faults.

//#include "columns.wgsl"

// of cells, 0 to 65534, by place among the layers; 65535 where a layer holds no value
@group(2) @binding(0) var cell_values: texture_2d<u32>;
@group(2) @binding(1) var values: texture_storage_2d<rgba16uint, write>;

const LARGEST: u32 = 65534u;

fn height_at(pillar: Pillar, surface: i32, corner: u32) -> f32 {
    return pillar.base - pillar.step * depth_steps(surface)[corner];
}

// Add the cells above and below a surface of one column at a vertex.
fn add_column(
    index: vec2i, corner: u32, number: i32, z: f32, pillar: Pillar, sum: ptr<function, vec2f>,
) {
    if (!in_grid(index)) {
        return;
    }
    let column = column_at(index);
    let surface = number - column.first;
    if (surface < 0 || surface >= column.count) {
        return;
    }
    if (abs(height_at(pillar, column.start + surface, corner) - z) > model.tolerance) {
        return;
    }
    // layers of no thickness and no value (closed gaps, pinched-out cells) are looked through
    for (var layer = surface - 1; layer >= 0; layer--) {
        let value = textureLoad(cell_values, texel_of(column.start + layer), 0).x;
        if (value <= LARGEST) {
            *sum += vec2f(f32(value), 1.0);
            break;
        }
        if (abs(height_at(pillar, column.start + layer, corner) - z) > model.tolerance) {
            break;
        }
    }
    for (var layer = surface; layer + 1 < column.count; layer++) {
        let value = textureLoad(cell_values, texel_of(column.start + layer), 0).x;
        if (value <= LARGEST) {
            *sum += vec2f(f32(value), 1.0);
            break;
        }
        if (abs(height_at(pillar, column.start + layer + 1, corner) - z) > model.tolerance) {
            break;
        }
    }
}

fn vertex_value(index: vec2i, corner: u32, number: i32, z: f32) -> f32 {
    let offset = vec2i(select(0, 1, corner == 1u || corner == 2u), select(0, 1, corner >= 2u));
    let node = index + offset;
    let pillar = pillar_at(node.y * (i32(model.columns.x) + 1) + node.x);
    var sum = vec2f(0.0);
    // the four columns around the pillar, each with the corner that stands at it
    add_column(node, 0u, number, z, pillar, &sum);
    add_column(node - vec2i(1, 0), 1u, number, z, pillar, &sum);
    add_column(node - vec2i(1, 1), 2u, number, z, pillar, &sum);
    add_column(node - vec2i(0, 1), 3u, number, z, pillar, &sum);
    return select(0.0, sum.x / max(sum.y, 1.0), sum.y > 0.0);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let width = model.columns.x;
    let place = id.x + id.y * 65535u * 64u;
    if (place >= width * model.columns.y) {
        return;
    }
    let index = vec2i(vec2u(place % width, place / width));
    let frame = frame_of(index);
    for (var surface = 0; surface < frame.column.count; surface++) {
        let z = surface_z(frame, surface);
        let number = surface + frame.column.first;
        var steps: vec4u;
        for (var corner = 0u; corner < 4u; corner++) {
            let mean = vertex_value(index, corner, number, z[corner]);
            steps[corner] = u32(mean * (65535.0 / f32(LARGEST)) + 0.5);
        }
        textureStore(values, texel_of(frame.column.start + surface), steps);
    }
}
