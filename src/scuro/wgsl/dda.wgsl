// Walking a ray through the cells of a grid (Amanatides & Woo 1987).

//#include "ray.wgsl"
//#include "scene.wgsl"

// One over each component; a zero becomes huge, so that no NaN arises in slab tests.
fn safe_inverse(d: vec3f) -> vec3f {
    let tiny = vec3f(1e-20);
    return 1.0 / select(d, select(-tiny, tiny, d >= vec3f(0.0)), abs(d) < tiny);
}

// State of a 3-D digital differential analyser in one grid.
struct Walk {
    cell: i32,
    stride: vec3i,
    t_next: vec3f,
    t_step: vec3f,
    t_end: f32,
}

// Start where the ray enters the grid's box within [t_min, t_max]; t_end < 0 ... no cell at all.
fn walk_start(grid: Grid, ray: Ray, t_min: f32, t_max: f32) -> Walk {
    let inverse = safe_inverse(ray.direction);
    let size = vec3f(grid.dims) * grid.cell;
    let to_low = (grid.origin - ray.origin) * inverse;
    let to_high = (grid.origin + size - ray.origin) * inverse;
    let enter = min(to_low, to_high);
    let leave = max(to_low, to_high);
    let t0 = max(max(enter.x, enter.y), max(enter.z, t_min));
    let t1 = min(min(leave.x, leave.y), min(leave.z, t_max));
    var walk: Walk;
    walk.t_end = -NOTHING;
    if (t0 > t1) {
        return walk;
    }
    let place = (ray.origin + t0 * ray.direction - grid.origin) / grid.cell;
    let last = vec3i(grid.dims) - 1;
    let cell = clamp(vec3i(floor(place)), vec3i(0), last);
    let forward = ray.direction >= vec3f(0.0);
    let edge = grid.origin + vec3f(cell + select(vec3i(0), vec3i(1), forward)) * grid.cell;
    let row = i32(grid.dims.x);
    let layer = row * i32(grid.dims.y);
    walk.cell = i32(grid.cells) + cell.x + row * cell.y + layer * cell.z;
    walk.stride = select(vec3i(-1, -row, -layer), vec3i(1, row, layer), forward);
    walk.t_next = (edge - ray.origin) * inverse;
    walk.t_step = abs(grid.cell * inverse);
    // a sliver less: crossings are sums of steps, and must not round to one more step out of the grid
    walk.t_end = t1 - 1e-3 * grid.cell;
    return walk;
}

// Where the ray leaves the cell.
fn walk_exit(walk: Walk) -> f32 {
    return min(walk.t_next.x, min(walk.t_next.y, walk.t_next.z));
}

// The axis along which the next cell lies.
fn next_axis(walk: Walk) -> vec3<bool> {
    let t = walk.t_next;
    let x = (t.x <= t.y) & (t.x <= t.z);
    let y = !x & (t.y <= t.z);
    return vec3<bool>(x, y, !(x | y));
}

// Go on to the next cell along the ray.
fn walk_on(walk: ptr<function, Walk>) {
    let axis = next_axis(*walk);
    (*walk).t_next += select(vec3f(0.0), (*walk).t_step, axis);
    let stride = select(vec3i(0), (*walk).stride, axis);
    (*walk).cell += stride.x + stride.y + stride.z;
}

// Where a flat walk goes next: to the next cell if `onward`, else from a cell to its first entry or
// from an entry to the one after it. One loop of such steps, without branches, keeps the lanes of a
// group from waiting for each other at the end of each cell.
fn walk_flat(
    walk: ptr<function, Walk>, texel: vec4u, index: u32, at_cell: bool, onward: bool,
) -> u32 {
    let axis = next_axis(*walk) & vec3<bool>(onward);
    (*walk).t_next += select(vec3f(0.0), (*walk).t_step, axis);
    let stride = select(vec3i(0), (*walk).stride, axis);
    (*walk).cell += stride.x + stride.y + stride.z;
    return select(select(index + 1u, texel.x, at_cell), u32((*walk).cell), onward);
}

// Leave the empty cells behind: afterwards the walk stands in a cell with entries, whose first is
// returned, or there is none and EMPTY_CELL is. A loop of its own, because adapters that run lanes
// in lockstep pay in every iteration for all that the loop may do.
fn next_entries(walk: ptr<function, Walk>) -> u32 {
    var first = cell_at(u32((*walk).cell));
    loop {
        if (first != EMPTY_CELL || walk_exit(*walk) >= (*walk).t_end) {
            break;
        }
        walk_on(walk);
        first = cell_at(u32((*walk).cell));
    }
    return first;
}
